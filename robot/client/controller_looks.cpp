// Single questions and orders to a controller, outside of a stream: a look, RESET, and what a job is given up
// with.
#include <chrono>
#include <optional>
#include <random>
#include <thread>

#include "robot/client/client.hpp"
#include "robot/client/fault_text.hpp"
#include "robot/client/patience.hpp"
#include "robot/wire/modbus_link.hpp"

namespace hotblade::robot {

using protocol::Op;
using protocol::State;

namespace {

using Clock = std::chrono::steady_clock;

// Orders to a controller, each for the job that its last status speaks of.
class Orders {
 public:
  Orders(const StreamOptions& options, const protocol::Status& status)
      : status_(status),
        link_(options.host, options.port, options.response_ms),
        nonce_(std::random_device{}()) {}

  // Sends one, and takes the status that is its answer.
  void send(Op op) {
    const auto block = protocol::encode_command({++nonce_, op, status_.job_id, status_.run, 0, 0, {}});
    std::array<std::uint16_t, protocol::kStatusSize> status{};
    answered_ =
        link_.write_read(protocol::kCommandBase, block, protocol::kStatusBase, status) == LinkOutcome::kOk;
    if (answered_) {
      status_ = protocol::decode_status(status);
    } else {
      link_.connect();
    }
  }
  [[nodiscard]] const protocol::Status& status() const { return status_; }
  // Why the last one was not carried out in all the time there was for it.
  [[nodiscard]] ResetReport refused(Op op, const std::string& place) const {
    const std::string what = place + protocol::name(op);
    if (!answered_) return {StreamOutcome::kLinkLost, what + " is never answered (" + link_.error() + ")"};
    const std::string log = log_fault_text(status_);
    const bool of_log = status_.last_result == protocol::Result::kState && !log.empty();
    return {StreamOutcome::kRefused,
            what + " refused (" + protocol::name(status_.last_result) + "): " +
                (of_log ? log + ", then reset again" : "the owner of the job is still there; stop it first")};
  }

 private:
  protocol::Status status_;
  ModbusLink link_;
  std::uint32_t nonce_;
  bool answered_ = false;
};

// What a job that stands is given up with, one order after the other; nothing where it is.
std::optional<Op> next_to_give_up(const protocol::Status& status) {
  if (status.state == State::kHeld) return Op::kAbort;
  if (status.state == State::kFault && status.fault == protocol::Fault::kAborted) return Op::kReset;
  if (status.state == State::kIdle && status.left_in_cut) return Op::kRelease;
  return std::nullopt;
}

}  // namespace

ControllerSnapshot look(const StreamOptions& options) {
  ControllerSnapshot snapshot;
  ModbusLink link(options.host, options.port, options.response_ms);
  std::array<std::uint16_t, protocol::kIdentSize> ident{};
  std::array<std::uint16_t, protocol::kStatusSize> status{};
  constexpr int kAttempts = 5;
  for (int attempt = 0; attempt < kAttempts && !snapshot.reached; ++attempt) {
    if (attempt > 0) std::this_thread::sleep_for(kShortestPause * (1 << attempt));
    snapshot.reached = link.connect() && link.read(protocol::kIdentBase, ident) == LinkOutcome::kOk &&
                       link.read(protocol::kStatusBase, status) == LinkOutcome::kOk;
  }
  if (!snapshot.reached) {
    snapshot.message = options.host + ":" + std::to_string(options.port) + ": no controller answers (" +
                       link.error() + "): check the address";
    return snapshot;
  }
  snapshot.ident = protocol::decode_ident(ident);
  snapshot.status = protocol::decode_status(status);
  return snapshot;
}

ResetReport reset(const StreamOptions& options) {
  const auto place = options.host + ":" + std::to_string(options.port) + ": ";
  const ControllerSnapshot now = look(options);
  if (!now.reached) return {StreamOutcome::kLinkLost, now.message};
  const auto patience = Clock::now() + lease_patience(now.ident.lease_ms);
  Orders orders(options, now.status);
  while (orders.status().state == State::kFault || orders.status().state == State::kEstop) {
    if (options.interrupted && options.interrupted())
      return {StreamOutcome::kInterrupted, place + "interrupted"};
    if (Clock::now() > patience) return orders.refused(Op::kReset, place);
    orders.send(Op::kReset);
    if (orders.status().state != State::kIdle) std::this_thread::sleep_for(kRetry);
  }
  return {};
}

ResetReport give_up(std::uint64_t job, std::uint32_t run, const StreamOptions& options) {
  const auto place = options.host + ":" + std::to_string(options.port) + ": ";
  const ControllerSnapshot now = look(options);
  if (!now.reached) return {StreamOutcome::kLinkLost, now.message};
  const auto patience = Clock::now() + lease_patience(now.ident.lease_ms);
  Orders orders(options, now.status);
  const auto& status = orders.status();
  while (status.job_id == job && status.run == run) {
    const auto op = next_to_give_up(status);
    if (!op && status.state == State::kIdle) return {};
    if (!op) break;
    if (options.interrupted && options.interrupted())
      return {StreamOutcome::kInterrupted, place + "interrupted"};
    if (Clock::now() > patience) return orders.refused(*op, place);
    orders.send(*op);
    if (next_to_give_up(status) == op) std::this_thread::sleep_for(kRetry);
  }
  const std::string log = log_fault_text(status);
  return {StreamOutcome::kRefused, place + "not given up: the controller is in " + state_text(status) +
                                       " with job " + to_hex(status.job_id) + " by now" +
                                       (log.empty() ? "" : ": " + log + ", then reset with --reset")};
}

}  // namespace hotblade::robot

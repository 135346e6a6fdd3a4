// Single questions and orders to a controller, outside of a stream: a look, RESET, RELEASE.
#include <chrono>
#include <random>
#include <thread>

#include "robot/client/client.hpp"
#include "robot/client/patience.hpp"
#include "robot/wire/modbus_link.hpp"

namespace hotblade::robot {

using protocol::Op;
using protocol::State;

namespace {

using Clock = std::chrono::steady_clock;

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
  ControllerSnapshot now = look(options);
  if (!now.reached) return {StreamOutcome::kLinkLost, now.message};
  const auto patience = Clock::now() + lease_patience(now.ident.lease_ms);
  ModbusLink link(options.host, options.port, options.response_ms);
  std::uint32_t nonce = std::random_device{}();
  while (now.status.state == State::kFault || now.status.state == State::kEstop) {
    if (options.interrupted && options.interrupted())
      return {StreamOutcome::kInterrupted, place + "interrupted"};
    if (Clock::now() > patience) {
      return {StreamOutcome::kRefused, place + "RESET refused (" + protocol::name(now.status.last_result) +
                                           "): the owner of the job is still there; stop it first"};
    }
    const auto block =
        protocol::encode_command({++nonce, Op::kReset, now.status.job_id, now.status.run, 0, 0, {}});
    std::array<std::uint16_t, protocol::kStatusSize> status{};
    if (link.write_read(protocol::kCommandBase, block, protocol::kStatusBase, status) == LinkOutcome::kOk) {
      now.status = protocol::decode_status(status);
    } else {
      link.connect();
    }
    if (now.status.state != State::kIdle) std::this_thread::sleep_for(kRetry);
  }
  return {};
}

ResetReport release(const StreamOptions& options) {
  const auto place = options.host + ":" + std::to_string(options.port) + ": ";
  const ControllerSnapshot now = look(options);
  if (!now.reached) return {StreamOutcome::kLinkLost, now.message};
  ModbusLink link(options.host, options.port, options.response_ms);
  const auto block = protocol::encode_command(
      {std::random_device{}(), Op::kRelease, now.status.job_id, now.status.run, 0, 0, {}});
  std::array<std::uint16_t, protocol::kStatusSize> status{};
  constexpr int kAttempts = 5;  // of the same command: it is carried out once
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    if (link.connect() &&
        link.write_read(protocol::kCommandBase, block, protocol::kStatusBase, status) == LinkOutcome::kOk) {
      const protocol::Status after = protocol::decode_status(status);
      if (!after.left_in_cut) return {};
      return {StreamOutcome::kRefused, place + "RELEASE refused (" + protocol::name(after.last_result) + ")"};
    }
    std::this_thread::sleep_for(kRetry);
  }
  return {StreamOutcome::kLinkLost, place + "RELEASE is never answered (" + link.error() + ")"};
}

}  // namespace hotblade::robot

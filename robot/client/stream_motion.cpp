// A job in motion: START, RESUME, windows, HOLD, WITHDRAW and CLOSE.
#include <algorithm>
#include <chrono>
#include <thread>

#include "robot/client/fault_text.hpp"
#include "robot/client/streamer.hpp"

namespace hotblade::robot {

using protocol::Fault;
using protocol::Op;
using protocol::Result;
using protocol::State;

using std::chrono::milliseconds;

namespace {

constexpr auto kProgressEvery = milliseconds(100);
constexpr std::uint32_t kPrefill = 256;  // waypoints before START: seconds of motion, at any step
// A machine stands that told of no more waypoints for so long, and is waited for no longer than that.
constexpr auto kStands = milliseconds(300), kLongestStop = milliseconds(3000);

}  // namespace

bool Streamer::go() {
  while (status_.state != State::kDone) {
    if (interrupted()) return hold();
    show(false);
    if (!step()) return false;
    if (lost_ && !check_prefix()) return false;
  }
  return true;
}

// What the state asks for: start, go on, send, or wait.
bool Streamer::step() {
  switch (status_.state) {
    case State::kOpen:
    case State::kHeld:
      if (!ready_to_move()) return send_window(false);
      if (restarted()) return may_move();
      return command(status_.state == State::kOpen ? Op::kStart : Op::kResume) && started();
    case State::kRunning:
      return send_window(true);
    case State::kFault:
    case State::kEstop:
      return stopped_by_fault();
    default:
      return settle(StreamOutcome::kRefused,
                    "the job is no longer open on the controller (restarted?): run it anew");
  }
}

// A controller that was restarted stands; people may have gone to the machine meanwhile.
bool Streamer::may_move() {
  if (options_.may_go_on && !options_.may_go_on(status_)) {
    return settle(StreamOutcome::kInterrupted, "not set in motion again after the controller's restart, " +
                                                   std::to_string(status_.executed) + " of " +
                                                   std::to_string(job_.size()) + " waypoints executed");
  }
  agreed_boot_ = ident_.boot_id;
  lost_ = true;  // the answer may have taken minutes
  return refresh() && check_prefix();
}

bool Streamer::started() {
  if (restarted()) return true;  // and the operator is asked
  fruitless_ = status_.last_result == Result::kOk ? 0 : fruitless_ + 1;
  if (status_.last_result == Result::kState && limit_of_code(status_.fault_detail) == Limit::kCell) {
    return settle(StreamOutcome::kRefused,
                  job_.arms
                      ? "STATE: the program's arms are not those of this controller's cell: plan or place "
                        "it with the cell that the controller has"
                      : "STATE: this controller checks its arms, and the program has none: plan or place "
                        "it with --cell");
  }
  const bool may_change = status_.last_result == Result::kOk || status_.last_result == Result::kState;
  if (may_change && fruitless_ < kMaxFruitless) return true;
  return settle(StreamOutcome::kRefused, std::string(protocol::name(status_.last_result)) +
                                             ": the motion may not start in state " +
                                             protocol::name(status_.state));
}

bool Streamer::ready_to_move() const {
  const std::uint32_t ahead = status_.accepted - status_.executed;
  return status_.accepted == job_.size() || ahead >= std::min<std::uint32_t>(kPrefill, ident_.fifo_size) ||
         status_.free == 0;
}

// The next waypoints as far as there is room, or a sign of life.
bool Streamer::send_window(bool wait) {
  const std::uint32_t accepted = status_.accepted;
  const std::uint32_t room = std::min<std::uint32_t>(status_.free, protocol::kMaxWaypointsPerWindow);
  const std::uint32_t n = std::min(room, job_.size() - accepted);
  const auto raw = std::span(job_.raw).subspan(accepted, n);
  const auto window = protocol::encode_window(token_, accepted, n > 0 && accepted + n == job_.size(), raw);
  if (!transact(protocol::kWindowBase, window.span())) return false;
  ++report_.windows;
  if (lost_) return true;
  if (n == 0 && wait) std::this_thread::sleep_for(milliseconds(options_.poll_ms));
  if (n == 0) return status_.last_result != Result::kBadToken || judge_window(accepted);
  return judge_window(accepted);
}

bool Streamer::judge_window(std::uint32_t accepted_before) {
  fruitless_ = status_.accepted > accepted_before ? 0 : fruitless_ + 1;
  const std::string at = "waypoint " + std::to_string(status_.fault_sequence);
  switch (status_.last_result) {
    case Result::kLimit:
      report_.at = status_.fault_sequence;
      return settle(StreamOutcome::kRefused, "LIMIT: " + at + ": " + told_limit(status_, ident_.limits) +
                                                 ": the program does not fit this machine");
    case Result::kBadToken:
      return settle(StreamOutcome::kRefused, "BADTOKEN: another client has taken over (token " +
                                                 std::to_string(status_.token) + ", ours " +
                                                 std::to_string(token_) + ")");
    case Result::kConflict:
      report_.at = status_.fault_sequence;
      return settle(StreamOutcome::kFault, "CONFLICT: " + at + " was accepted with other contents");
    default:
      break;
  }
  if (fruitless_ < kMaxFruitless) return true;
  return settle(StreamOutcome::kRefused, std::string(protocol::name(status_.last_result)) +
                                             ": no waypoint accepted in " + std::to_string(kMaxFruitless) +
                                             " windows");
}

// Ctrl-C: slow down along the path and wait for rest.
bool Streamer::hold() {
  if (status_.state == State::kRunning) {
    if (!command(Op::kHold)) return false;
    const auto patience = Clock::now() + milliseconds(5000);
    while (status_.state == State::kRunning && Clock::now() < patience) {
      std::this_thread::sleep_for(milliseconds(options_.poll_ms));
      if (!refresh()) return false;
    }
  }
  return settle(StreamOutcome::kInterrupted,
                std::string("interrupted, controller is ") + protocol::name(status_.state) + " after " +
                    std::to_string(status_.executed) + " of " + std::to_string(job_.size()) + " waypoints");
}

// A fault is told of at once, what is executed on the way to rest when it is on record.
void Streamer::read_to_rest() {
  const protocol::Status told = status_;
  const auto give_up = Clock::now() + kLongestStop;
  auto rest = Clock::now() + kStands;
  while (Clock::now() < std::min(rest, give_up)) {
    const std::uint32_t executed = status_.executed;
    std::this_thread::sleep_for(milliseconds(options_.poll_ms));
    if (!refresh()) break;
    if (status_.executed != executed) rest = Clock::now() + kStands;
  }
  if (status_.state != told.state || status_.job_id != told.job_id) status_ = told;
}

bool Streamer::stopped_by_fault() {
  if (open_) read_to_rest();
  if (status_.state == State::kEstop) {
    if (status_.job_id == job_.id && status_.executed > 0) report_.at = status_.executed - 1;
    return settle(StreamOutcome::kFault, "ESTOP is latched: clear the cell, then reset with --reset");
  }
  std::string what = state_text(status_);
  report_.at = status_.fault_sequence;
  if (status_.fault == Fault::kExecutionLimit) what += ": " + told_limit(status_, ident_.limits);
  const std::string log = log_fault_text(status_);
  return settle(StreamOutcome::kFault, what + " at waypoint " + std::to_string(status_.fault_sequence) +
                                           (log.empty() ? ": " : ": " + log + ", then ") +
                                           "reset with --reset");
}

// Backwards to the first waypoint. The next waypoint is sent first: a controller that was restarted knows
// from it where its path leads.
bool Streamer::draw_back() {
  while (status_.accepted == status_.executed && status_.executed < job_.size()) {
    if (!send_window(false)) return false;
  }
  if (!command(Op::kWithdraw)) return false;
  if (restarted())
    return settle(StreamOutcome::kInterrupted, "the controller was restarted, nothing moves: run it again");
  if (status_.last_result != Result::kOk) {
    return settle(StreamOutcome::kRefused, std::string(protocol::name(status_.last_result)) +
                                               ": WITHDRAW refused in state " +
                                               protocol::name(status_.state));
  }
  while (status_.state == State::kRunning) {
    if (interrupted()) return hold();
    show(false);
    std::this_thread::sleep_for(milliseconds(options_.poll_ms));
    if (!send_window(false)) return false;
  }
  if (status_.state == State::kFault || status_.state == State::kEstop) return stopped_by_fault();
  if (status_.state == State::kIdle && !status_.left_in_cut) return true;
  return settle(
      StreamOutcome::kInterrupted,
      std::string("the blade stopped on its way out, the controller is ") + protocol::name(status_.state));
}

bool Streamer::finish() {
  if (!complete()) {
    return settle(StreamOutcome::kFault, "DONE with other waypoints than planned (" +
                                             std::to_string(status_.executed) + " of " +
                                             std::to_string(job_.size()) + ")");
  }
  const protocol::Status done = status_;
  if (!command(Op::kClose)) return false;
  // A controller restarted after it had closed the job does not remember the command, but the job.
  const bool closed = status_.state == State::kIdle && status_.job_id == job_.id && status_.run == run_ &&
                      status_.executed == job_.size();
  if (status_.last_result != Result::kOk && !closed) {
    settle(StreamOutcome::kRefused, std::string(protocol::name(status_.last_result)) + ": CLOSE refused");
  }
  status_ = done;
  return true;
}

void Streamer::show(bool force) {
  if (!options_.progress) return;
  const auto now = Clock::now();
  if (!force && now - shown_ < kProgressEvery) return;
  shown_ = now;
  const std::uint32_t executed = open_ ? std::min(status_.executed, job_.size()) : 0;
  const double end = protocol::time_us(job_.raw.back());
  const double at = executed > 0 ? protocol::time_us(job_.raw[executed - 1]) : 0.0;
  options_.progress(
      {status_.state, status_.fault, status_.accepted, executed, job_.size(), (end - at) * 1e-6,
       report_.reconnects,
       lost_since_ ? std::max(std::chrono::duration<double>(now - *lost_since_).count(), 1e-3) : 0});
}

}  // namespace hotblade::robot

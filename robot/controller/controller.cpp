#include "robot/controller/controller.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hotblade::robot {

using protocol::Fault;
using protocol::Op;
using protocol::Result;
using protocol::State;

namespace {

bool same(const protocol::Command& a, const protocol::Command& b) {
  return a.nonce == b.nonce && a.op == b.op && a.job_id == b.job_id && a.run == b.run && a.token == b.token &&
         a.waypoint_count == b.waypoint_count && a.blade == b.blade;
}

// A blade that can exist: 10 mm to 10 m long, thinner than wide, wide below its length.
bool plausible(const ClampedBlade& blade) {
  constexpr double kShortest_mm = 10, kLongest_mm = 10000;
  return blade.length_mm >= kShortest_mm && blade.length_mm <= kLongest_mm && blade.thickness_mm > 0 &&
         blade.thickness_mm <= blade.width_mm && blade.width_mm < blade.length_mm &&
         blade.youngs_modulus_mpa > 0 && blade.yield_strength_mpa > 0;
}

}  // namespace

Controller::Controller(const ControllerOptions& options, ExecutionSink* sink)
    : options_(options), sink_(sink), path_(options.time_scale == kAsFastAsDataComes) {
  if (options_.blade.equilibrium) options_.capabilities |= protocol::kCapEquilibrium;
  if (options_.arms) options_.capabilities |= protocol::kCapArms;
}

protocol::Ident Controller::ident() const {
  protocol::Ident ident;
  ident.capabilities = options_.capabilities;
  ident.fifo_size = options_.fifo_size;
  ident.boot_id = options_.boot_id;
  ident.limits = options_.limits;
  ident.watchdog_ms = options_.watchdog_ms;
  ident.lease_ms = options_.lease_ms;
  ident.max_waypoints = options_.max_waypoints;
  ident.blade_length_mm = loaded_ ? job_.blade.length_mm : 0;
  return ident;
}

protocol::Status Controller::status() const {
  protocol::Status s;
  s.state = state_;
  // DONE is published with the last waypoint, not before it is durable.
  if (state_ == State::kDone && published_executed_ < job_.executed) s.state = State::kRunning;
  s.fault = fault_;
  s.fault_detail = fault_detail_;
  s.fault_sequence = fault_sequence_;
  s.job_id = job_.id;
  s.run = job_.run;
  s.token = token_;
  s.accepted = job_.accepted();
  s.executed = published_executed_;
  s.free =
      static_cast<std::uint16_t>(loaded_ ? options_.fifo_size - (job_.accepted() - published_executed_) : 0);
  s.last_result = last_result_;
  s.last_nonce = last_command_.nonce;
  s.accepted_crc = job_.accepted_crc;
  s.executed_crc = published_crc_;
  const bool watched = state_ == State::kRunning;
  const std::uint64_t left_ms =
      watched ? (std::max(watchdog_at_us_, now_us_) - now_us_) / 1000 : options_.watchdog_ms;
  s.watchdog_ms = static_cast<std::uint16_t>(std::min<std::uint64_t>(left_ms, 0xFFFF));
  s.time_us = now_us_;
  s.phase = phase_;
  s.left_in_cut = left_in_cut_;
  s.arms = fault_arms_;
  s.following_um = static_cast<std::uint32_t>(std::lround(following_mm() * 1000));
  return s;
}

bool Controller::lease_alive() const {
  return loaded_ && now_us_ < lease_until_us_;
}

void Controller::feed(Connection from) {
  owner_ = from;
  newest_ = std::max(newest_, from);
  lease_until_us_ = now_us_ + std::uint64_t{options_.lease_ms} * 1000;
  watchdog_at_us_ = now_us_ + std::uint64_t{options_.watchdog_ms} * 1000;
}

void Controller::heard(Connection from, std::uint64_t now_us) {
  move_to(now_us);
  if (loaded_ && from != kNobody && from == owner_) feed(from);
}

Result Controller::command(const protocol::DecodedCommand& decoded, Connection from, std::uint64_t now_us) {
  move_to(now_us);
  if (!decoded.crc_ok) return last_result_ = Result::kBadCrc;
  const protocol::Command& c = decoded.command;
  if (any_command_ && same(c, last_command_)) {
    // Sent again because the answer was lost: answered again, not carried out again.
    if (last_command_result_ == Result::kOk && loaded_ && (owns(c.token) || c.op == Op::kOpen)) feed(from);
    return last_result_ = last_command_result_;
  }
  Result result = dispatch(c, from);
  record_changes();
  if (result == Result::kOk && fault_ == Fault::kLog) result = Result::kState;
  any_command_ = true;
  last_command_ = c;
  last_command_result_ = result;
  return last_result_ = result;
}

Result Controller::dispatch(const protocol::Command& c, Connection from) {
  if (c.op < Op::kOpen || c.op > Op::kRelease) return Result::kState;
  if (c.op == Op::kOpen) return open(c, from);
  // Anybody may clear up behind an owner whose lease has run out; nobody else may do anything.
  const bool clears_up = (c.op == Op::kAbort || c.op == Op::kReset) && !lease_alive();
  const bool frees = c.op == Op::kRelease && !loaded_;
  if (!owns(c.token) && !clears_up && !frees) return loaded_ ? Result::kBadToken : Result::kState;
  // A frame that comes late over a connection given up long ago must not set the machine in motion.
  const bool moves = c.op == Op::kStart || c.op == Op::kResume || c.op == Op::kWithdraw;
  if (moves && from < newest_) return Result::kState;
  if (owns(c.token)) feed(from);
  if (c.op != Op::kReset && (c.job_id != job_.id || c.run != job_.run)) return Result::kState;
  return act(c);
}

Result Controller::act(const protocol::Command& c) {
  switch (c.op) {
    case Op::kStart:
      return start();
    case Op::kHold:
      return hold();
    case Op::kResume:
      return resume();
    case Op::kAbort:
      return abort();
    case Op::kReset:
      return reset();
    case Op::kWithdraw:
      return withdraw();
    case Op::kRelease:
      return release();
    default:
      return close();
  }
}

Result Controller::open(const protocol::Command& c, Connection from) {
  if (state_ == State::kFault || state_ == State::kEstop) return Result::kState;
  Result result = Result::kOk;
  const bool same_job = loaded_ && c.job_id == job_.id && c.run == job_.run;
  if (!loaded_ && left_in_cut_) {
    // Waypoint 0 does not lead on from a blade that stands in the foam.
    const bool left_here = c.job_id == job_.id && c.run == job_.run;
    result = left_here ? take_up_again() : limit({Limit::kHeldPose}, 0);
  } else if (!loaded_) {
    result = open_new(c);
  } else if (owns(c.token)) {
    result = same_job ? Result::kOk : Result::kState;
  } else if (lease_alive()) {
    result = Result::kBusy;
  } else if (same_job) {
    give_token("takeover");
  } else if (state_ == State::kDone || (state_ == State::kOpen && job_.executed == 0)) {
    result = open_new(c);  // the former owner left nothing half cut
  } else {
    result = Result::kState;
  }
  if (result == Result::kOk && state_ == State::kFault) return Result::kState;  // the log cannot be written
  if (result == Result::kOk) feed(from);
  return result;
}

// On record before anybody sees it, so that no restart gives the same token again.
void Controller::give_token(const char* why) {
  ++token_;
  newest_ = kNobody;
  report(why);
  commit();
}

Result Controller::open_new(const protocol::Command& c) {
  if (!plausible(c.blade) || c.waypoint_count == 0 || c.waypoint_count > options_.max_waypoints) {
    return limit({Limit::kBlade}, 0);
  }
  load(c.job_id, c.run, c.waypoint_count, c.blade);
  loaded_ = true;
  state_ = State::kOpen;
  give_token("open");
  return Result::kOk;
}

void Controller::load(std::uint64_t job, std::uint32_t run, std::uint32_t count, const ClampedBlade& blade) {
  std::vector<protocol::RawWaypoint> raw;
  raw.reserve(count);
  const LimitChecker checker(options_.limits, blade.length_mm);
  const BladeCheck shape(blade, options_.blade);
  job_ = {job, run, count, blade, std::move(raw), 0, checker, 0, 0, checker, shape, shape, {}, {}, {}};
  chain_.restart(job);
  clear_fault();
  published_executed_ = 0;
  published_crc_ = 0;
  path_ = PathClock(options_.time_scale == kAsFastAsDataComes);
  motion_s_ = 0;
  poses_written_ = 0;
  step_ = 0;
  phase_ = protocol::Phase::kProgram;
  held_.reset();
  lag_s_ = 0;
  heat_off_ = false;
  left_in_cut_ = false;
  withdrawing_ = false;
  stop_reason_ = StopReason::kNone;
}

Result Controller::start() {
  // Full rate at once needs room to stop in.
  if (state_ != State::kOpen || job_.accepted() == 0 || data_ends_at(path_.full_braking_s()))
    return Result::kState;
  if (arms_unknown()) return Result::kState;
  state_ = State::kRunning;
  stop_reason_ = StopReason::kNone;
  if (!on_record("start")) return Result::kState;
  path_.start_at_full_rate();
  return Result::kOk;
}

Result Controller::hold() {
  if (state_ != State::kRunning) return Result::kState;
  report("hold");
  stop(StopReason::kHold);
  return Result::kOk;
}

Result Controller::resume() {
  // Without the next waypoint nobody knows where the path goes on.
  if (state_ != State::kHeld || job_.accepted() == job_.executed || arms_unknown()) return Result::kState;
  state_ = State::kRunning;
  clear_fault();
  stop_reason_ = StopReason::kNone;
  withdrawing_ = false;
  if (!on_record("resume")) return Result::kState;
  go_on_from_held();
  return Result::kOk;
}

Result Controller::abort() {
  if (!loaded_ || state_ == State::kFault || state_ == State::kEstop) return Result::kState;
  fail(Fault::kAborted, {}, job_.executed);
  return Result::kOk;
}

Result Controller::reset() {
  if (state_ != State::kFault && state_ != State::kEstop) return Result::kState;
  if (!path_.at_rest()) return Result::kState;
  const char* const stands = state_ == State::kEstop ? "estop" : "fault";
  if (!record()) {
    fault_ = Fault::kLog;  // in ESTOP, too, it says why
    return Result::kState;
  }
  report("reset");
  if (!record()) {
    fault_ = Fault::kLog;
    report(stands);  // the line before counts no more, once both are written
    return Result::kState;
  }
  if (loaded_) left_in_cut_ = in_cut();
  state_ = State::kIdle;
  clear_fault();
  loaded_ = false;
  return Result::kOk;
}

Result Controller::close() {
  const bool untouched = state_ == State::kOpen && job_.executed == 0;
  if (state_ != State::kDone && !untouched) return Result::kState;
  report("close");
  state_ = State::kIdle;
  loaded_ = false;
  return Result::kOk;
}

void Controller::estop(std::uint64_t now_us) {
  move_to(now_us);
  latch_estop();
}

void Controller::latch_estop() {
  if (state_ == State::kEstop) return;
  path_.stop_at_once();
  stop_reason_ = StopReason::kNone;
  state_ = State::kEstop;
  phase_ = protocol::Phase::kProgram;
  lag_s_ = 0;
  heat_off_ = true;
  withdrawing_ = false;
  if (loaded_) write_pose();
  report("estop");
}

Result Controller::window(const protocol::Window& window, Connection from, std::uint64_t now_us) {
  move_to(now_us);
  return last_result_ = judge(window, from);
}

Result Controller::judge(const protocol::Window& w, Connection from) {
  if (!w.crc_ok) return Result::kBadCrc;
  if (!loaded_) return Result::kState;
  if (!owns(w.token)) return Result::kBadToken;
  feed(from);
  if (state_ == State::kFault || state_ == State::kEstop) return Result::kState;
  const std::uint32_t accepted = job_.accepted();
  if (w.first_sequence > accepted) return Result::kGap;
  const std::uint32_t end = w.first_sequence + w.count;
  const bool ends_job = w.count > 0 && end == job_.count;
  if (end > job_.count || w.last != ends_job || !w.known_flags) return limit({Limit::kCount}, end);
  const std::uint32_t already = std::min<std::uint32_t>(w.count, accepted - w.first_sequence);
  for (std::uint32_t i = 0; i < already; ++i) {
    if (w.raw[i] != job_.raw[w.first_sequence + i]) {
      fail(Fault::kConflict, {}, w.first_sequence + i);
      return Result::kConflict;
    }
  }
  if (already == w.count) return w.count == 0 && w.first_sequence == accepted ? Result::kOk : Result::kDup;
  return append(w, already);
}

Result Controller::append(const protocol::Window& w, std::uint32_t already) {
  const std::uint32_t added = w.count - already;
  if (added > options_.fifo_size - (job_.accepted() - published_executed_)) return Result::kFull;
  LimitChecker checker = job_.acceptance;
  BladeCheck blade = job_.accepted_blade;
  trial_arms_ = job_.accepted_arms;
  for (std::uint32_t i = already; i < w.count; ++i) {
    const auto decoded = protocol::decode_waypoint(w.raw[i]);
    Breach broken{decoded.error != Limit::kNone ? decoded.error : checker.next(decoded.waypoint)};
    if (broken.limit == Limit::kNone) broken.limit = blade.next(decoded.waypoint);
    if (broken.limit == Limit::kNone) broken = trial_arms_.next(decoded.waypoint, blade.shape());
    if (broken.limit != Limit::kNone) return limit(broken, w.first_sequence + i);
    if (i == already && held_ && !agrees_with_held_pose(from_, decoded.waypoint))
      return limit({Limit::kHeldPose}, w.first_sequence + i);
  }
  if (w.last) {
    Breach broken{checker.finish()};
    if (broken.limit == Limit::kNone) broken = trial_arms_.finish();
    if (broken.limit != Limit::kNone) return limit(broken, job_.count - 1);
  }
  job_.acceptance = checker;
  job_.accepted_blade = blade;
  std::swap(job_.accepted_arms, trial_arms_);
  for (std::uint32_t i = already; i < w.count; ++i) {
    job_.raw.push_back(w.raw[i]);
    job_.accepted_crc = protocol::crc32(w.raw[i], job_.accepted_crc);
  }
  if (held_) {
    held_.reset();
    load_step(step_);
  }
  return Result::kOk;
}

void Controller::clear_fault() {
  fault_ = Fault::kNone;
  fault_detail_ = 0;
  fault_sequence_ = 0;
  fault_arms_ = {};
}

Result Controller::limit(const Breach& breach, std::uint32_t sequence) {
  fault_detail_ = info(breach.limit).code;
  fault_sequence_ = sequence;
  fault_arms_ = breach.detail;
  return Result::kLimit;
}

void Controller::report(const char* what) {
  uncommitted_ = changed_ = true;
  if (sink_ == nullptr) return;
  sink_->event({what, job_.id, job_.run, token_, job_.executed, job_.count, motion_us(), fault_,
                fault_detail_, fault_sequence_, job_.blade, job_.arms, fault_arms_});
}

// Before anything begins to move that no restart would know of.
bool Controller::on_record(const char* what) {
  report(what);
  commit();
  return fault_ != Fault::kLog;
}

void Controller::record_changes() {
  if (changed_) commit();
}

void Controller::commit() {
  if (!uncommitted_) return;
  uncommitted_ = changed_ = false;
  if (record() || fault_ == Fault::kLog) return;
  if (state_ == State::kEstop) {
    fault_ = Fault::kLog;
  } else {
    fail(Fault::kLog, {}, job_.executed);
  }
}

// What is not on record has not been executed, for anybody who asks.
bool Controller::record() {
  if (sink_ != nullptr && !sink_->commit()) return false;
  published_executed_ = job_.executed;
  published_crc_ = job_.executed_crc;
  return true;
}

}  // namespace hotblade::robot

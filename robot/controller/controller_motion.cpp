// The controller's motion: waypoints at their times, slowing down, poses for the log.
#include <algorithm>
#include <cmath>

#include "robot/controller/controller.hpp"

namespace hotblade::robot {

using protocol::Fault;
using protocol::Phase;
using protocol::State;

namespace {

constexpr double kMicro = 1e-6;
constexpr double kPoseStep_s = 0.01;
// While the rate rises the braking distance grows; it is looked at this often.
constexpr double kRampLook_s = 1e-3;

double time_s(const Waypoint& w) {
  return w.t_us * kMicro;
}

}  // namespace

// Along the way, forwards or backwards.
double Controller::to_next_waypoint_s() const {
  return path_.backwards() ? path_.path_s() - time_s(from_) : time_s(to_) - path_.path_s();
}

std::uint64_t Controller::motion_us() const {
  return static_cast<std::uint64_t>(std::llround(motion_s_ / kMicro));
}

void Controller::tick(std::uint64_t now_us) {
  move_to(now_us);
  if (state_ == State::kRunning && now_us_ >= watchdog_at_us_ && stop_reason_ == StopReason::kNone) {
    stop(StopReason::kWatchdog);
  }
  cool_when_due();
}

void Controller::move_to(std::uint64_t now_us) {
  const std::uint64_t dt_us = now_us > now_us_ ? now_us - now_us_ : 0;
  now_us_ += dt_us;
  if (!moving()) return;
  run_motion(options_.time_scale == kAsFastAsDataComes
                 ? kAsFastAsDataComes
                 : static_cast<double>(dt_us) * kMicro * options_.time_scale);
}

// A fault stops along the path too: what is passed on the way is executed and on record.
bool Controller::moving() const {
  if (reboot_due_) return false;
  const bool at_work = !path_.at_rest() || phase_ == Phase::kReheat;
  return (state_ == State::kRunning || state_ == State::kFault) && at_work;
}

double Controller::data_end_s() const {
  return protocol::time_us(job_.raw.back()) * kMicro;
}

// Whether a stop that takes braking_s of path has to begin now, less what one look can overrun it by.
bool Controller::data_ends_at(double braking_s) const {
  if (job_.accepted() == job_.count || options_.time_scale == kAsFastAsDataComes) return false;
  return data_end_s() - path_.path_s() <= braking_s + 2 * kRampLook_s;
}

void Controller::run_motion(double budget_s) {
  // An instant clock would go through all that is buffered before anybody is answered: about 10 ms of work
  // with every check on, then the next turn goes on.
  constexpr std::uint32_t kBurst = 64;
  const std::uint32_t before = job_.executed;
  execute_due();
  while (budget_s > 0 && moving()) {
    if (budget_s == kAsFastAsDataComes && job_.executed - before >= kBurst) return;
    if (phase_ == Phase::kReheat) {
      spend_reheating(budget_s);
      continue;
    }
    if (stalled()) {
      ask_in_vain(budget_s);
      continue;
    }
    if (path_.backwards()) {
      brake_for_boundary();
      if (!path_.backwards()) continue;
    } else if (step_ + 1 >= job_.accepted()) {
      return run_dry();
    } else if (!path_.stopping() && data_ends_at(path_.braking_s())) {
      stop(StopReason::kUnderrun);
      continue;
    }
    const double drives = options_.faults.slow;
    const double step = step_length(budget_s * drives);
    path_.advance(step);
    motion_s_ += step / drives;
    budget_s -= step / drives;
    if (drives < 1) fall_behind(step / drives, step);
    settle();
  }
}

// Only an instant clock gets to the end of the data, and waits there; any other has braked before.
void Controller::run_dry() {
  if (options_.time_scale == kAsFastAsDataComes) return;
  path_.stop_at_once();
  come_to_rest();
}

double Controller::to_next_pose_s() const {
  return static_cast<double>(poses_written_) * kPoseStep_s - motion_s_;
}

// The path clock's time to the next thing that happens: waypoint, pose, end of a ramp, start of braking, end
// of the budget.
double Controller::step_length(double budget_s) const {
  const double to_waypoint = path_.time_to(to_next_waypoint_s());
  double to_event = std::max(to_next_pose_s(), 0.0);
  if (options_.faults.estop_at_s)
    to_event = std::min(to_event, std::max(*options_.faults.estop_at_s - motion_s_, 0.0));
  double step = std::min({budget_s, to_waypoint, to_event * options_.faults.slow, path_.ramp_left_s()});
  if (path_.backwards())
    return path_.stopping() ? step : std::min(step, path_.time_to_brake_for(to_boundary_s()));
  const bool complete = job_.accepted() == job_.count;
  if (!complete && !path_.stopping() && options_.time_scale != kAsFastAsDataComes) {
    const double until_braking = data_end_s() - path_.path_s() - path_.braking_s();
    step = std::min(step, std::max(until_braking, kRampLook_s));
    if (std::isfinite(path_.ramp_left_s())) step = std::min(step, kRampLook_s);
  }
  return step;
}

// After a step: what became due, in the order of time.
void Controller::settle() {
  constexpr double kRounding_s = 1e-9;  // far below the microsecond that times are given in
  if (to_next_waypoint_s() <= kRounding_s) path_.snap(time_s(path_.backwards() ? from_ : to_));
  sample_due_poses();
  estop_as_told();
  if (path_.backwards()) {
    step_back();
  } else {
    execute_due();
  }
  if (state_ != State::kRunning && state_ != State::kFault) return;
  if (!path_.at_rest() || phase_ == Phase::kReheat) return;
  if (path_.backwards() && stop_reason_ == StopReason::kNone) return begin_reheat();
  come_to_rest();
}

void Controller::execute_due() {
  if (path_.backwards()) return;
  if (job_.executed == 0 && job_.accepted() > 0 && moving()) {
    execute_next();
    sample_due_poses();
  }
  // A step begins as soon as its end has been accepted. On the way back into a kerf it ends at a waypoint
  // that has been executed before.
  while (job_.executed > 0 && step_ + 1 < job_.accepted() && moving()) {
    if (to_.t_us == from_.t_us) to_ = protocol::decode_waypoint(job_.raw[step_ + 1]).waypoint;
    if (path_.path_s() < time_s(to_)) return;
    if (step_ + 1 < job_.executed) {
      load_step(step_ + 1);
    } else {
      execute_next();
    }
  }
}

void Controller::execute_next() {
  const protocol::RawWaypoint& raw = job_.raw[job_.executed];
  const auto decoded = protocol::decode_waypoint(raw);
  Breach broken{decoded.error != Limit::kNone ? decoded.error : job_.execution.next(decoded.waypoint)};
  if (broken.limit == Limit::kNone)
    broken.limit = job_.moved_blade.move_to({decoded.waypoint.a, decoded.waypoint.b});
  if (broken.limit == Limit::kNone)
    broken = job_.moved_arms.arrive(decoded.waypoint, job_.moved_blade.shape());
  if (broken.limit != Limit::kNone) {
    path_.stop_at_once();
    fail(Fault::kExecutionLimit, broken, job_.executed);
    return;
  }
  const Sha256& chain = chain_.add(raw);
  job_.executed_crc = protocol::crc32(raw, job_.executed_crc);
  if (sink_ != nullptr) {
    sink_->executed({job_.id, token_, job_.executed, decoded.waypoint.t_us, motion_us(), raw, chain,
                     job_.moved_blade.margins()});
  }
  from_ = to_ = decoded.waypoint;
  step_ = job_.executed++;
  phase_ = Phase::kProgram;
  uncommitted_ = true;
  fail_as_told(job_.executed - 1);
  if (job_.executed < job_.count) return;
  path_.stop_at_once();
  if (state_ == State::kFault) return;
  state_ = State::kDone;
  heat_off_ = true;
  report("done");
}

void Controller::sample_due_poses() {
  // Half a microsecond: a pose that is due at this very step is not put off by rounding.
  constexpr double kDue_s = 5e-7;
  if (static_cast<double>(poses_written_) * kPoseStep_s > motion_s_ + kDue_s) return;
  const Breach broken = write_pose();
  ++poses_written_;
  if (broken.limit == Limit::kNone || state_ == State::kFault) return;
  path_.stop_at_once();
  fail(Fault::kExecutionLimit, broken, job_.executed);
}

// The pose on the path, with the blade's shape and the arms' joints; the limit that breaks there.
Breach Controller::write_pose() {
  const bool asked_for = sink_ != nullptr || job_.moved_blade.checks() || job_.moved_arms.checks();
  if (job_.executed == 0 || !asked_for) return {};
  const ClampPoses now = held_ ? *held_ : pose_on(from_, to_, path_.path_s());
  Breach broken{job_.moved_blade.move_to(now)};
  const Breach of_arms =
      job_.moved_arms.move_to(now.a, now.b, job_.moved_blade.shape(), time_s(to_) - time_s(from_));
  if (broken.limit == Limit::kNone) broken = of_arms;
  if (sink_ != nullptr) {
    sink_->pose({job_.id, step_, motion_us(), now.a, now.b, from_.heat && !heat_off_, state_, path_.path_s(),
                 following_mm(), job_.moved_blade.shape(), job_.moved_arms.joints()});
  }
  return broken;
}

ClampPoses Controller::pose_on(const Waypoint& from, const Waypoint& to, double path_s) {
  const double length = time_s(to) - time_s(from);
  const double share = length > 0 ? std::clamp((path_s - time_s(from)) / length, 0.0, 1.0) : 0;
  return interpolate({from.a, from.b}, {to.a, to.b}, share);
}

void Controller::stop(StopReason reason) {
  // A fault overrides a hold; a hold asked for overrides a watchdog on its way.
  if (stop_reason_ == StopReason::kFault) return;
  stop_reason_ = reason;
  path_.slow_down();
  if (path_.at_rest()) come_to_rest();
}

void Controller::come_to_rest() {
  held_since_us_ = now_us_;
  phase_ = Phase::kProgram;
  lag_s_ = 0;
  if (stop_reason_ == StopReason::kFault || state_ == State::kFault) {
    if (loaded_) write_pose();
    return;
  }
  if (stop_reason_ == StopReason::kWatchdog) fault_ = Fault::kWatchdog;
  if (stop_reason_ == StopReason::kUnderrun) fault_ = Fault::kUnderrun;
  if (fault_ != Fault::kNone) {
    fault_detail_ = 0;  // that of a window that was refused before
    fault_sequence_ = job_.executed;
    fault_arms_ = {};
  }
  state_ = State::kHeld;
  stop_reason_ = StopReason::kNone;
  write_pose();
  report("held");
}

void Controller::fail(Fault fault, const Breach& breach, std::uint32_t sequence) {
  fault_ = fault;
  fault_detail_ = info(breach.limit).code;
  fault_sequence_ = sequence;
  fault_arms_ = breach.detail;
  state_ = State::kFault;
  report("fault");
  stop(StopReason::kFault);
}

void Controller::cool_when_due() {
  const bool standing = state_ == State::kHeld || (state_ == State::kFault && path_.at_rest());
  if (!standing || heat_off_ || now_us_ - held_since_us_ < std::uint64_t{options_.heat_dwell_ms} * 1000)
    return;
  heat_off_ = true;
  write_pose();
  report("cold");
}

}  // namespace hotblade::robot

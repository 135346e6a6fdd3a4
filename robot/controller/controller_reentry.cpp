// The controller's way back to work: out of the kerf with a cold blade, reheated where the program heats it,
// into the kerf again and on; and how a restarted controller takes up its journal.
#include <algorithm>
#include <string>

#include "robot/controller/controller.hpp"

namespace hotblade::robot {

using protocol::Fault;
using protocol::Phase;
using protocol::State;

namespace {

constexpr double kMicrosecond = 1e-6;
constexpr double kRounding_s = 1e-9;  // far below the microsecond that times are given in

double time_s(const protocol::RawWaypoint& raw) {
  return protocol::time_us(raw) * kMicrosecond;
}

}  // namespace

// A blade that stands hot goes straight on. One that has gone cold in foam would be bent by it instead of
// melting its way: it goes back along its own kerf to where the heat came on.
void Controller::go_on_from_held() {
  if (heat_off_ && protocol::is_hot(job_.raw[step_])) return begin_retract();
  heat_off_ = false;
  phase_ = step_ + 1 < job_.executed ? Phase::kReenter : Phase::kProgram;
  path_.face(false);
  path_.speed_up();
}

void Controller::begin_retract() {
  boundary_ = step_;
  while (boundary_ > 0 && protocol::is_hot(job_.raw[boundary_ - 1])) --boundary_;
  load_step(step_);
  phase_ = Phase::kRetract;
  report("retract");
  path_.face(true);
  step_back();
  if (to_boundary_s() <= kRounding_s) return begin_reheat();  // it stands there already
  path_.speed_up();
}

// Whether the blade stands where the program has it hot: in the foam, or about to enter it.
bool Controller::in_cut() const {
  return job_.executed > 0 && job_.executed < job_.count && protocol::is_hot(job_.raw[step_]);
}

// A job that was lost to RESET, on the place of its path where it stopped: HELD, with a cold blade.
protocol::Result Controller::take_up_again() {
  loaded_ = true;
  left_in_cut_ = false;
  state_ = State::kHeld;
  phase_ = Phase::kProgram;
  stop_reason_ = StopReason::kNone;
  held_since_us_ = now_us_;
  heat_off_ = true;
  give_token("takeover");
  return protocol::Result::kOk;
}

// Out of the foam the way the blade came in, and on to where the strip began; cold, so that the kerf is not
// widened. The job ends there.
protocol::Result Controller::withdraw() {
  // After a restart the path is known to lead through the held pose only when the next waypoint has come.
  if (state_ != State::kHeld || job_.executed == 0 || held_ || arms_unknown())
    return protocol::Result::kState;
  state_ = State::kRunning;
  clear_fault();
  stop_reason_ = StopReason::kNone;
  if (!on_record("withdraw")) return protocol::Result::kState;
  heat_off_ = true;
  withdrawing_ = true;
  boundary_ = 0;
  phase_ = Phase::kRetract;
  path_.face(true);
  step_back();
  if (to_boundary_s() <= kRounding_s) {
    end_withdrawal();
  } else {
    path_.speed_up();
  }
  return protocol::Result::kOk;
}

void Controller::end_withdrawal() {
  path_.face(false);
  withdrawing_ = false;
  phase_ = Phase::kProgram;
  state_ = State::kIdle;
  write_pose();
  report("withdrawn");
  loaded_ = false;
}

// The operator says that the blade is out.
protocol::Result Controller::release() {
  if (!left_in_cut_) return protocol::Result::kState;
  report("release");
  left_in_cut_ = false;
  return protocol::Result::kOk;
}

double Controller::to_boundary_s() const {
  return path_.path_s() - time_s(job_.raw[boundary_]);
}

// Comes to rest at the boundary. An instant clock rests there at once.
void Controller::brake_for_boundary() {
  if (path_.stopping() || path_.time_to_brake_for(to_boundary_s()) > kRounding_s) return;
  path_.slow_down();
  if (path_.at_rest()) begin_reheat();
}

// Past the waypoints on the way back. At the boundary what is left of the rate is rounding.
void Controller::step_back() {
  while (step_ > boundary_ && path_.path_s() <= time_s(job_.raw[step_])) load_step(step_ - 1);
  if (to_boundary_s() <= kRounding_s) path_.stop_at_once();
}

void Controller::begin_reheat() {
  path_.stop_at_once();
  if (withdrawing_) return end_withdrawal();
  path_.snap(time_s(job_.raw[boundary_]));
  path_.face(false);
  load_step(boundary_);
  phase_ = Phase::kReheat;
  heat_off_ = false;
  reheated_at_s_ = motion_s_ + options_.reheat_ms * 1e-3;
  report("reheat");
}

void Controller::spend_reheating(double& budget_s) {
  const double step =
      std::min({budget_s, std::max(reheated_at_s_ - motion_s_, 0.0), std::max(to_next_pose_s(), 0.0)});
  motion_s_ += step;
  budget_s -= step;
  sample_due_poses();
  if (motion_s_ < reheated_at_s_ - kRounding_s) return;
  phase_ = Phase::kReenter;
  report("reenter");
  path_.speed_up();
}

void Controller::load_step(std::uint32_t index) {
  step_ = index;
  from_ = protocol::decode_waypoint(job_.raw[index]).waypoint;
  to_ = index + 1 < job_.accepted() ? protocol::decode_waypoint(job_.raw[index + 1]).waypoint : from_;
}

void Controller::restore(const ControllerJournal& journal) {
  const bool blank = !journal.loaded && journal.token == 0 && journal.state == State::kIdle;
  if (blank) return;
  if (journal.count > options_.max_waypoints) {
    throw LogError("the journal's job is too large (" + std::to_string(journal.count) +
                   " waypoints, at most " + std::to_string(options_.max_waypoints) +
                   "): another machine's log?");
  }
  token_ = journal.token;
  loaded_ = journal.loaded;
  state_ = journal.state;
  load(journal.job, journal.run, journal.count, journal.blade);
  fault_ = state_ == State::kHeld ? Fault::kRestart : journal.fault;
  fault_detail_ = journal.fault_detail;
  fault_sequence_ = journal.fault_sequence;
  fault_arms_ = journal.fault_arms;
  replay(journal);
  published_executed_ = job_.executed;
  published_crc_ = job_.executed_crc;
  motion_s_ = static_cast<double>(journal.motion_us) * kMicrosecond;
  constexpr double kPosesPerS = 100;
  poses_written_ = static_cast<std::uint64_t>(motion_s_ * kPosesPerS) + 1;
  heat_off_ = true;
  left_in_cut_ = journal.left && in_cut();
  report("restart");
}

// Everything executed, through both checks again: what comes next is judged against it.
void Controller::replay(const ControllerJournal& journal) {
  if (journal.arms && options_.arms) {
    job_.arms = journal.arms;
    job_.accepted_arms = job_.moved_arms =
        ArmCheck(options_.arms, *journal.arms, journal.job, journal.blade.width_mm, options_.blade.offsets.a);
  }
  if (journal.executed.empty()) return;
  for (const auto& raw : journal.executed) {
    const auto decoded = protocol::decode_waypoint(raw);
    Limit code = decoded.error != Limit::kNone ? decoded.error : job_.execution.next(decoded.waypoint);
    if (code == Limit::kNone) code = job_.moved_blade.next(decoded.waypoint);
    if (code == Limit::kNone) code = job_.moved_arms.next(decoded.waypoint, job_.moved_blade.shape()).limit;
    if ((loaded_ || journal.left) && code != Limit::kNone) {
      throw LogError("the journal's waypoint " + std::to_string(job_.executed) + " breaks a limit (" +
                     info(code).fault + "): start with the machine file it was run with");
    }
    job_.raw.push_back(raw);
    job_.executed_crc = protocol::crc32(raw, job_.executed_crc);
    ++job_.executed;
  }
  job_.acceptance = job_.execution;
  job_.accepted_blade = job_.moved_blade;
  job_.accepted_arms = job_.moved_arms;
  job_.accepted_crc = job_.executed_crc;
  chain_.resume(journal.chain);
  path_.snap(journal.path_s);
  std::uint32_t step = job_.executed - 1;
  while (step > 0 && time_s(job_.raw[step]) > journal.path_s + kRounding_s) --step;
  // The blade went back the way it came.
  for (std::uint32_t i = job_.executed; i-- > step;) {
    const Waypoint passed = protocol::decode_waypoint(job_.raw[i]).waypoint;
    (void)job_.moved_blade.move_to({passed.a, passed.b});
    (void)job_.moved_arms.move_to(passed.a, passed.b, job_.moved_blade.shape(), 0);
  }
  load_step(step);
  if (step + 1 == job_.executed) {
    held_ = journal.held;
  } else if ((loaded_ || journal.left) && journal.held) {
    held_ = journal.held;
    if (!agrees_with_held_pose(from_, to_))
      throw LogError("the journal's last pose is not on its path: the clamps were moved; see to the machine");
    held_.reset();
  }
}

bool Controller::agrees_with_held_pose(const Waypoint& from, const Waypoint& to) const {
  // Far above the log's decimals and half a microsecond on the way, far below what a blade feels.
  constexpr double kSlack_mm = 0.01, kSlack_rad = 1e-4;
  const ClampPoses path = pose_on(from, to, path_.path_s());
  const auto near = [](const Pose& a, const Pose& b) {
    return (a.p - b.p).norm() <= kSlack_mm && a.q.angularDistance(b.q) <= kSlack_rad;
  };
  return near(path.a, held_->a) && near(path.b, held_->b);
}

}  // namespace hotblade::robot

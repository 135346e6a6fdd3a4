#include "robot/controller/simulated_faults.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "robot/controller/controller.hpp"

namespace hotblade::robot {

using protocol::Fault;
using protocol::State;

namespace {

// With drives slower than asked for, the controller lets the place it asks for run ahead by no more than this
// much of the path's time: 1 mm at 100 mm/s.
constexpr double kMostLag_s = 0.01;
// Clamps that stand where the path hardly moves are noticed after this.
constexpr double kLongestStall_s = 1;

template <typename Number>
Number parse(const std::string& spec, const std::string& text, const char* wanted,
             const std::string& example) {
  Number value{};
  const char* const end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, value);
  if (parsed.ec != std::errc() || parsed.ptr != end)
    throw FaultSpecError(spec + ": no number (" + text + ", " + wanted + "): write it as in " + example);
  return value;
}

}  // namespace

void SimulatedFaults::add(const std::string& spec) {
  const auto at = spec.find_first_of("=@");
  const std::string kind = spec.substr(0, at);
  const std::string value = at == std::string::npos ? "" : spec.substr(at + 1);
  const char sign = at == std::string::npos ? '\0' : spec[at];
  const auto waypoint = [&] { return parse<std::uint32_t>(spec, value, "a waypoint from 0", kind + "@120"); };
  if (kind == "slow" && sign == '=') {
    slow = parse<double>(spec, value, "0.001 to 1", "slow=0.5");
    constexpr double kSlowest = 0.001;  // below that a job of a minute takes a day
    if (!(slow >= kSlowest && slow <= 1))
      throw FaultSpecError(spec + ": out of range (" + value + ", 0.001 to 1): a share of the speed");
  } else if (kind == "fault" && sign == '@') {
    drive_at = waypoint();
  } else if (kind == "reboot" && sign == '@') {
    reboot_at = waypoint();
  } else if (kind == "stall" && sign != '=') {
    stall_at = sign == '@' ? waypoint() : 0;
  } else if (kind == "estop" && sign == '@') {
    estop_at_s = parse<double>(spec, value, "seconds from 0", "estop@3.5");
    if (!(*estop_at_s >= 0 && std::isfinite(*estop_at_s)))
      throw FaultSpecError(spec + ": out of range (" + value + ", from 0): seconds of the motion clock");
  } else {
    throw FaultSpecError(spec +
                         ": unknown fault: use slow=FACTOR, fault@WAYPOINT, estop@SECONDS, "
                         "reboot@WAYPOINT, stall or stall@WAYPOINT");
  }
}

// What an executed waypoint sets off.
void Controller::fail_as_told(std::uint32_t executed) {
  SimulatedFaults& faults = options_.faults;
  if (faults.reboot_at && executed >= *faults.reboot_at) {
    faults.reboot_at.reset();
    reboot_due_ = true;
  }
  if (faults.drive_at && executed >= *faults.drive_at) {
    faults.drive_at.reset();
    fail(Fault::kDrive, {}, executed);
  }
}

void Controller::estop_as_told() {
  if (!options_.faults.estop_at_s || motion_s_ < *options_.faults.estop_at_s) return;
  options_.faults.estop_at_s.reset();
  latch_estop();
}

bool Controller::stalled() const {
  return options_.faults.stall_at && job_.executed > *options_.faults.stall_at;
}

// The place asked for goes on, the clamps do not: until that is seen.
void Controller::ask_in_vain(double& budget_s) {
  const double to_pose = std::max(to_next_pose_s(), 0.0);
  const double step = std::min(budget_s, to_pose);
  motion_s_ += step;
  lag_s_ += step;
  budget_s -= step;
  sample_due_poses();
  if (state_ == State::kRunning && following_mm() <= options_.following_mm && lag_s_ < kLongestStall_s)
    return;
  path_.stop_at_once();
  if (state_ == State::kRunning) return fail(Fault::kFollowing, {}, job_.executed);
  come_to_rest();
}

void Controller::fall_behind(double motion_s, double path_s) {
  lag_s_ = std::min(lag_s_ + std::max(motion_s - path_s, 0.0), kMostLag_s);
}

double Controller::following_mm() const {
  if (lag_s_ <= 0 || job_.executed == 0 || step_ + 1 >= job_.accepted()) return 0;
  const auto waypoint = [&](std::uint32_t i) { return protocol::decode_waypoint(job_.raw[i]).waypoint; };
  const double wanted_s = path_.path_s() + (path_.backwards() ? -lag_s_ : lag_s_);
  std::uint32_t step = step_;
  while (step + 2 < job_.accepted() && protocol::time_us(job_.raw[step + 1]) * 1e-6 < wanted_s) ++step;
  while (step > 0 && protocol::time_us(job_.raw[step]) * 1e-6 > wanted_s) --step;
  const ClampPoses is = pose_on(waypoint(step_), waypoint(step_ + 1), path_.path_s());
  const ClampPoses wanted = pose_on(waypoint(step), waypoint(step + 1), wanted_s);
  return std::max((wanted.a.p - is.a.p).norm(), (wanted.b.p - is.b.p).norm());
}

}  // namespace hotblade::robot

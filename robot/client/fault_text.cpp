#include "robot/client/fault_text.hpp"

namespace hotblade::robot {

std::string limit_text(Limit code, const MotionLimits& l) {
  const auto number = [](double value) {
    std::string text = std::to_string(value);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
    return text;
  };
  std::string text = info(code).fault;
  if (code == Limit::kSpeed) text += " (limit " + number(l.speed_mm_s) + " mm/s)";
  if (code == Limit::kAcceleration) text += " (limit " + number(l.accel_mm_s2) + " mm/s^2)";
  if (code == Limit::kAngularSpeed) text += " (limit " + number(l.angular_rad_s) + " rad/s)";
  if (code == Limit::kAngularAcceleration) text += " (limit " + number(l.angular_accel_rad_s2) + " rad/s^2)";
  if (code == Limit::kMinDt) text += " (limit " + std::to_string(l.min_dt_us) + " us)";
  return text;
}

std::string state_text(const protocol::Status& status) {
  std::string text = protocol::name(status.state);
  if (status.state == protocol::State::kFault) text += std::string(" ") + protocol::name(status.fault);
  return text;
}

std::string log_fault_text(const protocol::Status& status) {
  if (status.fault != protocol::Fault::kLog) return "";
  return "the controller cannot write its execution log: see to its disk";
}

}  // namespace hotblade::robot

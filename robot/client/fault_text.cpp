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

}  // namespace hotblade::robot

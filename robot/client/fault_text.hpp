// What is said of limits and faults of a controller.
#pragma once

#include <string>

#include "robot/pose/limits.hpp"
#include "robot/wire/protocol.hpp"

namespace hotblade::robot {

// Returns what broke, with the limit where it is one of the machine's motion.
[[nodiscard]] std::string limit_text(Limit code, const MotionLimits& limits);

}  // namespace hotblade::robot

// What is said of limits and faults of a controller.
#pragma once

#include <string>

#include "robot/pose/limits.hpp"
#include "robot/wire/protocol.hpp"

namespace hotblade::robot {

// Returns what broke, with the limit where it is one of the machine's motion.
[[nodiscard]] std::string limit_text(Limit code, const MotionLimits& limits);

// Returns the state, of a FAULT with the fault: "FAULT LOG".
[[nodiscard]] std::string state_text(const protocol::Status& status);

// Returns why the log's fault stands and what is to be seen to before --reset; of others nothing.
[[nodiscard]] std::string log_fault_text(const protocol::Status& status);

}  // namespace hotblade::robot

// What a controller executes: both clamps against time, in the cell frame.
#pragma once

#include <cstdint>

#include "robot/pose/pose.hpp"

namespace hotblade::robot {

// Where both clamps are at a time, and whether the blade is heated from here on.
struct Waypoint {
  std::uint32_t t_us = 0;  // from the strip's start
  bool heat = false;
  Pose a, b;  // clamps, cell frame, mm
};

}  // namespace hotblade::robot

// What a controller executes: both clamps against time, in the cell frame.
#pragma once

#include <cstdint>

#include "robot/pose/pose.hpp"

namespace hotblade::robot {

struct Waypoint {
  std::uint32_t t_us = 0;  // from the strip's start
  bool heat = false;
  Pose a, b;  // clamps, cell frame, mm
};

}  // namespace hotblade::robot

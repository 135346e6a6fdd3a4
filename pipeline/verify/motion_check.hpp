// What a program's motion asks of machine, heat and block, looked at again: it is all that a cut needs beside
// its shapes.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

// One thing that does not hold, the first of its kind in its strip.
struct MotionBreach {
  std::string strip;
  std::size_t pose = 0;  // index into the strip's poses
  double t_s = 0;        // of that pose
  std::string text;      // strip or rib, limit, amount, phase and time
};

// Returns what does not hold, strip by strip:
// - clamps within the machine's limits, as a controller checks them (robot/pose/limits.hpp), and as high
// above
//   the table as `stock.clearance_mm`;
// - the blade hot, and forming the design, from the first pose that does to the last, after standing hot for
//   `motion.preheat_s`; phases in their order, as heat and foam are;
// - the blade in foam no slower all over than `motion.min_feed_mm_s`;
// - what is in foam within the strip's block, and the block not below the table.
[[nodiscard]] std::vector<MotionBreach> check_motion(const Program& program);

}  // namespace hotblade::pipeline

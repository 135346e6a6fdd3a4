// Poses read straight from a program's text. A job has tens of thousands of them, nearly all of its text, and
// a tree of JSON values takes ten times as long to build as the numbers take to read.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

// A strip's poses, and the joints of its arms at each of them or none.
struct ScannedPoses {
  std::vector<BladePose> poses;
  std::vector<ClampJoints> joints;
};

// Returns the poses of a strip with this blade and so many ribs, whose clamps are told to be farther apart
// than they hold the blade by `clamp_reach_mm` at most, if `text` begins with the items of their array laid
// out as to_json() does it and each holds all that parse_program() asks of it, and moves `text` on behind the
// closing bracket. Returns nothing otherwise: reading the tree tells what is wrong, or takes another layout.
[[nodiscard]] std::optional<ScannedPoses> scan_poses(std::string_view& text, double blade_length_mm,
                                                     double clamp_reach_mm, std::size_t ribs);

}  // namespace hotblade::pipeline

// The motion that an execution log tells of: clamps and blade every 10 ms (docs/controller-protocol.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include "elastica/curve/elastica.hpp"
#include "robot/pose/pose.hpp"

namespace hotblade::robot {

// Clamps and blade at one moment of the log.
struct LoggedPose {
  std::uint32_t sequence = 0;  // the last executed waypoint
  double t = 0;                // s of the motion clock
  double path_s = 0;           // the place on the path, in the strip's own time
  Pose a, b;                   // cell frame, mm; q of unit length
  bool heat = false;
  std::optional<elastica::Elastica> blade;  // clamp A to clamp B, in clamp A's axes
};

// Returns the poses by job id, in the order of the log; where a job was run more than once, those of its last
// run. It passes over lines of other kinds. Throws LogError for a file that cannot be read and for a pose
// line that is none, with its number.
[[nodiscard]] std::map<std::uint64_t, std::vector<LoggedPose>> read_execution_poses(
    const std::filesystem::path& file);

}  // namespace hotblade::robot

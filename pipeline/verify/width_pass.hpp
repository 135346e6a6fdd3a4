// How deep the width of a blade passes over places of its own cut, pose by pose. Slope and bend of the cut
// say that of a motion that is smooth (robot::over_width_mm). One that was executed is not: clamps are told
// micrometres, of which a nearly straight blade makes tenths, and a slope between two such poses is none that
// the width has anywhere.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

// Returns for even places of the part in foam of one of some poses in order how much deeper than that pose
// itself the width of any of them reaches there, mm, along the unit normals of the cut, which point to the
// waste: no less than 0. `plane_normals` are the directions of the pose's width there, as it hangs. Nothing
// where the poses end, or are farther apart than the width, before all of it has passed.
[[nodiscard]] std::optional<std::vector<double>> width_passes_mm(
    std::span<const BladePose> poses, std::size_t row, std::span<const Eigen::Vector3d> normals,
    std::span<const Eigen::Vector3d> plane_normals, double width_mm);

}  // namespace hotblade::pipeline

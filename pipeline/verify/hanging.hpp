// Where the points of a blade are that hangs between its clamps: beside the plane that they hold it in.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "pipeline/program/program.hpp"
#include "robot/blade/blade_section.hpp"

namespace hotblade::pipeline {

// Returns gravity along a frame's x, y and x cross y, for a strip on the table: a unit vector.
[[nodiscard]] Eigen::Vector3d down_in_plane(const Pose& design_to_cell, const Frame& frame);

// Returns how a blade in a frame's plane hangs. One that tips out of its plane has no such shape; it is taken
// as weightless, and the plan refuses it by name.
[[nodiscard]] robot::SagProfile hanging(const elastica::Elastica& blade, const Frame& frame,
                                        const Pose& design_to_cell, const robot::Blade& section);

// Returns the same of many blades at once, each in its frame.
[[nodiscard]] std::vector<robot::SagProfile> hanging(std::span<const elastica::Elastica> blades,
                                                     std::span<const Frame> frames,
                                                     const Pose& design_to_cell, const robot::Blade& section);

// How weight moves one point of a blade, in the design frame.
struct Hang {
  Eigen::Vector3d shift_mm{0, 0, 0};
  Eigen::Vector3d plane_normal{0, 0, 1};  // the blade's width stands along it: the frame's, twisted
};
// `tangent` is the blade's there, in the frame.
[[nodiscard]] Hang hang_of(const robot::SagProfile::Value& sag, const Frame& frame,
                           const Eigen::Vector2d& tangent);

}  // namespace hotblade::pipeline

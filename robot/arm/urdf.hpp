// An arm from its maker's description: the part of URDF that says where axes and bodies are.
//
// Read: robot, link, collision (origin, geometry with mesh, box, cylinder or sphere), joint revolute,
// continuous or fixed (origin, parent, child, axis, limit, the soft limits of safety_controller, mimic).
// Visuals, inertias, materials and what simulators add are left out and counted. Everything else is an error
// with its line: an arm that is half read is another arm.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "robot/arm/arm.hpp"
#include "robot/arm/shape.hpp"

namespace hotblade::robot {

// A joint of a side branch that turns with one of the six: by `factor` of its angle and `offset_rad`.
struct MimicJoint {
  Eigen::Vector3d axis{0, 0, 1}, point_mm{0, 0, 0};  // at zero, in base_link
  std::size_t joint = 0;
  double factor = 1, offset_rad = 0;
};

// A link with a shape, or more that move as one. Shapes are placed in base_link with all joints at zero.
struct Body {
  std::string link;
  std::size_t moved_by = 0;        // 0: base_link, else the link after joint `moved_by`
  std::vector<MimicJoint> mimics;  // then these, in this order; empty for the six links
  std::vector<Shape> shapes;
};

struct ArmModel {
  Arm arm;
  std::vector<Body> bodies;
  std::vector<std::string> ignored;  // "visual x7"
  // The base and links that move, by name, where neither they nor what is fixed to them have a shape.
  std::vector<std::string> shapeless;
};

// Returns the motions of all bodies from where they are at zero.
[[nodiscard]] std::vector<Eigen::Isometry3d> body_motions(const ArmModel& model, const JointAngles& q);

// Returns the arm of a text, its meshes read from beside `folder`. Throws ModelError with `name:line: what`.
[[nodiscard]] ArmModel parse_urdf(const std::string& text, const std::string& name,
                                  const std::filesystem::path& folder);

// Returns the arm of a file. Throws ModelError: `missing` where the file or one of its meshes is not there.
[[nodiscard]] ArmModel read_urdf(const std::filesystem::path& file);

}  // namespace hotblade::robot

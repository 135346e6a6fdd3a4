// The elements of a URDF text, each checked on its own: links with their shapes, joints with their limits.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "robot/arm/shape.hpp"

namespace hotblade::robot {

struct UrdfLink {
  std::string name;
  int line = 0;
  std::vector<Shape> shapes;  // in the link's frame
};

struct UrdfMimic {
  std::string joint;
  double factor = 1, offset_rad = 0;
  int line = 0;
};

enum class UrdfJointKind { kFixed, kTurning };

struct UrdfJoint {
  std::string name;
  int line = 0;
  UrdfJointKind kind = UrdfJointKind::kFixed;
  Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();  // of the child in the parent
  std::string parent, child;
  Eigen::Vector3d axis{1, 0, 0};  // unit, in the child's frame
  double min_rad = 0, max_rad = 0, speed_rad_s = 0;
  std::optional<UrdfMimic> mimic;
};

struct UrdfElements {
  std::string robot;
  int line = 0;
  std::vector<UrdfLink> links;
  std::vector<UrdfJoint> joints;
  std::vector<std::string> ignored;  // "visual x7"
};

// Throws ModelError with `name:line: what`.
[[nodiscard]] UrdfElements parse_urdf_elements(const std::string& text, const std::string& name,
                                               const std::filesystem::path& folder);

}  // namespace hotblade::robot

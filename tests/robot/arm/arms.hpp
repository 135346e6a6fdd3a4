// Arms that the tests take: those the project ships, and those of the makers where their files are there.
#pragma once

#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "robot/arm/urdf.hpp"
#include "tests/paths.hpp"

namespace hotblade::robot {

inline constexpr const char* kShippedArms[] = {"abb_irb4600_40_255", "kuka_kr50_r2500"};

inline std::filesystem::path shipped_arm(const std::string& name) {
  return std::filesystem::path(hotblade::testing::source_dir()) / "data/arms" / name / "arm.urdf";
}

// The makers' own files, which are not committed: beside the source tree or a folder above, or where
// HOTBLADE_MAKERS_ARMS says.
inline std::filesystem::path makers_arm(const std::string& name) {
  if (const char* folder = std::getenv("HOTBLADE_MAKERS_ARMS"))
    return std::filesystem::path(folder) / name / "arm.urdf";
  const std::filesystem::path root = hotblade::testing::source_dir();
  for (const char* shared : {"../shared/arms", "../../shared/arms"}) {
    if (std::filesystem::exists(root / shared / name / "arm.urdf"))
      return (root / shared / name / "arm.urdf").lexically_normal();
  }
  return root / "../shared/arms" / name / "arm.urdf";
}

// All arms that are there; those of the makers last.
inline std::vector<std::filesystem::path> arm_files() {
  std::vector<std::filesystem::path> files;
  for (const char* name : kShippedArms) files.push_back(shipped_arm(name));
  for (const char* name : kShippedArms) {
    if (std::filesystem::exists(makers_arm(name))) files.push_back(makers_arm(name));
  }
  return files;
}

// Joints evenly over the limits.
inline JointAngles random_joints(const Arm& arm, std::mt19937_64& random) {
  JointAngles q;
  for (int i = 0; i < static_cast<int>(kJoints); ++i) {
    const Joint& joint = arm.joints()[static_cast<std::size_t>(i)];
    q[i] = std::uniform_real_distribution(joint.min_rad, joint.max_rad)(random);
  }
  return q;
}

}  // namespace hotblade::robot

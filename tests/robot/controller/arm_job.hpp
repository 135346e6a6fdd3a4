// A cell of two arms that serve the sample job, with the joints that hold its clamps.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "robot/arm/arm_path.hpp"
#include "robot/arm/cell.hpp"
#include "robot/controller/arm_scene.hpp"
#include "tests/robot/arm/arms.hpp"
#include "tests/robot/wire/sample_job.hpp"

namespace hotblade::robot::testing {

inline constexpr std::uint64_t kCellId = 0x0123456789abcdef;

// As samples/cells/two_irb4600.toml has it.
inline Cell sample_cell() {
  Cell cell;
  cell.name = "two arms";
  for (const double side : {-1.0, 1.0}) {
    CellArm arm{side < 0 ? "R1" : "R2", "", "", read_urdf(shipped_arm("abb_irb4600_40_255"))};
    arm.base.p = {side * 2100, 0, 0};
    arm.base.q =
        Eigen::Quaterniond(Eigen::AngleAxisd(side < 0 ? 0 : std::numbers::pi, Eigen::Vector3d::UnitZ()));
    Shape box{Eigen::Isometry3d::Identity(), Box{{40, 40, 235}}};
    box.place.translation().z() = 117.5;
    arm.tool.shapes = {box};
    cell.arms.push_back(std::move(arm));
  }
  cell.table_mm = Eigen::Vector3d(1800, 1800, 50);
  return cell;
}

// Nothing that could touch, and nothing that could be too fast: what is left are places.
inline Cell bodiless(Cell cell) {
  for (CellArm& arm : cell.arms) {
    arm.model.bodies.clear();
    arm.tool.shapes.clear();
    arm.speed_share = 100;
    arm.acceleration_rad_s2.fill(1e6);
    arm.jerk_rad_s3.fill(1e9);
  }
  cell.table_mm.reset();
  return cell;
}

inline Eigen::Isometry3d place_of(const Pose& pose) {
  Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
  place.linear() = pose.q.toRotationMatrix();
  place.translation() = pose.p;
  return place;
}

// The jaw as the protocol's page has it.
inline Eigen::Isometry3d jaw_of(const Pose& clamp, bool clamp_b, bool flip) {
  Eigen::Isometry3d jaw = place_of(clamp);
  if (clamp_b) jaw.linear() = jaw.linear() * Eigen::Vector3d(-1, -1, 1).asDiagonal();
  if (flip) jaw.linear() = jaw.linear() * Eigen::Vector3d(1, -1, -1).asDiagonal();
  return jaw;
}

// The joints of each clamp's arm at every waypoint: of the branches by the closed form the one that keeps
// farthest from limits and from singular, as a plan would have it.
inline std::array<std::vector<JointAngles>, 2> planned_joints(const Cell& cell, const Job& job) {
  std::array<std::vector<JointAngles>, 2> best;
  for (const std::size_t clamp : {0, 1}) {
    const CellArm& arm = cell.arms[clamp];
    double most = -1;
    for (const bool flip : {false, true}) {
      std::vector<Eigen::Isometry3d> flanges;
      for (const protocol::RawWaypoint& raw : job.raw) {
        const Waypoint w = protocol::decode_waypoint(raw).waypoint;
        flanges.push_back(place_of(arm.base).inverse() * jaw_of(clamp == 0 ? w.a : w.b, clamp == 1, flip) *
                          jaw_in_flange(arm.tool).inverse());
      }
      for (const BranchPath& branch : follow_branches(arm.model.arm, flanges)) {
        if (branch.size() < flanges.size()) continue;
        std::vector<JointAngles> path;
        const Turns turns = fit_turns(arm.model.arm, branch);
        for (const JointAngles& q : branch) path.push_back(with_turns(q, turns));
        const PathMargins margins = path_margins(arm.model.arm, path);
        const double worst =
            std::min({margins.joint_rad.value, margins.wrist_rad.value, margins.elbow_rad.value});
        if (worst <= most) continue;
        most = worst;
        best[clamp] = path;
      }
    }
  }
  return best;
}

inline protocol::Arms declared(const std::array<std::vector<JointAngles>, 2>& joints,
                               std::uint32_t token = 0) {
  protocol::Arms arms{token, kCellId, {}};
  for (const std::size_t clamp : {0, 1}) {
    for (int i = 0; i < 6; ++i)
      arms.joints_rad[clamp][static_cast<std::size_t>(i)] = std::round(joints[clamp][0][i] * 1e6) / 1e6;
  }
  return arms;
}

inline std::shared_ptr<const ArmCell> shared_cell(const Cell& cell, const ArmCell::Limits& limits = {}) {
  return std::make_shared<const ArmCell>(cell, kCellId, limits);
}

}  // namespace hotblade::robot::testing

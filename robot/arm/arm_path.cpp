#include "robot/arm/arm_path.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hotblade::robot {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
// Below it joints 4 and 6 turn about one line, and only their sum is known.
constexpr double kStraightWrist_rad = 1e-9;

double nearest_turn(double angle, double before) {
  return before + std::remainder(angle - before, kTurn);
}

// Whether axes 4 and 6 are one line, and then which way axis 6 turns seen from axis 4.
double straight_wrist(const Arm& arm, const JointAngles& q) {
  if (singularity_distances(arm, q).wrist_rad > kStraightWrist_rad) return 0;
  const Eigen::Vector3d bent = Eigen::AngleAxisd(q[4], arm.joints()[4].axis) * arm.joints()[5].axis;
  return arm.joints()[3].axis.dot(bent) > 0 ? 1 : -1;
}

JointAngles continued(const Arm& arm, JointAngles q, const JointAngles& before) {
  if (const double way = straight_wrist(arm, q); way != 0) {
    q[5] += way * (q[3] - before[3]);
    q[3] = before[3];
  }
  for (int i = 0; i < q.size(); ++i) q[i] = nearest_turn(q[i], before[i]);
  return q;
}

}  // namespace

std::array<BranchPath, kBranches> follow_branches(const Arm& arm,
                                                  std::span<const Eigen::Isometry3d> flanges) {
  std::array<BranchPath, kBranches> paths;
  for (std::size_t pose = 0; pose < flanges.size(); ++pose) {
    const Solutions solutions = inverse(arm, flanges[pose]);
    bool one = false;
    for (std::size_t branch = 0; branch < kBranches; ++branch) {
      BranchPath& path = paths[branch];
      if (path.size() < pose || !solutions.there[branch]) continue;
      if (pose == 0) path.reserve(flanges.size());
      path.push_back(pose == 0 ? solutions.q[branch] : continued(arm, solutions.q[branch], path.back()));
      one = true;
    }
    if (!one) break;
  }
  return paths;
}

Turns fit_turns(const Arm& arm, std::span<const JointAngles> path) {
  Turns turns{};
  for (std::size_t i = 0; i < kJoints; ++i) {
    const Joint& joint = arm.joints()[i];
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const JointAngles& q : path) {
      low = std::min(low, q[static_cast<int>(i)]);
      high = std::max(high, q[static_cast<int>(i)]);
    }
    if (!(low <= high)) continue;
    const auto margin = [&](int n) {
      return std::min(low + n * kTurn - joint.min_rad, joint.max_rad - high - n * kTurn);
    };
    // The turn that brings the middles together is the best; a tie lies beside it.
    const double middle = (joint.min_rad + joint.max_rad - low - high) / 2;
    const int best = static_cast<int>(std::lround(middle / kTurn));
    for (const int n : {best - 1, best, best + 1}) {
      const double more = margin(n) - margin(turns[i]);
      if (more > 0 || (more == 0 && std::abs(n) < std::abs(turns[i]))) turns[i] = n;
    }
  }
  return turns;
}

JointAngles with_turns(const JointAngles& q, const Turns& turns) {
  JointAngles turned = q;
  for (std::size_t i = 0; i < kJoints; ++i) turned[static_cast<int>(i)] += turns[i] * kTurn;
  return turned;
}

PathMargins path_margins(const Arm& arm, std::span<const JointAngles> path) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  PathMargins margins{{kFar, 0, 0}, {kFar, 0, 0}, {kFar, 0, 0}, {kFar, 0, 0}};
  const auto offer = [](Least& least, double value, std::size_t pose, std::size_t joint) {
    if (value < least.value) least = {value, pose, joint};
  };
  for (std::size_t pose = 0; pose < path.size(); ++pose) {
    for (std::size_t i = 0; i < kJoints; ++i) {
      const double q = path[pose][static_cast<int>(i)];
      const Joint& joint = arm.joints()[i];
      offer(margins.joint_rad, std::min(q - joint.min_rad, joint.max_rad - q), pose, i);
    }
    const SingularityDistances d = singularity_distances(arm, path[pose]);
    offer(margins.wrist_rad, d.wrist_rad, pose, 0);
    offer(margins.elbow_rad, d.elbow_rad, pose, 0);
    offer(margins.shoulder_mm, d.shoulder_mm, pose, 0);
  }
  return margins;
}

}  // namespace hotblade::robot

#include "pipeline/plan/arms/strip_start.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pipeline/plan/arms/places.hpp"
#include "pipeline/program/straight_start.hpp"
#include "pipeline/sayings/saying.hpp"
#include "robot/arm/arm_path.hpp"

namespace hotblade::pipeline {
namespace {

using robot::JointAngles;
using robot::kDegree_rad;

// `what` names the arm, and what else is known of it.
Refusal refused(const Strip& strip, Limit limit, double value, double bound, const std::string& what) {
  Refusal refusal{strip.id, "", limit, value, bound, say(Saying::kAtTheStart, {what})};
  refusal.when = say(Saying::kBeforeTheStrip);
  refusal.at = middle_of(strip.poses.front());
  return refusal;
}

std::size_t branch_of(const HeldClamp& held) {
  for (std::size_t i = 0; i < robot::kBranches; ++i) {
    if (robot::branch_signs(i) == held.branch) return i;
  }
  return 0;
}

// Backwards from the strip's first pose; a pose that the branch does not have ends it.
std::vector<JointAngles> joints_back(const std::vector<BladePose>& poses, const robot::CellArm& arm,
                                     const Hold& hold, const HeldClamp& held, bool clamp_b,
                                     const JointAngles& first) {
  std::vector<JointAngles> back{first};
  for (std::size_t k = poses.size() - 1; k-- > 0;) {
    const robot::Solutions all =
        robot::inverse(arm.model.arm, hold.flange(clamp_b ? poses[k].b : poses[k].a));
    const std::size_t branch = branch_of(held);
    if (!all.there[branch]) break;
    JointAngles q = all.q[branch];
    for (int i = 0; i < q.size(); ++i)
      q[i] = back.back()[i] + std::remainder(q[i] - back.back()[i], 2 * M_PI);
    back.push_back(q);
  }
  return back;
}

std::optional<Refusal> limit_of(const Strip& strip, const robot::CellArm& arm, const robot::ArmMargins& least,
                                const std::vector<JointAngles>& path) {
  const robot::PathMargins m = robot::path_margins(arm.model.arm, path);
  const double joint = m.joint_rad.value / kDegree_rad, wrist = m.wrist_rad.value / kDegree_rad,
               elbow = m.elbow_rad.value / kDegree_rad;
  if (joint < least.joint_deg) {
    return refused(strip, Limit::kJointAngle, joint, least.joint_deg,
                   say(Saying::kArmJointNear, {arm.id, arm.model.arm.joints()[m.joint_rad.joint].name}));
  }
  const std::string which = say(Saying::kArm, {arm.id});
  if (wrist < least.wrist_deg) return refused(strip, Limit::kWristAngle, wrist, least.wrist_deg, which);
  if (elbow < least.elbow_deg) return refused(strip, Limit::kElbowAngle, elbow, least.elbow_deg, which);
  if (m.shoulder_mm.value < least.shoulder_mm)
    return refused(strip, Limit::kShoulderDistance, m.shoulder_mm.value, least.shoulder_mm, which);
  return std::nullopt;
}

}  // namespace

std::optional<Refusal> start_refusal(const Strip& strip, const robot::BladeSection& blade,
                                     const robot::Cell& cell, const HeldJoints& held,
                                     const std::array<HeldClamp, 2>& how) {
  Strip start = strip;
  start.poses = straight_start(strip);
  start.joints.clear();
  HeldJoints joints;
  joints.arm = held.arm;
  for (const std::size_t clamp : {0, 1}) {
    const robot::CellArm& arm = cell.arms[held.arm[clamp]];
    const Hold hold = hold_of(arm, strip.design_to_cell, clamp == 1, how[clamp].flip);
    std::vector<JointAngles> path =
        joints_back(start.poses, arm, hold, how[clamp], clamp == 1, held.joints[clamp].front());
    if (path.size() < start.poses.size()) {
      const BladePose& at = start.poses[start.poses.size() - 1 - path.size()];
      const robot::Reach reach = robot::reach(arm.model.arm, hold.flange(clamp == 1 ? at.b : at.a));
      return refused(strip, Limit::kArmReach, reach.from_axis_2_mm, reach.most_mm,
                     say(Saying::kArm, {arm.id}));
    }
    std::reverse(path.begin(), path.end());
    if (const auto broken = limit_of(strip, arm, cell.margins, path)) return broken;
    joints.joints[clamp] = std::move(path);
  }
  const robot::Clearance clear = prove_clear(start, blade, cell, joints);
  if (!clear.worst) return std::nullopt;
  return refused(strip, Limit::kArmClearance, clear.worst->distance_mm, clear.worst->clearance_mm,
                 describe(*clear.worst, start));
}

}  // namespace hotblade::pipeline

#include "pipeline/plan/arms/strip_arms.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gpu/backend/stop.hpp"
#include "pipeline/sayings/saying.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Isometry3d;
using robot::BranchPath;
using robot::kDegree_rad;

const robot::CellArm& arm_of(const robot::Cell& cell, const ArmPlace& place, bool clamp_b) {
  return cell.arms[clamp_b != place.swapped ? 1 : 0];
}

std::vector<Isometry3d> flanges(const Strip& strip, const Hold& hold, bool clamp_b) {
  std::vector<Isometry3d> path;
  path.reserve(strip.poses.size());
  for (const BladePose& pose : strip.poses) path.push_back(hold.flange(clamp_b ? pose.b : pose.a));
  return path;
}

std::vector<bool> ways_round(const robot::CellArm& arm) {
  return arm.tool.flip ? std::vector<bool>{false, true} : std::vector<bool>{false};
}

BranchPath turned(const robot::Arm& arm, const BranchPath& path, robot::Turns& turns) {
  turns = robot::fit_turns(arm, path);
  BranchPath with;
  with.reserve(path.size());
  for (const robot::JointAngles& q : path) with.push_back(robot::with_turns(q, turns));
  return with;
}

double score_of(const robot::PathMargins& m) {
  return share_of_good(m.joint_rad.value, m.wrist_rad.value, m.elbow_rad.value, m.shoulder_mm.value);
}

// One branch of one way round, and what is said of it.
class Judge {
 public:
  Judge(const Strip& strip, const robot::Cell& cell, const robot::CellArm& arm, bool clamp_b)
      : strip_(strip), cell_(cell), arm_(arm), clamp_b_(clamp_b) {}

  ArmChoice unreachable(const std::vector<Isometry3d>& path, std::size_t pose) const {
    ArmChoice choice;
    choice.rank = static_cast<double>(pose);
    const robot::Reach reach = robot::reach(arm_.model.arm, path[pose]);
    const bool near_axis_1 = reach.from_axis_1_mm < reach.least_from_axis_1_mm;
    const bool far = reach.from_axis_2_mm > reach.most_mm;
    const double value = near_axis_1 ? reach.from_axis_1_mm : reach.from_axis_2_mm;
    const double bound = near_axis_1 ? reach.least_from_axis_1_mm : far ? reach.most_mm : reach.least_mm;
    choice.refusal = refusal(Limit::kArmReach, value, bound, pose,
                             say(far && !near_axis_1 ? Saying::kArmShort : Saying::kArmTooNear,
                                 {arm_.id, clamp_b_ ? "b" : "a", std::abs(value - bound)}));
    return choice;
  }

  ArmChoice judge(const BranchPath& path, std::size_t branch, bool flip) const {
    ArmChoice choice;
    choice.held = {arm_.id, robot::branch_signs(branch), flip, {}};
    choice.joints = turned(arm_.model.arm, path, choice.held.turns);
    choice.margins = robot::path_margins(arm_.model.arm, choice.joints);
    choice.stage = ArmStage::kServed;
    choice.rank = score_of(choice.margins);
    check_limits(choice);
    if (choice.stage == ArmStage::kServed) check_singular(choice);
    return choice;
  }

 private:
  Refusal refusal(Limit limit, double value, double bound, std::size_t pose, std::string note) const {
    const BladePose& at = strip_.poses[pose];
    Refusal refusal{strip_.id, "", limit, value, bound, std::move(note)};
    refusal.when = say(Saying::kInPhase, {name(at.phase), at.t});
    refusal.at = middle_of(at);
    return refusal;
  }

  void stop(ArmChoice& choice, ArmStage stage, double rank, Refusal refused) const {
    choice.stage = stage;
    choice.rank = rank;
    choice.refusal = std::move(refused);
  }

  void check_limits(ArmChoice& choice) const {
    const robot::Least& least = choice.margins.joint_rad;
    const double margin = cell_.margins.joint_deg;
    const double left = least.value / kDegree_rad;
    if (left >= margin) return;
    const robot::Joint& joint = arm_.model.arm.joints()[least.joint];
    const double q = choice.joints[least.pose][static_cast<int>(least.joint)];
    const bool upper = q > (joint.min_rad + joint.max_rad) / 2;
    const double limit = (upper ? joint.max_rad : joint.min_rad) / kDegree_rad;
    stop(choice, ArmStage::kJointLimit, least.value,
         refusal(Limit::kJointAngle, q / kDegree_rad, limit - (upper ? margin : -margin), least.pose,
                 say(Saying::kJointBeyond, {arm_.id, joint.name, limit, margin, margin - left})));
  }

  void check_singular(ArmChoice& choice) const {
    const robot::PathMargins& m = choice.margins;
    const robot::ArmMargins& least = cell_.margins;
    const std::string singular = say(Saying::kArmSingular, {arm_.id});
    if (m.wrist_rad.value < least.wrist_deg * kDegree_rad) {
      stop(choice, ArmStage::kSingular, choice.rank,
           refusal(Limit::kWristAngle, m.wrist_rad.value / kDegree_rad, least.wrist_deg, m.wrist_rad.pose,
                   singular));
    } else if (m.elbow_rad.value < least.elbow_deg * kDegree_rad) {
      stop(choice, ArmStage::kSingular, choice.rank,
           refusal(Limit::kElbowAngle, m.elbow_rad.value / kDegree_rad, least.elbow_deg, m.elbow_rad.pose,
                   singular));
    } else if (m.shoulder_mm.value < least.shoulder_mm) {
      stop(choice, ArmStage::kSingular, choice.rank,
           refusal(Limit::kShoulderDistance, m.shoulder_mm.value, least.shoulder_mm, m.shoulder_mm.pose,
                   singular));
    }
  }

  const Strip& strip_;
  const robot::Cell& cell_;
  const robot::CellArm& arm_;
  bool clamp_b_;
};

bool further(const ArmChoice& a, const ArmChoice& b) {
  return a.stage != b.stage ? a.stage > b.stage : a.rank > b.rank;
}

}  // namespace

ArmChoice choose_branch(const Strip& strip, const robot::Cell& cell, const ArmPlace& place, bool clamp_b) {
  const robot::CellArm& arm = arm_of(cell, place, clamp_b);
  const Judge judge(strip, cell, arm, clamp_b);
  ArmChoice best;
  bool first = true;
  for (const bool flip : ways_round(arm)) {
    const Hold hold = hold_of(arm, placed(strip.design_to_cell, place), clamp_b, flip);
    const std::vector<Isometry3d> path = flanges(strip, hold, clamp_b);
    const auto branches = robot::follow_branches(arm.model.arm, path);
    for (std::size_t branch = 0; branch < robot::kBranches; ++branch) {
      gpu::stop_point();
      const std::size_t poses = branches[branch].size();
      ArmChoice choice =
          poses < path.size() ? judge.unreachable(path, poses) : judge.judge(branches[branch], branch, flip);
      if (first || further(choice, best)) best = std::move(choice);
      first = false;
    }
  }
  return best;
}

}  // namespace hotblade::pipeline

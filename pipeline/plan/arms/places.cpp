#include "pipeline/plan/arms/places.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hotblade::pipeline {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using robot::kDegree_rad;

// Between two heights that are tried: a tenth of what a block stands high. The search's are farther apart.
constexpr double kRaiseStep_mm = 100, kGridRaise_mm = 2 * kRaiseStep_mm;
// Margins beyond which a place is good enough: well clear of what an arm's calibration and a new jaw move.
constexpr double kGoodJoint_rad = 20 * kDegree_rad, kGoodWrist_rad = 20 * kDegree_rad;
constexpr double kGoodElbow_rad = 10 * kDegree_rad, kGoodShoulder_mm = 200;
// Poses that a score looks at: one in 7.5 s of motion at the usual step.
constexpr std::size_t kScoreStep = 150;
// A jaw this near to axis 6 turns about it.
constexpr double kOnAxis_mm = 1e-6, kOnAxis_rad = 1e-9;
constexpr double kTurn = 2 * M_PI;

Isometry3d isometry_of(const Pose& pose) {
  Isometry3d place = Isometry3d::Identity();
  place.linear() = pose.q.toRotationMatrix();
  place.translation() = pose.p;
  return place;
}

// Whether half a turn about the way the blade leaves is half a turn of joint 6.
bool flips_by_axis_6(const robot::CellArm& arm) {
  const robot::Joint& last = arm.model.arm.joints()[5];
  const Isometry3d jaw = arm.model.arm.flange_at_zero() * robot::jaw_in_flange(arm.tool);
  return jaw.linear().col(0).cross(last.axis).norm() <= kOnAxis_rad &&
         (jaw.translation() - last.point_mm).cross(last.axis).norm() <= kOnAxis_mm;
}

// The angle about an axis from one direction to another, both taken square to it.
double angle_to(const Vector3d& axis, const Vector3d& from, const Vector3d& to) {
  return std::atan2(axis.dot(from.cross(to)), from.dot(to) - axis.dot(from) * axis.dot(to));
}

double folded(double angle) {
  const double off = std::abs(std::remainder(angle, kTurn));
  return std::min(off, M_PI - off);
}

// What a joint has of its limits when it goes through a range, whole turns added as suits it best.
double margin_of(const robot::Joint& joint, double low, double high) {
  const double middle = (joint.min_rad + joint.max_rad - low - high) / 2;
  const double turns = std::round(middle / kTurn) * kTurn;
  return std::min(low + turns - joint.min_rad, joint.max_rad - high - turns);
}

// One branch on its way, all that a score has to know of it.
struct BranchRange {
  robot::JointAngles last, low, high;
  double wrist_rad = std::numeric_limits<double>::infinity(), elbow_rad = wrist_rad;
  bool there = true;

  void go_on(const robot::JointAngles& q, bool first) {
    if (first) {
      last = low = high = q;
      return;
    }
    for (int i = 0; i < q.size(); ++i) last[i] += std::remainder(q[i] - last[i], kTurn);
    low = low.cwiseMin(last);
    high = high.cwiseMax(last);
  }
};

}  // namespace

Pose placed(const Pose& design_to_cell, const ArmPlace& place) {
  Pose moved = design_to_cell;
  if (place.yaw_rad != 0) {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(place.yaw_rad, Vector3d::UnitZ()));
    moved.p = turn * moved.p;
    moved.q = robot::canonical((turn * moved.q).normalized());
  }
  moved.p += Vector3d(place.dx_mm, place.dy_mm, place.raise_mm);
  return moved;
}

Pose unplaced(const Pose& design_to_cell, const ArmPlace& place) {
  Pose moved = design_to_cell;
  moved.p -= Vector3d(place.dx_mm, place.dy_mm, place.raise_mm);
  return placed(moved, {0, false, 0, 0, -place.yaw_rad});
}

double moved_mm(const ArmPlace& place) {
  constexpr double kDegree_mm = 5;
  return place.raise_mm + std::abs(place.dx_mm) + std::abs(place.dy_mm) +
         kDegree_mm * std::abs(place.yaw_rad) / kDegree_rad;
}

std::vector<ArmPlace> heights(const robot::PlaceRange& range) {
  std::vector<ArmPlace> all;
  const bool fixed = range.how == robot::Placing::kFixed;
  const double low = fixed ? 0 : range.raise_mm[0], high = fixed ? 0 : range.raise_mm[1];
  const int steps = static_cast<int>(std::floor((high - low) / kRaiseStep_mm + 1e-9));
  for (int i = 0; i <= steps; ++i) {
    for (const bool swapped : {false, true}) all.push_back({low + i * kRaiseStep_mm, swapped});
  }
  return all;
}

std::vector<ArmPlace> grid(const robot::PlaceRange& range) {
  const auto steps = [](const std::array<double, 2>& from_to, double step) {
    std::vector<double> all;
    for (int i = 0; from_to[0] + i * step <= from_to[1] + 1e-9; ++i) all.push_back(from_to[0] + i * step);
    return all;
  };
  std::vector<double> turns = steps(range.yaw_deg, range.yaw_step_deg);
  if (turns.size() > 1 && turns.back() - turns.front() >= 360 - 1e-9) turns.pop_back();
  std::vector<ArmPlace> all;
  for (const double raise : steps(range.raise_mm, kGridRaise_mm)) {
    for (const double turn : turns) {
      for (const double x : steps(range.x_mm, range.step_mm)) {
        for (const double y : steps(range.y_mm, range.step_mm)) {
          if (x == 0 && y == 0 && turn == 0) continue;  // heights alone have had it
          all.push_back({raise, false, x, y, turn * kDegree_rad});
        }
      }
    }
  }
  return all;
}

Isometry3d Hold::flange(const Pose& clamp) const {
  return cell_to_base * isometry_of(clamp) * in_clamp * jaw;
}

Hold hold_of(const robot::CellArm& arm, const Pose& design_to_cell, bool clamp_b, bool flip) {
  Hold hold;
  hold.cell_to_base = isometry_of(arm.base).inverse() * isometry_of(design_to_cell);
  hold.jaw = robot::jaw_in_flange(arm.tool).inverse();
  hold.in_clamp.setIdentity();
  if (clamp_b) hold.in_clamp.linear() = Vector3d(-1, -1, 1).asDiagonal();
  if (flip) hold.in_clamp.linear() = hold.in_clamp.linear() * Vector3d(1, -1, -1).asDiagonal();
  return hold;
}

double share_of_good(double joint_rad, double wrist_rad, double elbow_rad, double shoulder_mm) {
  return std::min({joint_rad / kGoodJoint_rad, wrist_rad / kGoodWrist_rad, elbow_rad / kGoodElbow_rad,
                   shoulder_mm / kGoodShoulder_mm});
}

PlaceScorer::PlaceScorer(const Strip& strip, const robot::Cell& cell) : strip_(strip), cell_(cell) {
  for (std::size_t arm = 0; arm < cell.arms.size(); ++arm) {
    turned_by_axis_6_[arm] = flips_by_axis_6(cell.arms[arm]);
    for (const bool clamp_b : {false, true}) {
      for (const bool flip : {false, true}) {
        Hold hold = hold_of(cell.arms[arm], {}, clamp_b, flip);
        hold.cell_to_base.setIdentity();
        std::vector<Isometry3d>& all = flanges_[arm][clamp_b ? 1 : 0][flip ? 1 : 0];
        for (std::size_t k = 0; k < strip.poses.size(); k += kScoreStep)
          all.push_back(hold.flange(clamp_b ? strip.poses[k].b : strip.poses[k].a));
        all.push_back(hold.flange(clamp_b ? strip.poses.back().b : strip.poses.back().a));
      }
    }
  }
}

double PlaceScorer::operator()(const ArmPlace& place) const {
  const Pose design_to_cell = placed(strip_.design_to_cell, place);
  double least = std::numeric_limits<double>::infinity();
  for (const bool clamp_b : {false, true}) {
    least = std::min(least, best_of(clamp_b != place.swapped ? 1 : 0, clamp_b, design_to_cell));
    if (least < 0) break;  // it does not serve, however the other arm does
  }
  return least;
}

double PlaceScorer::best_of(std::size_t arm, bool clamp_b, const Pose& design_to_cell) const {
  const auto& ways = flanges_[arm][clamp_b ? 1 : 0];
  const Isometry3d to_base = isometry_of(cell_.arms[arm].base).inverse() * isometry_of(design_to_cell);
  const bool flips = cell_.arms[arm].tool.flip;
  const double best = best_along(arm, ways[0], to_base, flips && turned_by_axis_6_[arm]);
  if (!flips || turned_by_axis_6_[arm]) return best;
  return std::max(best, best_along(arm, ways[1], to_base, false));
}

// All branches at once, and with them those of the flipped jaw where that is half a turn of joint 6. How far
// from singular a pose is follows from joints 3 and 5 and from where the wrist is.
double PlaceScorer::best_along(std::size_t index, const std::vector<Isometry3d>& flanges,
                               const Isometry3d& design_to_base, bool both_ways) const {
  const robot::Arm& arm = cell_.arms[index].model.arm;
  const auto& joints = arm.joints();
  const double straight_wrist = angle_to(joints[4].axis, joints[5].axis, joints[3].axis);
  const double straight_elbow = angle_to(joints[2].axis, arm.wrist_at_zero() - joints[2].point_mm,
                                         joints[2].point_mm - joints[1].point_mm);
  const Vector3d wrist = arm.flange_at_zero().inverse() * arm.wrist_at_zero();
  const double beside = joints[1].axis.dot(arm.wrist_at_zero() - joints[0].point_mm);
  double shoulder = std::numeric_limits<double>::infinity();
  std::array<BranchRange, robot::kBranches> branches;
  for (std::size_t k = 0; k < flanges.size(); ++k) {
    const Isometry3d flange = design_to_base * flanges[k];
    const robot::Solutions solutions = robot::inverse(arm, flange);
    bool one = false;
    for (std::size_t i = 0; i < robot::kBranches; ++i) {
      BranchRange& branch = branches[i];
      branch.there = branch.there && solutions.there[i];
      if (!branch.there) continue;
      one = true;
      const robot::JointAngles& q = solutions.q[i];
      branch.go_on(q, k == 0);
      branch.wrist_rad = std::min(branch.wrist_rad, folded(q[4] - straight_wrist));
      branch.elbow_rad = std::min(branch.elbow_rad, folded(q[2] - straight_elbow));
    }
    if (!one) return -1;
    const double from_axis = (flange * wrist - joints[0].point_mm).cross(joints[0].axis).norm();
    shoulder = std::min(shoulder, std::sqrt(std::max(0.0, (from_axis - beside) * (from_axis + beside))));
  }
  double best = -1;
  for (const BranchRange& branch : branches) {
    if (!branch.there) continue;
    double joint = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < robot::kJoints; ++i) {
      const double low = branch.low[static_cast<int>(i)], high = branch.high[static_cast<int>(i)];
      double margin = margin_of(joints[i], low, high);
      if (i == 5 && both_ways) margin = std::max(margin, margin_of(joints[i], low + M_PI, high + M_PI));
      joint = std::min(joint, margin);
    }
    best = std::max(best, share_of_good(joint, branch.wrist_rad, branch.elbow_rad, shoulder));
  }
  return best;
}

}  // namespace hotblade::pipeline

#include "pipeline/export/robot_jobs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pipeline/cell/robot_names.hpp"
#include "pipeline/program/block_place.hpp"
#include "pipeline/program/straight_start.hpp"
#include "pipeline/settings/error.hpp"
#include "robot/arm/arm.hpp"
#include "robot/pose/motion.hpp"
#include "robot/pose/rates.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Isometry3d;
using robot::kDegree_rad;

constexpr double kMicrosecond_s = 1e-6;

Isometry3d isometry(const Pose& pose) {
  Isometry3d place = Isometry3d::Identity();
  place.linear() = pose.q.toRotationMatrix();
  place.translation() = pose.p;
  return place;
}

Pose pose_of(const Isometry3d& place) {
  return {place.translation(), robot::canonical(Eigen::Quaterniond(place.linear()).normalized())};
}

// One arm that holds one clamp through a strip.
class Holder {
 public:
  Holder(const Strip& strip, const robot::Cell* cell, std::size_t arm, bool clamp_b)
      : strip_(strip), clamp_b_(clamp_b) {
    if (cell == nullptr) return;
    arm_ = &cell->arms[arm];
    const HeldClamp& held = clamp_b ? strip.arms->b : strip.arms->a;
    flip_ = held.flip;
    for (std::size_t i = 0; i < robot::kBranches; ++i)
      if (robot::branch_signs(i) == held.branch) branch_ = i;
    if (clamp_b) in_clamp_.linear() = Eigen::Vector3d(-1, -1, 1).asDiagonal();
    if (flip_) in_clamp_.linear() = in_clamp_.linear() * Eigen::Vector3d(1, -1, -1).asDiagonal();
    // The flags count from the arm as it stands at zero, its wrist before axis 1 and before the lower arm.
    const robot::Solutions home = robot::inverse(arm_->model.arm, arm_->model.arm.flange_at_zero());
    double nearest = 1e9;
    for (std::size_t i = 0; i < robot::kBranches; ++i) {
      if (!home.there[i] || home.q[i].head<3>().norm() >= nearest) continue;
      nearest = home.q[i].head<3>().norm();
      home_ = robot::branch_signs(i);
    }
    behind_axis_1_ = held.branch[0] != home_[0];
    behind_lower_arm_ = (held.branch[1] != home_[1]) != behind_axis_1_;
  }

  [[nodiscard]] bool flip() const { return flip_; }

  // Of a pose of the strip's, in the cell's frame.
  [[nodiscard]] RobotTarget target(const robot::Waypoint& at, const Strip& strip, std::size_t pose) const {
    if (arm_ == nullptr) return {clamp_b_ ? at.b : at.a, {}, {}};
    const ClampJoints& joints = strip.joints[pose];
    return target(clamp_b_ ? at.b : at.a, clamp_b_ ? joints.b : joints.a);
  }

  // Of a pose of the clamp before the strip begins, from joints near to it.
  [[nodiscard]] RobotTarget near(const Pose& clamp, ArmJoints& joints) const {
    if (arm_ == nullptr) return {clamp, {}, {}};
    const robot::Arm& arm = arm_->model.arm;
    const Isometry3d flange = isometry(arm_->base).inverse() * isometry(clamp) * in_clamp_ *
                              robot::jaw_in_flange(arm_->tool).inverse();
    const robot::Solutions all = robot::inverse(arm, flange);
    if (!all.there[branch_]) refuse("out of reach");
    for (std::size_t i = 0; i < kArmJoints; ++i) {
      const double turn = 2 * M_PI;
      const double q = all.q[branch_][static_cast<int>(i)];
      joints[i] = q + turn * std::round((joints[i] - q) / turn);
      const robot::Joint& joint = arm.joints()[i];
      if (joints[i] < joint.min_rad || joints[i] > joint.max_rad) refuse(joint.name + " beyond its limit");
    }
    return target(clamp, joints);
  }

 private:
  [[nodiscard]] RobotTarget target(const Pose& clamp, const ArmJoints& joints) const {
    RobotTarget to;
    to.pose = pose_of(isometry(clamp) * in_clamp_);
    for (std::size_t i = 0; i < kArmJoints; ++i) to.joints_deg[i] = joints[i] / kDegree_rad;
    const auto quarter = [&](std::size_t i) { return static_cast<int>(std::floor(to.joints_deg[i] / 90)); };
    to.configuration = {quarter(0), quarter(3), quarter(5),
                        (joints[4] < 0 ? 1 : 0) + (behind_lower_arm_ ? 2 : 0) + (behind_axis_1_ ? 4 : 0)};
    return to;
  }

  [[noreturn]] void refuse(const std::string& why) const {
    throw Error(ErrorKind::kNotCuttable,
                fmt::format("{}: arm {} cannot take the straight blade before the strip begins: {}: another "
                            "place of the block",
                            strip_.id, arm_->id, why));
  }

  const Strip& strip_;
  const robot::CellArm* arm_ = nullptr;
  bool clamp_b_, flip_ = false, behind_axis_1_ = false, behind_lower_arm_ = false;
  std::size_t branch_ = 0;
  std::array<int, 3> home_{1, 1, 1};
  Isometry3d in_clamp_ = Isometry3d::Identity();
};

// How fast both clamps are on each step: mm/s, a radian counts as 100 mm.
std::vector<double> step_speeds(const std::vector<robot::Waypoint>& path) {
  std::vector<double> all;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const double dt = kMicrosecond_s * (path[i].t_us - path[i - 1].t_us);
    double sum = 0;
    for (const auto clamp : {&robot::Waypoint::a, &robot::Waypoint::b}) {
      const robot::ClampRates rates = robot::rates_between(path[i - 1].*clamp, path[i].*clamp, dt);
      sum += rates.linear.squaredNorm() + 1e4 * rates.angular.squaredNorm();
    }
    all.push_back(std::sqrt(sum));
  }
  return all;
}

// Whether the program rests at a waypoint: from rest with even acceleration a step is a third of the next.
bool rests_at(const std::vector<double>& speed, std::size_t waypoint) {
  if (waypoint < 2 || waypoint + 2 > speed.size()) return false;
  return speed[waypoint] <= 0.5 * speed[waypoint + 1] && speed[waypoint - 1] <= 0.5 * speed[waypoint - 2];
}

void append_approach(RobotJob& job, const Strip& strip, const Holder& holder, bool clamp_b) {
  ArmJoints joints{};
  if (!strip.joints.empty()) joints = clamp_b ? strip.joints.front().b : strip.joints.front().a;
  std::vector<RobotTarget> back;  // from waypoint 0 to the straight blade
  const robot::Waypoint start = waypoints(strip).front();
  back.push_back(holder.target(start, strip, 0));
  const std::vector<BladePose> poses = straight_start(strip);
  for (std::size_t k = poses.size() - 1; k-- > 0;)
    back.push_back(
        holder.near(robot::transformed(strip.design_to_cell, clamp_b ? poses[k].b : poses[k].a), joints));
  job.load = back.back();
  for (int k = 1; k <= kStartMoves; ++k) {
    RobotStep step;
    step.seconds = kStart_s / kStartMoves;
    step.to = back[static_cast<std::size_t>(kStartMoves - k)];
    step.id = k;
    step.stops = k == kStartMoves;
    job.steps.push_back(step);
  }
}

void append_strip(RobotJob& job, const Strip& strip, const Holder& holder) {
  const std::vector<robot::Waypoint> path = waypoints(strip);
  const std::vector<double> speed = step_speeds(path);
  bool heat = false;
  const auto stop_before = [&] { job.steps.back().stops = true; };
  const auto change_heat = [&](bool on) {
    if (on == heat) return;
    if (job.steps.back().kind == RobotStep::Kind::kMove) stop_before();
    heat = on;
    RobotStep step;
    step.kind = RobotStep::Kind::kHeat;
    step.on = on;
    job.steps.push_back(step);
  };
  for (std::size_t i = 1; i < path.size(); ++i) {
    change_heat(path[i - 1].heat);
    // At a rest before a change the blade is switched there, and the motion need not stop again behind it.
    const RobotStep& before = job.steps.back();
    if (before.kind != RobotStep::Kind::kMove || before.stops || !(speed[i - 1] > 0))
      change_heat(path[i].heat);
    const double seconds = kMicrosecond_s * (path[i].t_us - path[i - 1].t_us);
    if (!(speed[i - 1] > 0)) {
      if (job.steps.back().kind != RobotStep::Kind::kWait) {
        if (job.steps.back().kind == RobotStep::Kind::kMove) stop_before();
        RobotStep wait;
        wait.kind = RobotStep::Kind::kWait;
        job.steps.push_back(wait);
      }
      job.steps.back().seconds += seconds;
      continue;
    }
    RobotStep move;
    move.seconds = seconds;
    move.to = holder.target(path[i], strip, i);
    move.id = kStartMoves + static_cast<int>(i);
    move.stops = i + 1 == path.size() || rests_at(speed, i);
    job.steps.push_back(move);
  }
  change_heat(false);
}

std::vector<std::string> texts_of(const Strip& strip) {
  const BlockPlace place = standing_place(strip.block, strip.design_to_cell);
  const Eigen::Vector3d size = place.box.sizes();
  // Adding zero takes the sign off a zero.
  const Eigen::Vector3d corner = place.corner.array().round() + 0.0;
  std::vector<std::string> texts{
      ascii(fmt::format("{}: block {:.0f} x {:.0f} x {:.0f} mm, blade {:g} mm", strip.id, size.x(), size.y(),
                        size.z(), strip.blade_length_mm)),
      fmt::format("block {:.0f} mm above the table, left front lower corner at x {:.0f}, y {:.0f}",
                  corner.z(), corner.x(), corner.y())};
  if (place.turned_rad != 0) {
    texts.push_back(fmt::format("turned about it by {:.1f} degrees, {} as seen from above",
                                std::abs(place.turned_rad) / kDegree_rad,
                                place.turned_rad > 0 ? "counter-clockwise" : "clockwise"));
  }
  return texts;
}

RobotJob job_of(const Strip& strip, const robot::Cell* cell, std::size_t arm) {
  const bool clamp_b = cell == nullptr ? arm == 1 : strip.arms->b.arm == cell->arms[arm].id;
  const Holder holder(strip, cell, arm, clamp_b);
  RobotJob job;
  job.strip = strip.id;
  job.clamp = clamp_b ? 'b' : 'a';
  job.flip = holder.flip();
  job.blade_length_mm = strip.blade_length_mm;
  job.texts = texts_of(strip);
  append_approach(job, strip, holder, clamp_b);
  append_strip(job, strip, holder);
  return job;
}

}  // namespace

std::array<RobotTask, 2> robot_tasks(const Program& program, const robot::Cell* cell) {
  std::array<RobotTask, 2> tasks;
  for (std::size_t arm = 0; arm < tasks.size(); ++arm) {
    tasks[arm].id = cell == nullptr ? (arm == 0 ? "a" : "b") : robot_name_of(cell->arms[arm].id);
    tasks[arm].arm = cell == nullptr ? nullptr : &cell->arms[arm];
    tasks[arm].heats = arm == 0;
    for (const Strip& strip : program.strips) tasks[arm].jobs.push_back(job_of(strip, cell, arm));
  }
  return tasks;
}

double off_straight_mm(const Program& program, const robot::Cell& cell) {
  double most = 0;
  for (const Strip& strip : program.strips) {
    for (const bool b : {false, true}) {
      const HeldClamp& held = b ? strip.arms->b : strip.arms->a;
      const robot::CellArm& arm = cell.arms[cell.arms[0].id == held.arm ? 0 : 1];
      const Isometry3d jaw = robot::jaw_in_flange(arm.tool), base = isometry(arm.base);
      const Isometry3d to_cell = isometry(strip.design_to_cell);
      for (std::size_t k = 1; k < strip.poses.size(); ++k) {
        const auto angles = [&](std::size_t i) {
          const ClampJoints& joints = strip.joints[i];
          return robot::JointAngles(Eigen::Map<const robot::JointAngles>((b ? joints.b : joints.a).data()));
        };
        const Eigen::Vector3d is =
            (base * robot::forward(arm.model.arm, (angles(k - 1) + angles(k)) / 2) * jaw).translation();
        const PoseRow &from = b ? strip.poses[k - 1].b : strip.poses[k - 1].a,
                      &to = b ? strip.poses[k].b : strip.poses[k].a;
        most = std::max(most, (is - to_cell * Eigen::Vector3d((from.p + to.p) / 2)).norm());
      }
    }
  }
  return most;
}

std::string ascii(const std::string& text) {
  std::string plain;
  for (const char c : text) {
    const bool printable = c >= ' ' && c <= '~' && c != '"';
    // The bytes behind the first of a character's in UTF-8 stand for none of their own.
    if (!printable && (static_cast<unsigned char>(c) & 0xC0U) == 0x80U) continue;
    plain += printable ? c : '_';
  }
  return plain;
}

}  // namespace hotblade::pipeline

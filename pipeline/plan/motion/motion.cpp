#include "pipeline/plan/motion/motion.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "elastica/blade/blade_batch.hpp"
#include "pipeline/plan/motion/blade_check.hpp"
#include "pipeline/plan/motion/blade_path.hpp"
#include "pipeline/plan/motion/blocks.hpp"
#include "pipeline/plan/motion/clamp_plane.hpp"
#include "pipeline/plan/motion/refuser.hpp"
#include "pipeline/plan/motion/round_poses.hpp"
#include "pipeline/plan/motion/slow_feed.hpp"
#include "pipeline/plan/motion/slower.hpp"
#include "pipeline/plan/motion/timed_stretch.hpp"
#include "robot/blade/common_plane.hpp"
#include "robot/pose/rates.hpp"

namespace hotblade::pipeline {

namespace {

// The phase of a place in the cutting stretch.
StripPhase cut_phase(double offset_mm, const SweepMarks& marks) {
  if (offset_mm < marks.first_rib_mm) return StripPhase::kLeadIn;
  if (offset_mm > marks.last_rib_mm) return StripPhase::kLeadOut;
  return StripPhase::kCut;
}

// Everything but the margins, which find_margins gives to all poses together.
// `in_block` has what of each blade may lie in its block, waste included.
void append(std::vector<BladePose>& poses, std::vector<elastica::Part>& in_block, const Stretch& stretch,
            const TimedStretch& timed, const SweepMarks& marks) {
  const bool cutting = stretch.phase == StripPhase::kCut;
  const double t0 = poses.empty() ? 0 : poses.back().t;
  if (!poses.empty() && !(timed.law.duration_s > 0)) return;  // a stretch that does not move
  const std::size_t skip = poses.empty() ? 0 : 1;             // a stretch starts where the one before ended
  for (std::size_t k = skip; k < timed.at.shapes.size(); ++k) {
    const BladeShape& shape = timed.at.shapes[k];
    BladePose& pose = poses.emplace_back();
    pose.t = t0 + timed.law.step_s * static_cast<double>(k);
    pose.phase = cutting ? cut_phase(shape.offset_mm, marks) : stretch.phase;
    pose.heat = stretch.heat;
    const Frame& frame = timed.at.frames[k];
    pose.frame = poses.size() < 2 ? SharedFrame(frame) : SharedFrame(frame, poses[poses.size() - 2].frame);
    pose.blade = shape.blade;
    if (pose.phase == StripPhase::kCut) pose.foam = {{shape.foam0, shape.foam1}};
    pose.a = timed.at.pairs[k].a;
    pose.b = timed.at.pairs[k].b;
    in_block.push_back(shape.in_foam ? elastica::Part{shape.rib0, shape.rib1} : elastica::Part{});
  }
}

void find_margins(std::vector<BladePose>& poses) {
  in_blocks(poses.size(), [&](std::size_t from, std::size_t to) {
    std::vector<elastica::Elastica> blades;
    for (std::size_t i = from; i < to; ++i) blades.push_back(poses[i].blade);
    std::vector<double> margins(blades.size());
    elastica::stability_margins(blades, margins);
    for (std::size_t i = from; i < to; ++i) poses[i].margin = margins[i - from];
  });
}

// What the clamps are told, to hold the blade where it is planned.
void tell_clamps(std::vector<BladePose>& poses, const robot::ClampOffsets& offsets) {
  for (BladePose& pose : poses) {
    pose.a = robot::told(pose.a, offsets.a);
    pose.b = robot::told(pose.b, offsets.b);
  }
}

// Standing still with the heat on.
void append_preheat(std::vector<BladePose>& poses, const MotionSettings& motion) {
  if (!(motion.preheat_s > 0)) return;
  const auto steps = static_cast<std::size_t>(std::max(1.0, std::ceil(motion.preheat_s / motion.waypoint_s)));
  const BladePose still = poses.back();
  for (std::size_t k = 1; k <= steps; ++k) {
    BladePose pose = still;
    pose.t = still.t + motion.preheat_s * static_cast<double>(k) / static_cast<double>(steps);
    pose.phase = StripPhase::kPreheat;
    pose.heat = true;
    poses.push_back(pose);
  }
}

// Whole microseconds, as the controller counts, so that planned and executed times agree exactly.
void round_times(std::vector<BladePose>& poses) {
  for (BladePose& pose : poses) pose.t = std::round(pose.t * 1e6) * 1e-6;
}

std::vector<double> times_of(const std::vector<BladePose>& poses) {
  std::vector<double> t;
  t.reserve(poses.size());
  for (const BladePose& pose : poses) t.push_back(pose.t);
  return t;
}

// Meets the waypoints later where clamps would jerk.
void limit_jerk(std::vector<BladePose>& poses, const MotionSettings& motion) {
  if (!(motion.jerk_mm_s3 > 0) && !(motion.angular_jerk_rad_s3 > 0)) return;
  const std::vector<double> t = slower(times_of(poses), moving_clamps(poses, motion)).t;
  for (std::size_t i = 0; i < poses.size(); ++i) poses[i].t = t[i];
}

// The pose nearest to each rib's plane carries its index.
void mark_ribs(std::vector<BladePose>& poses, const StripPlan& strip) {
  for (std::size_t r = 0; r < strip.ribs.size(); ++r) {
    double best = std::numeric_limits<double>::infinity();
    BladePose* nearest = nullptr;
    for (BladePose& pose : poses) {
      if (pose.phase != StripPhase::kCut || pose.rib) continue;
      const double away = std::abs(strip.offset(pose.frame) - strip.ribs[r].offset_mm);
      if (away < best) {
        best = away;
        nearest = &pose;
      }
    }
    if (nearest) nearest->rib = static_cast<int>(r);
  }
}

struct Measured {
  double speed = 0, accel = 0, jerk = 0, turn = 0, turn_accel = 0, turn_jerk = 0, shortest_step = 1e300;
  double aside = 0;  // of the envelope
  double lowest = 1e300, highest = 0;
};

// Limits measured again from the finished waypoints, in the cell frame, by the controller's differences in
// time.
Measured measure(const std::vector<BladePose>& poses, const StripPlan& strip,
                 const MachineSettings& machine) {
  Measured m;
  for (const auto clamp : {&BladePose::a, &BladePose::b}) {
    robot::ClampRates rates, change;  // on the step before, and of that at its beginning
    double dt = 0, dt_before = 0;     // of the steps before; the strip starts from rest
    const auto change_to = [&](const robot::ClampRates& then, double dt1) {
      const double before = dt > 0 ? dt : dt1, first = dt_before > 0 ? dt_before : before;
      const robot::ClampAccelerations accelerations = robot::accelerations_between(rates, then, before, dt1);
      m.accel = std::max(m.accel, accelerations.linear_mm_s2);
      m.turn_accel = std::max(m.turn_accel, accelerations.angular_rad_s2);
      const double between = (before + dt1) / 2, third = (first + before + dt1) / 3;
      const robot::ClampRates now{(then.linear - rates.linear) / between,
                                  (then.angular - rates.angular) / between};
      m.jerk = std::max(m.jerk, (now.linear - change.linear).norm() / third);
      m.turn_jerk = std::max(m.turn_jerk, (now.angular - change.angular).norm() / third);
      change = now;
      rates = then;
      dt_before = before;
      dt = dt1;
    };
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const Eigen::Vector3d cell = transformed(strip.design_to_cell, poses[i].*clamp).p;
      m.aside = std::max({m.aside, std::abs(cell.x()) - machine.envelope_mm[0] / 2,
                          std::abs(cell.y()) - machine.envelope_mm[1] / 2});
      m.highest = std::max(m.highest, cell.z());
      m.lowest = std::min(m.lowest, cell.z());
      if (i == 0) continue;
      const double dt1 = poses[i].t - poses[i - 1].t;
      m.shortest_step = std::min(m.shortest_step, dt1);
      const robot::ClampRates then = robot::rates_between(poses[i - 1].*clamp, poses[i].*clamp, dt1);
      m.speed = std::max(m.speed, then.linear.norm());
      m.turn = std::max(m.turn, then.angular.norm());
      change_to(then, dt1);
    }
    for (int outside = 0; outside < 2 && dt > 0; ++outside) change_to({}, dt);
  }
  return m;
}

void check_limits(const StripPlan& strip, const Settings& settings, BladeMotion& motion) {
  const Measured m = measure(motion.poses, strip, settings.machine);
  constexpr double kRaiseStepMm = 10;
  if (settings.machine.plinth_mm == 0)
    motion.raise_mm =
        kRaiseStepMm * std::ceil(std::max(0.0, settings.stock.clearance_mm - m.lowest) / kRaiseStepMm);
  // Places are rounded to 1e-8 mm (round_poses.hpp), and turned by axes that are.
  const auto to_nanometres = [](double mm) {
    constexpr double kInMm = 1e6;
    return std::nearbyint(mm * kInMm) / kInMm;
  };
  const double lowest = to_nanometres(m.lowest + motion.raise_mm);
  const double outside =
      to_nanometres(std::max(m.aside, m.highest + motion.raise_mm - settings.machine.envelope_mm[2]));
  // Written so that a value that is not a number is refused.
  const auto at_most = [&](Limit limit, double value, double bound) {
    if (!(value <= bound)) motion.refusals.push_back({strip.id, "", limit, value, bound});
  };
  at_most(Limit::kSpeed, m.speed, settings.motion.travel_mm_s);
  at_most(Limit::kAcceleration, m.accel, settings.motion.accel_mm_s2);
  const auto at_most_if_limited = [&](Limit limit, double value, double bound) {
    if (bound > 0) at_most(limit, value, bound);
  };
  at_most_if_limited(Limit::kJerk, m.jerk, settings.motion.jerk_mm_s3);
  at_most_if_limited(Limit::kAngularJerk, m.turn_jerk, settings.motion.angular_jerk_rad_s3);
  at_most(Limit::kAngularSpeed, m.turn, settings.motion.angular_rad_s);
  at_most(Limit::kAngularAcceleration, m.turn_accel, settings.motion.angular_accel_rad_s2);
  at_most(Limit::kEnvelope, outside, 0);
  // Registers count time in u32 microseconds.
  constexpr double kLongest_s = 4294.0;
  at_most(Limit::kDuration, motion.poses.back().t, kLongest_s);
  at_most(Limit::kCommonPlane, motion.facts.off_plane_mm, robot::kMaxOffPlane_mm);
  const auto at_least = [&](Limit limit, double value, double bound) {
    if (!(value >= bound)) motion.refusals.push_back({strip.id, "", limit, value, bound});
  };
  constexpr double kShortestStep_s = 0.005, kTimeRounding_s = 1e-6;
  at_least(Limit::kMinDt, m.shortest_step, kShortestStep_s - kTimeRounding_s);
  at_least(Limit::kClampHeight, lowest, settings.stock.clearance_mm);
}

}  // namespace

void time_facts(const std::vector<BladePose>& poses, MotionFacts& facts) {
  facts.duration_s = poses.back().t;
  facts.cut_s = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    if (poses[i].phase == StripPhase::kCut) facts.cut_s += poses[i].t - poses[i - 1].t;
  }
}

BladeMotion move_blade(const StripPlan& strip, const Settings& given, MotionLook look) {
  // What a blade cuts between two places that it goes through in half a second it goes through evenly enough.
  // The clamps of a fan leave their common plane between waypoints: there no step is longer.
  constexpr double kCoarser = 8;
  Settings settings = given;
  if (look == MotionLook::kCoarse && !strip.planes.turns()) settings.motion.waypoint_s *= kCoarser;
  BladeMotion motion;
  const BladePath path = make_path(strip, settings);
  std::vector<elastica::Part> in_block;
  for (const Stretch& stretch : path.stretches) {
    append(motion.poses, in_block, stretch, timed(stretch, strip, settings), path.marks);
    if (stretch.phase == StripPhase::kForm) append_preheat(motion.poses, settings.motion);
    in_block.resize(motion.poses.size());
  }
  find_margins(motion.poses);
  if (strip.planes.turns()) motion.facts.off_plane_mm = off_plane_mm(motion.poses);
  tell_clamps(motion.poses, settings.machine.clamps);
  round_geometry(motion.poses);
  round_times(motion.poses);
  const std::vector<double> without_jerk = times_of(motion.poses);
  limit_jerk(motion.poses, settings.motion);
  motion.facts.jerk_s = motion.poses.back().t - without_jerk.back();
  mark_ribs(motion.poses, strip);
  time_facts(motion.poses, motion.facts);
  const SlowFeed slow = slowest_feed(motion.poses, !strip.formed.empty());
  motion.facts.slowest_feed_mm_s = slow.slowest_mm_s;
  check_limits(strip, settings, motion);
  // Of a surface that asks for one feed everywhere facets and rounded times make a little less.
  constexpr double kSameFeed = 0.999;
  if (!(slow.slowest_mm_s >= kSameFeed * settings.motion.min_feed_mm_s)) {
    const std::size_t i = slow.pose;  // 0 where nothing is cut
    const double jerk_share =
        i == 0 ? 1 : (without_jerk[i] - without_jerk[i - 1]) / (motion.poses[i].t - motion.poses[i - 1].t);
    Refuser refuse(strip, motion);
    refuse(i, Limit::kSlowestFeed, slow.slowest_mm_s, settings.motion.min_feed_mm_s,
           why_slow(slow, motion.poses, strip.planes.turns(), settings.motion, jerk_share,
                    fastest_in_block_mm_s(motion.poses, in_block, i)));
  }
  check_blade(strip, settings, look, motion);
  round_judgement(motion.poses);
  return motion;
}

}  // namespace hotblade::pipeline

#include "pipeline/plan/motion.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "elastica/stability.hpp"
#include "pipeline/plan/blade_check.hpp"
#include "pipeline/plan/blade_path.hpp"
#include "pipeline/plan/clamp_plane.hpp"
#include "pipeline/plan/time_law.hpp"

namespace hotblade::pipeline {

namespace {

// Blade points between the foam's ends whose speed the feed limits.
constexpr std::size_t kFeedPoints = 17;

PathSample path_sample(const BladeShape& shape, const StripPlan& strip) {
  const Frame frame = strip.swept_plane(shape.offset_mm);
  const elastica::ElasticaCurve curve(shape.blade);
  const ClampPair pair = clamps(curve, frame);
  PathSample sample{pair.a, pair.b, {}};
  if (!shape.in_foam) return sample;
  for (std::size_t i = 0; i < kFeedPoints; ++i) {
    const double share = static_cast<double>(i) / (kFeedPoints - 1);
    const auto q = curve.at(shape.foam0 + (shape.foam1 - shape.foam0) * share);
    sample.in_foam.push_back(frame.point(q.x, q.y));
  }
  return sample;
}

Eigen::Vector3d turn_rate(const Pose& p, const Pose& q, double dt) {
  Eigen::Quaterniond d = q.q * p.q.conjugate();
  if (d.w() < 0) d.coeffs() = -d.coeffs();
  return 2 / dt * d.vec();  // the angle between waypoints is far below a degree: sine and angle agree to 1e-6
}

// Largest share of an acceleration limit that the waypoints of a law use, by second differences at its even
// step.
double acceleration_use(const Stretch& stretch, const TimeLaw& law, const StripPlan& strip,
                        const MotionSettings& limits) {
  std::vector<ClampPair> pairs(law.sigma.size());
  tbb::parallel_for(std::size_t{0}, pairs.size(), [&](std::size_t i) {
    const BladeShape shape = stretch.at(law.sigma[i]);
    pairs[i] = clamps(shape.blade, strip.swept_plane(shape.offset_mm));
  });
  double use = 0;
  for (const auto clamp : {&ClampPair::a, &ClampPair::b}) {
    Eigen::Vector3d v = Eigen::Vector3d::Zero(), w = Eigen::Vector3d::Zero();
    for (std::size_t i = 1; i <= pairs.size(); ++i) {
      // Behind the last waypoint the clamps stand still.
      const Pose& p = pairs[i - 1].*clamp;
      const Pose& q = pairs[std::min(i, pairs.size() - 1)].*clamp;
      const Eigen::Vector3d v1 = (q.p - p.p) / law.step_s, w1 = turn_rate(p, q, law.step_s);
      use = std::max({use, (v1 - v).norm() / law.step_s / limits.accel_mm_s2,
                      (w1 - w).norm() / law.step_s / limits.angular_accel_rad_s2});
      v = v1;
      w = w1;
    }
  }
  return use;
}

// The fastest law whose waypoints, too, keep to the acceleration limits: where a path bends faster than its
// samples show, the limits given to the law are lowered and it is made again.
TimeLaw law_of(const Stretch& stretch, const StripPlan& strip, const Settings& settings) {
  std::vector<PathSample> samples(static_cast<std::size_t>(stretch.samples) + 1);
  tbb::parallel_for(std::size_t{0}, samples.size(), [&](std::size_t i) {
    samples[i] = path_sample(stretch.at(static_cast<double>(i) / stretch.samples), strip);
  });
  MotionSettings limits = settings.motion;
  constexpr int kTries = 12;
  constexpr double kUse = 0.95;
  TimeLaw law = fastest_time_law(samples, limits);
  for (int i = 0; i < kTries && law.duration_s > 0; ++i) {
    const double use = acceleration_use(stretch, law, strip, settings.motion);
    if (use <= kUse) break;
    limits.accel_mm_s2 *= kUse / use;
    limits.angular_accel_rad_s2 *= kUse / use;
    law = fastest_time_law(samples, limits);
  }
  return law;
}

// The phase of a place in the cutting stretch.
std::string cut_phase(double offset_mm, const SweepMarks& marks) {
  if (offset_mm < marks.first_rib_mm) return "lead_in";
  if (offset_mm > marks.last_rib_mm) return "lead_out";
  return "cut";
}

BladePose make_pose(const BladeShape& shape, const StripPlan& strip, double t, const std::string& phase,
                    bool heat) {
  BladePose pose;
  pose.t = t;
  pose.phase = phase;
  pose.heat = heat;
  pose.frame = strip.swept_plane(shape.offset_mm);
  pose.blade = shape.blade;
  if (phase == "cut") pose.foam = {{shape.foam0, shape.foam1}};
  const elastica::ElasticaCurve curve(shape.blade);
  const ClampPair pair = clamps(curve, pose.frame);
  pose.a = pair.a;
  pose.b = pair.b;
  pose.margin = elastica::stability_margin(curve);
  return pose;
}

void append(std::vector<BladePose>& poses, const Stretch& stretch, const TimeLaw& law,
            const SweepMarks& marks, const StripPlan& strip) {
  const bool cutting = stretch.phase == "cut";
  const double t0 = poses.empty() ? 0 : poses.back().t;
  if (!poses.empty() && !(law.duration_s > 0)) return;  // a stretch that does not move
  const std::size_t skip = poses.empty() ? 0 : 1;       // a stretch starts where the one before ended
  std::vector<BladePose> added(law.sigma.size() - skip);
  tbb::parallel_for(std::size_t{0}, added.size(), [&](std::size_t i) {
    const std::size_t k = i + skip;
    const BladeShape shape = stretch.at(law.sigma[k]);
    const std::string phase = cutting ? cut_phase(shape.offset_mm, marks) : stretch.phase;
    added[i] = make_pose(shape, strip, t0 + law.step_s * static_cast<double>(k), phase, stretch.heat);
  });
  std::move(added.begin(), added.end(), std::back_inserter(poses));
}

// Standing still with the heat on.
void append_preheat(std::vector<BladePose>& poses, const MotionSettings& motion) {
  if (!(motion.preheat_s > 0)) return;
  const auto steps = static_cast<std::size_t>(std::max(1.0, std::ceil(motion.preheat_s / motion.waypoint_s)));
  const BladePose still = poses.back();
  for (std::size_t k = 1; k <= steps; ++k) {
    BladePose pose = still;
    pose.t = still.t + motion.preheat_s * static_cast<double>(k) / static_cast<double>(steps);
    pose.phase = "preheat";
    pose.heat = true;
    poses.push_back(pose);
  }
}

// Whole microseconds, as the controller counts, so that planned and executed times agree exactly.
void round_times(std::vector<BladePose>& poses) {
  for (BladePose& pose : poses) pose.t = std::round(pose.t * 1e6) * 1e-6;
}

// The pose nearest to each rib's plane carries its index.
void mark_ribs(std::vector<BladePose>& poses, const StripPlan& strip) {
  for (std::size_t r = 0; r < strip.ribs.size(); ++r) {
    double best = std::numeric_limits<double>::infinity();
    BladePose* nearest = nullptr;
    for (BladePose& pose : poses) {
      if (pose.phase != "cut" || pose.rib) continue;
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
  double speed = 0, accel = 0, turn = 0, turn_accel = 0, outside = 0, lowest = 1e300, shortest_step = 1e300;
};

// Limits measured again from the finished waypoints, in the cell frame, by differences in time.
Measured measure(const std::vector<BladePose>& poses, const StripPlan& strip,
                 const MachineSettings& machine) {
  Measured m;
  for (const auto clamp : {&BladePose::a, &BladePose::b}) {
    Eigen::Vector3d v = Eigen::Vector3d::Zero(), w = Eigen::Vector3d::Zero();
    double dt = 1;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const Eigen::Vector3d cell = transformed(strip.design_to_cell, poses[i].*clamp).p;
      m.outside =
          std::max({m.outside, std::abs(cell.x()) - machine.envelope_mm[0] / 2,
                    std::abs(cell.y()) - machine.envelope_mm[1] / 2, cell.z() - machine.envelope_mm[2]});
      m.lowest = std::min(m.lowest, cell.z());
      if (i == 0) continue;
      dt = poses[i].t - poses[i - 1].t;
      m.shortest_step = std::min(m.shortest_step, dt);
      const Eigen::Vector3d v1 = ((poses[i].*clamp).p - (poses[i - 1].*clamp).p) / dt;
      const Eigen::Vector3d w1 = turn_rate(poses[i - 1].*clamp, poses[i].*clamp, dt);
      m.speed = std::max(m.speed, v1.norm());
      m.turn = std::max(m.turn, w1.norm());
      m.accel = std::max(m.accel, (v1 - v).norm() / dt);
      m.turn_accel = std::max(m.turn_accel, (w1 - w).norm() / dt);
      v = v1;
      w = w1;
    }
    m.accel = std::max(m.accel, v.norm() / dt);  // and to rest
    m.turn_accel = std::max(m.turn_accel, w.norm() / dt);
  }
  return m;
}

void check_limits(const StripPlan& strip, const Settings& settings, BladeMotion& motion) {
  const Measured m = measure(motion.poses, strip, settings.machine);
  // Written so that a value that is not a number is refused.
  const auto limit = [&](const char* name, double value, double bound, const char* unit, const char* hint) {
    if (!(value <= bound)) motion.refusals.push_back({strip.id, "", name, value, bound, unit, hint});
  };
  const char* slower = "lower motion.feed_mm_s";
  limit("clamp speed", m.speed, settings.motion.travel_mm_s, "mm/s", slower);
  limit("clamp acceleration", m.accel, settings.motion.accel_mm_s2, "mm/s2", slower);
  limit("clamp angular speed", m.turn, settings.motion.angular_rad_s, "rad/s", slower);
  limit("clamp angular acceleration", m.turn_accel, settings.motion.angular_accel_rad_s2, "rad/s2", slower);
  limit("distance outside the envelope", m.outside, 0, "mm", "choose a shorter blade or a larger machine");
  // Registers count time in u32 microseconds.
  constexpr double kLongest_s = 4294.0;
  limit("duration", motion.poses.back().t, kLongest_s, "s", "raise motion.feed_mm_s or split the design");
  limit("distance of the clamps from a common plane", motion.off_plane_mm, kMaxOffPlaneMm, "mm",
        "lower motion.waypoint_s or motion.feed_mm_s");
  const auto at_least = [&](const std::string& name, double value, double bound, const char* unit,
                            const char* hint) {
    if (!(value >= bound)) motion.refusals.push_back({strip.id, "", name, value, bound, unit, hint});
  };
  constexpr double kShortestStep_s = 0.005, kTimeRounding_s = 1e-6;
  at_least("time between waypoints", m.shortest_step, kShortestStep_s - kTimeRounding_s, "s",
           "raise motion.waypoint_s");
  at_least("clamp height above the table", m.lowest, settings.stock.clearance_mm, "mm",
           "raise machine.plinth_mm");
  at_least(
      "feed of the slowest blade point", motion.slowest_feed_mm_s, settings.motion.min_feed_mm_s, "mm/s",
      strip.planes.turns()
          ? "the blade would melt too wide there: move slice.fan_axis away or lower motion.min_feed_mm_s"
          : "the blade would melt too wide there: another slice.direction or a lower motion.min_feed_mm_s");
}

// Slowest blade point in foam over the cut; the time law starts and stops outside the block.
double slowest_feed(const std::vector<BladePose>& poses) {
  std::vector<std::array<Eigen::Vector3d, kFeedPoints>> in_foam(poses.size());
  tbb::parallel_for(std::size_t{0}, poses.size(), [&](std::size_t i) {
    const BladePose& pose = poses[i];
    if (!pose.foam) return;
    const elastica::ElasticaCurve curve(pose.blade);
    const auto [s0, s1] = *pose.foam;
    for (std::size_t k = 0; k < kFeedPoints; ++k) {
      const auto q = curve.at(s0 + static_cast<double>(k) / (kFeedPoints - 1) * (s1 - s0));
      in_foam[i][k] = pose.frame.point(q.x, q.y);
    }
  });
  double slowest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < poses.size(); ++i) {
    if (!poses[i - 1].foam || !poses[i].foam) continue;
    for (std::size_t k = 0; k < kFeedPoints; ++k) {
      slowest = std::min(slowest, (in_foam[i][k] - in_foam[i - 1][k]).norm() / (poses[i].t - poses[i - 1].t));
    }
  }
  return std::isfinite(slowest) ? slowest : 0;
}

}  // namespace

BladeMotion move_blade(const StripPlan& strip, const Settings& settings) {
  BladeMotion motion;
  const BladePath path = make_path(strip, settings);
  for (const Stretch& stretch : path.stretches) {
    append(motion.poses, stretch, law_of(stretch, strip, settings), path.marks, strip);
    if (stretch.phase == "form") append_preheat(motion.poses, settings.motion);
  }
  round_times(motion.poses);
  mark_ribs(motion.poses, strip);
  motion.duration_s = motion.poses.back().t;
  for (std::size_t i = 1; i < motion.poses.size(); ++i) {
    if (motion.poses[i].phase == "cut") motion.cut_s += motion.poses[i].t - motion.poses[i - 1].t;
  }
  motion.slowest_feed_mm_s = slowest_feed(motion.poses);
  if (strip.planes.turns()) motion.off_plane_mm = off_plane_mm(motion.poses);
  check_limits(strip, settings, motion);
  check_blade(strip, settings, motion);
  return motion;
}

}  // namespace hotblade::pipeline

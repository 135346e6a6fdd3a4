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
#include "pipeline/plan/motion/time_law.hpp"
#include "pipeline/program/clamps.hpp"
#include "robot/blade/common_plane.hpp"

namespace hotblade::pipeline {

namespace {

// Blade points between the foam's ends whose speed the feed limits.
constexpr std::size_t kFeedPoints = 17;

// Shapes of the blade in their planes, between their clamps.
struct ClampedShapes {
  std::vector<BladeShape> shapes;
  std::vector<Frame> frames;
  std::vector<ClampPoses> pairs;
};

ClampedShapes clamped(std::vector<BladeShape> shapes, const StripPlan& strip) {
  ClampedShapes all{std::move(shapes), {}, {}};
  all.frames.resize(all.shapes.size());
  all.pairs.resize(all.shapes.size());
  in_blocks(all.shapes.size(), [&](std::size_t from, std::size_t to) {
    std::vector<elastica::Elastica> blades;
    for (std::size_t i = from; i < to; ++i) {
      all.frames[i] = strip.swept_plane(all.shapes[i].offset_mm);
      blades.push_back(all.shapes[i].blade);
    }
    const auto pairs = clamps(blades, std::span(all.frames).subspan(from, to - from));
    std::copy(pairs.begin(), pairs.end(), all.pairs.begin() + static_cast<std::ptrdiff_t>(from));
  });
  return all;
}

// kFeedPoints of each blade's part in foam, in space; nothing of blades without one.
using FeedPoints = std::vector<std::vector<Eigen::Vector3d>>;

FeedPoints feed_points(std::span<const elastica::Elastica> blades, std::span<const elastica::Part> foam,
                       std::span<const Frame> frames) {
  FeedPoints all(blades.size());
  in_blocks(blades.size(), [&](std::size_t from, std::size_t to) {
    const elastica::PartPoints points =
        elastica::sample_parts(blades.subspan(from, to - from), foam.subspan(from, to - from), kFeedPoints);
    for (std::size_t i = from; i < to; ++i) {
      if (!(foam[i].last > foam[i].first)) continue;
      for (std::size_t k = 0; k < kFeedPoints; ++k) {
        const Eigen::Vector2d q = points.at(i - from, k);
        all[i].push_back(frames[i].point(q.x(), q.y()));
      }
    }
  });
  return all;
}

std::vector<PathSample> path_samples(const Stretch& stretch, const StripPlan& strip) {
  std::vector<double> parameters;
  for (int i = 0; i <= stretch.samples; ++i) parameters.push_back(static_cast<double>(i) / stretch.samples);
  const ClampedShapes all = clamped(shapes_at(stretch, parameters), strip);
  std::vector<elastica::Elastica> blades;
  std::vector<elastica::Part> foam;
  for (const BladeShape& shape : all.shapes) {
    blades.push_back(shape.blade);
    foam.push_back(shape.in_foam ? elastica::Part{shape.rib0, shape.rib1} : elastica::Part{});
  }
  FeedPoints in_foam = feed_points(blades, foam, all.frames);
  std::vector<PathSample> samples;
  for (std::size_t i = 0; i < all.pairs.size(); ++i)
    samples.push_back({all.pairs[i].a, all.pairs[i].b, std::move(in_foam[i])});
  return samples;
}

Eigen::Vector3d turn_rate(const Pose& p, const Pose& q, double dt) {
  Eigen::Quaterniond d = q.q * p.q.conjugate();
  if (d.w() < 0) d.coeffs() = -d.coeffs();
  return 2 / dt * d.vec();  // the angle between waypoints is far below a degree: sine and angle agree to 1e-6
}

// Largest share of an acceleration limit that the waypoints of a law use, by second differences at its even
// step.
double acceleration_use(const std::vector<ClampPoses>& pairs, const TimeLaw& law,
                        const MotionSettings& limits) {
  double use = 0;
  for (const auto clamp : {&ClampPoses::a, &ClampPoses::b}) {
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

// A stretch at the waypoints of its time law.
struct TimedStretch {
  TimeLaw law;
  ClampedShapes at;
};

// The fastest law whose waypoints, too, keep to the acceleration limits: where a path bends faster than its
// samples show, the limits given to the law are lowered and it is made again.
TimedStretch timed(const Stretch& stretch, const StripPlan& strip, const Settings& settings) {
  const std::vector<PathSample> samples = path_samples(stretch, strip);
  MotionSettings limits = settings.motion;
  constexpr int kTries = 12;
  constexpr double kUse = 0.95;
  for (int i = 0;; ++i) {
    TimeLaw law = fastest_time_law(samples, limits);
    ClampedShapes at = clamped(shapes_at(stretch, law.sigma), strip);
    const bool moves = law.duration_s > 0;
    const double use = moves ? acceleration_use(at.pairs, law, settings.motion) : 0;
    if (use <= kUse || i == kTries) return {std::move(law), std::move(at)};
    limits.accel_mm_s2 *= kUse / use;
    limits.angular_accel_rad_s2 *= kUse / use;
  }
}

// The phase of a place in the cutting stretch.
StripPhase cut_phase(double offset_mm, const SweepMarks& marks) {
  if (offset_mm < marks.first_rib_mm) return StripPhase::kLeadIn;
  if (offset_mm > marks.last_rib_mm) return StripPhase::kLeadOut;
  return StripPhase::kCut;
}

// Everything but the margins, which find_margins gives to all poses together.
void append(std::vector<BladePose>& poses, const Stretch& stretch, const TimedStretch& timed,
            const SweepMarks& marks) {
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
    pose.frame = timed.at.frames[k];
    pose.blade = shape.blade;
    if (pose.phase == StripPhase::kCut) pose.foam = {{shape.foam0, shape.foam1}};
    pose.a = timed.at.pairs[k].a;
    pose.b = timed.at.pairs[k].b;
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
  double speed = 0, accel = 0, turn = 0, turn_accel = 0, shortest_step = 1e300;
  double aside = 0;  // of the envelope
  double lowest = 1e300, highest = 0;
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
      m.aside = std::max({m.aside, std::abs(cell.x()) - machine.envelope_mm[0] / 2,
                          std::abs(cell.y()) - machine.envelope_mm[1] / 2});
      m.highest = std::max(m.highest, cell.z());
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
  constexpr double kRaiseStepMm = 10;
  if (settings.machine.plinth_mm == 0)
    motion.raise_mm =
        kRaiseStepMm * std::ceil(std::max(0.0, settings.stock.clearance_mm - m.lowest) / kRaiseStepMm);
  const double lowest = m.lowest + motion.raise_mm;
  const double outside = std::max(m.aside, m.highest + motion.raise_mm - settings.machine.envelope_mm[2]);
  // Written so that a value that is not a number is refused.
  const auto at_most = [&](Limit limit, double value, double bound) {
    if (!(value <= bound)) motion.refusals.push_back({strip.id, "", limit, value, bound});
  };
  at_most(Limit::kSpeed, m.speed, settings.motion.travel_mm_s);
  at_most(Limit::kAcceleration, m.accel, settings.motion.accel_mm_s2);
  at_most(Limit::kAngularSpeed, m.turn, settings.motion.angular_rad_s);
  at_most(Limit::kAngularAcceleration, m.turn_accel, settings.motion.angular_accel_rad_s2);
  at_most(Limit::kEnvelope, outside, 0);
  // Registers count time in u32 microseconds.
  constexpr double kLongest_s = 4294.0;
  at_most(Limit::kDuration, motion.poses.back().t, kLongest_s);
  at_most(Limit::kCommonPlane, motion.facts.off_plane_mm, robot::kMaxOffPlane_mm);
  const auto at_least = [&](Limit limit, double value, double bound, const char* hint = "") {
    if (!(value >= bound)) motion.refusals.push_back({strip.id, "", limit, value, bound, hint});
  };
  constexpr double kShortestStep_s = 0.005, kTimeRounding_s = 1e-6;
  at_least(Limit::kMinDt, m.shortest_step, kShortestStep_s - kTimeRounding_s);
  at_least(Limit::kClampHeight, lowest, settings.stock.clearance_mm);
  at_least(Limit::kSlowestFeed, motion.facts.slowest_feed_mm_s, settings.motion.min_feed_mm_s,
           strip.planes.turns()
               ? "the blade would melt too wide there: move slice.fan_axis away or lower motion.min_feed_mm_s"
               : "");
}

// Slowest blade point in foam over the cut; the time law starts and stops outside the block. What of the
// blade forms the design may change from pose to pose: where it does, the same points are looked at in both.
double slowest_feed(const std::vector<BladePose>& poses, bool same_points) {
  std::vector<elastica::Elastica> blades;
  std::vector<elastica::Part> foam;
  std::vector<Frame> frames;
  for (const BladePose& pose : poses) {
    blades.push_back(pose.blade);
    foam.push_back(pose.foam ? elastica::Part{(*pose.foam)[0], (*pose.foam)[1]} : elastica::Part{});
    frames.push_back(pose.frame);
  }
  const FeedPoints in_foam = feed_points(blades, foam, frames);
  FeedPoints before = in_foam;
  if (same_points && poses.size() > 1) {
    before = feed_points(std::span(blades).first(poses.size() - 1), std::span(foam).last(poses.size() - 1),
                         std::span(frames).first(poses.size() - 1));
  }
  double slowest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < poses.size(); ++i) {
    if (!poses[i - 1].foam || !poses[i].foam) continue;
    for (std::size_t k = 0; k < kFeedPoints; ++k) {
      slowest = std::min(slowest, (in_foam[i][k] - before[i - 1][k]).norm() / (poses[i].t - poses[i - 1].t));
    }
  }
  return std::isfinite(slowest) ? slowest : 0;
}

}  // namespace

BladeMotion move_blade(const StripPlan& strip, const Settings& settings) {
  BladeMotion motion;
  const BladePath path = make_path(strip, settings);
  for (const Stretch& stretch : path.stretches) {
    append(motion.poses, stretch, timed(stretch, strip, settings), path.marks);
    if (stretch.phase == StripPhase::kForm) append_preheat(motion.poses, settings.motion);
  }
  find_margins(motion.poses);
  round_times(motion.poses);
  mark_ribs(motion.poses, strip);
  motion.facts.duration_s = motion.poses.back().t;
  for (std::size_t i = 1; i < motion.poses.size(); ++i) {
    if (motion.poses[i].phase == StripPhase::kCut)
      motion.facts.cut_s += motion.poses[i].t - motion.poses[i - 1].t;
  }
  motion.facts.slowest_feed_mm_s = slowest_feed(motion.poses, !strip.formed.empty());
  if (strip.planes.turns()) motion.facts.off_plane_mm = off_plane_mm(motion.poses);
  check_limits(strip, settings, motion);
  check_blade(strip, settings, motion);
  return motion;
}

}  // namespace hotblade::pipeline

#include "pipeline/plan/motion/blade_check.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "elastica/blade/continuation.hpp"
#include "elastica/blade/sensitivity.hpp"
#include "elastica/blade/taut.hpp"
#include "pipeline/plan/motion/blade.hpp"
#include "pipeline/plan/motion/blade_path.hpp"
#include "pipeline/plan/motion/blocks.hpp"
#include "pipeline/plan/motion/clamp_margins.hpp"
#include "pipeline/plan/motion/refuser.hpp"
#include "pipeline/plan/motion/round_poses.hpp"
#include "pipeline/program/clamps.hpp"
#include "pipeline/sayings/saying.hpp"
#include "pipeline/verify/clamp_error.hpp"
#include "pipeline/verify/hanging.hpp"
#include "robot/blade/blade_section.hpp"

namespace hotblade::pipeline {

namespace {

struct PoseCheck {
  double curvature = 0, clearance = 0, depth = 0;
  bool crosses = false, cuts = false;
  robot::BladeLoads loads;
  robot::BladeSag sag;
};

// Some poses of a strip and what is found of their blades together.
struct PoseBlock {
  std::span<const BladePose> poses;
  elastica::PartPoints points;  // of the whole blades
  std::vector<robot::BladeSag> sags;
  std::vector<FreeParts> free;

  PoseBlock(std::span<const BladePose> some, const StripPlan& strip, const robot::Blade& blade)
      : poses(some) {
    std::vector<elastica::Elastica> blades;
    std::vector<elastica::Part> whole, parts;
    std::vector<robot::SagPlace> sag_places;
    std::vector<Block> blocks;
    for (const BladePose& pose : poses) {
      blades.push_back(pose.blade);
      whole.push_back({0, pose.blade.length});
      const double s0 = pose.foam ? (*pose.foam)[0] : 0, s1 = pose.foam ? (*pose.foam)[1] : pose.blade.length;
      parts.push_back({s0, s1});
      sag_places.push_back({down_in_plane(strip.design_to_cell, pose.frame), s0, s1});
      blocks.push_back(strip.block.seen_from(pose.frame));
    }
    const bool may_loop = !std::all_of(blades.begin(), blades.end(), makes_no_loop);
    points = elastica::sample_parts(
        blades, whole, may_loop ? kBladeSamples : elastica::curvature_points(blades, kBladeSamples));
    sags = robot::blade_sags(blades, blade, sag_places);
    free = examine_free_parts(blades, points, parts, blocks);
  }
};

PoseCheck check_pose(const PoseBlock& some, std::size_t i, const StripPlan& strip, const robot::Blade& blade,
                     const robot::ClampOffsets& offsets) {
  PoseCheck c;
  const BladePose& pose = some.poses[i];
  c.curvature = elastica::max_abs_curvature(pose.blade, some.points, i);
  c.loads = robot::blade_loads(pose.blade, some.points.curvature[(i + 1) * some.points.points - 1],
                               c.curvature, blade);
  c.clearance = clamp_clearance_mm(robot::held({pose.a, pose.b}, offsets), strip.block);
  c.cuts = pose.foam.has_value();
  c.sag = some.sags[i];
  c.crosses = some.free[i].crosses_itself;
  if (c.cuts) c.depth = some.free[i].depth_mm;
  return c;
}

std::vector<PoseCheck> check_poses(const std::vector<BladePose>& poses, const StripPlan& strip,
                                   const robot::Blade& blade, const robot::ClampOffsets& offsets) {
  std::vector<PoseCheck> checks(poses.size());
  in_blocks(poses.size(), [&](std::size_t from, std::size_t to) {
    const PoseBlock some(std::span<const BladePose>(poses).subspan(from, to - from), strip, blade);
    for (std::size_t i = from; i < to; ++i) checks[i] = check_pose(some, i - from, strip, blade, offsets);
  });
  return checks;
}

PoseLoads pose_loads(const PoseCheck& c) {
  return {load_of(c.loads.force_n.norm()), load_of(c.loads.moment_a_n_mm), load_of(c.loads.moment_b_n_mm),
          load_of(c.loads.stress_mpa),     load_of(c.sag.droop_mm),        load_of(c.sag.in_plane_mm)};
}

void collect(const std::vector<PoseCheck>& checks, BladeMotion& motion) {
  MotionFacts& facts = motion.facts;
  facts.smallest_clearance_mm = std::numeric_limits<double>::infinity();
  facts.smallest_margin = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < checks.size(); ++i) {
    const PoseCheck& c = checks[i];
    motion.poses[i].loads = pose_loads(c);
    facts.smallest_margin = std::min(facts.smallest_margin, motion.poses[i].margin);
    facts.largest_curvature_per_mm = std::max(facts.largest_curvature_per_mm, c.curvature);
    facts.smallest_clearance_mm = std::min(facts.smallest_clearance_mm, c.clearance);
    facts.largest_force_n = std::max(facts.largest_force_n, c.loads.force_n.norm());
    facts.largest_moment_n_mm = std::max(
        {facts.largest_moment_n_mm, std::abs(c.loads.moment_a_n_mm), std::abs(c.loads.moment_b_n_mm)});
    facts.largest_stress_mpa = std::max(facts.largest_stress_mpa, c.loads.stress_mpa);
    if (!c.cuts) continue;
    facts.droop_mm = std::max(facts.droop_mm, c.sag.droop_mm);
    facts.twist_rad = std::max(facts.twist_rad, c.sag.twist_rad);
    facts.in_plane_sag_mm = std::max(facts.in_plane_sag_mm, c.sag.in_plane_mm);
  }
}

void weigh_clamp_errors(const StripPlan& strip, const MachineSettings& machine,
                        const std::vector<PoseMargin>& margins, BladeMotion& motion) {
  motion.facts.rib_sensitivity_mm.assign(strip.ribs.size(), {});
  for (std::size_t i = 0; i < motion.poses.size(); ++i) {
    const BladePose& pose = motion.poses[i];
    if (!pose.rib) continue;
    motion.facts.rib_sensitivity_mm[static_cast<std::size_t>(*pose.rib)] =
        elastica::sensitivity(pose.blade).displacement_mm;
    motion.facts.clamp_error_mm =
        std::max(motion.facts.clamp_error_mm, clamp_error_mm(pose, margins[i].straight_mm, machine));
  }
}

// Fills margin_mm of all poses and the smallest of them.
std::vector<PoseMargin> weigh_margins(const Settings& settings, BladeMotion& motion) {
  std::vector<PoseMargin> margins = clamp_margins(motion.poses, settings);
  motion.facts.smallest_fold_mm = motion.facts.smallest_straight_mm = kFarFromFoldMm;
  for (std::size_t i = 0; i < margins.size(); ++i) {
    const PoseMargin& m = margins[i];
    motion.poses[i].margin_mm = m.margin_mm;
    motion.facts.smallest_fold_mm = std::min(motion.facts.smallest_fold_mm, m.fold_mm);
    motion.facts.smallest_straight_mm = std::min(motion.facts.smallest_straight_mm, m.straight_mm);
  }
  return margins;
}

// Pulled straight by more than the equations for its force can carry, or so nearly straight that the clamps'
// errors may bow it to another side.
bool unheld(const BladePose& pose, const PoseMargin& margin, const Settings& settings) {
  const double length = pose.blade.length;
  const Eigen::Vector2d force(pose.blade.lambda1, pose.blade.lambda2);
  // A chord is no longer than its blade.
  if (force.norm() * length * length > elastica::kLargestTension) {
    const elastica::CurvePoint b = elastica::point_at(pose.blade, length);
    const Eigen::Vector2d chord(b.x - pose.blade.x, b.y - pose.blade.y);
    if (-force.dot(chord) * length > elastica::kLargestTension) return true;
  }
  const double least = smallest_margin_mm(settings, length);
  return margin.straight_mm < least || (margin.fold_mm < least && nearly_straight(pose, settings.machine));
}

// Names the times at which the blade is straight or taut, and what the clamps' errors may do there. In one
// line: on the edge of what counts as held, a blade may go to and fro from pose to pose.
void warn_of_straight_blades(const StripPlan& strip, const Settings& settings,
                             const std::vector<PoseMargin>& margins, BladeMotion& motion) {
  const auto& poses = motion.poses;
  std::size_t first = poses.size(), last = 0, count = 0;
  double moved_mm = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!unheld(poses[i], margins[i], settings)) continue;
    first = std::min(first, i);
    last = i;
    ++count;
    moved_mm = std::max(moved_mm, clamp_error_mm(poses[i], margins[i].straight_mm, settings.machine));
  }
  if (count == 0) return;
  motion.warnings.push_back(
      say(Saying::kNearlyStraight, {strip.id, count, poses[first].t, name(poses[first].phase), poses[last].t,
                                    name(poses[last].phase), moved_mm}));
}

// Where `before` puts a pose first.
template <typename Before>
std::size_t first_by(const std::vector<PoseCheck>& checks, Before before) {
  return static_cast<std::size_t>(std::min_element(checks.begin(), checks.end(), before) - checks.begin());
}

// Limits are written so that a value that is not a number is refused.
void refuse_bending(const std::vector<PoseCheck>& checks, const robot::Blade& blade, Refuser& refuse) {
  const std::size_t i =
      first_by(checks, [](const auto& a, const auto& b) { return a.curvature > b.curvature; });
  if (checks[i].curvature <= max_curvature_per_mm(blade)) return;
  refuse(i, Limit::kBendingStress, checks[i].loads.stress_mpa, blade.yield_strength_mpa / blade.safety);
}

void refuse_places(const std::vector<PoseCheck>& checks, const StockSettings& stock, Refuser& refuse) {
  const std::size_t near =
      first_by(checks, [](const auto& a, const auto& b) { return a.clearance < b.clearance; });
  if (!(checks[near].clearance >= stock.clearance_mm)) {
    refuse(near, Limit::kClampClearance, checks[near].clearance, stock.clearance_mm,
           refuse.phase(near) == StripPhase::kRetract ? say(Saying::kLeadEndsNear) : "");
  }
  const std::size_t deep = first_by(checks, [](const auto& a, const auto& b) { return a.depth > b.depth; });
  if (!(checks[deep].depth <= kFreePartDepthMm)) {
    refuse(deep, Limit::kFreePart, checks[deep].depth, kFreePartDepthMm);
  }
  const std::size_t crossed =
      first_by(checks, [](const auto& a, const auto& b) { return a.crosses && !b.crosses; });
  if (checks[crossed].crosses) refuse(crossed, Limit::kSelfCrossing, 1, 0);
}

// The blade would snap by an error that its clamps may have. A nearly straight one is warned of instead: what
// it snaps to lies as near as what the errors move it by anyway.
void refuse_near_folds(const std::vector<PoseMargin>& margins, const BladeMotion& motion,
                       const Settings& settings, Refuser& refuse) {
  const double least = smallest_margin_mm(settings, motion.poses.front().blade.length);
  std::size_t worst = 0;
  double smallest = least;
  for (std::size_t i = 0; i < margins.size(); ++i) {
    if (margins[i].fold_mm >= smallest || nearly_straight(motion.poses[i], settings.machine)) continue;
    smallest = margins[i].fold_mm;
    worst = i;
  }
  if (smallest >= least) return;
  refuse(worst, Limit::kSnapError, smallest, least);
}

void refuse_instability(const std::vector<PoseCheck>& checks, const robot::Blade& blade,
                        const Settings& settings, const BladeMotion& motion, Refuser& refuse) {
  const std::size_t tipped =
      first_by(checks, [](const auto& a, const auto& b) { return !a.sag.stable && b.sag.stable; });
  if (!checks[tipped].sag.stable) {
    refuse(tipped, Limit::kTipping,
           elastica::lateral_margin(motion.poses[tipped].blade, robot::stiffness_ratios(blade)), 0);
  }
  if (motion.facts.smallest_margin >= settings.blade.min_margin) return;
  const auto worst =
      std::min_element(motion.poses.begin(), motion.poses.end(),
                       [](const BladePose& a, const BladePose& b) { return a.margin < b.margin; });
  refuse(static_cast<std::size_t>(worst - motion.poses.begin()), Limit::kPlannedMargin, worst->margin,
         settings.blade.min_margin);
}

}  // namespace

void check_blade(const StripPlan& strip, const Settings& settings, MotionLook look, BladeMotion& motion) {
  const robot::Blade& blade = settings.blade;
  const std::vector<PoseCheck> checks = check_poses(motion.poses, strip, blade, settings.machine.clamps);
  collect(checks, motion);
  std::vector<PoseMargin> margins;
  if (look == MotionLook::kFull) {
    margins = weigh_margins(settings, motion);
    weigh_clamp_errors(strip, settings.machine, margins, motion);
    warn_of_straight_blades(strip, settings, margins, motion);
  }
  Refuser refuse(strip, motion);
  refuse_bending(checks, settings.blade, refuse);
  refuse_places(checks, settings.stock, refuse);
  refuse_instability(checks, blade, settings, motion, refuse);
  if (look == MotionLook::kFull) refuse_near_folds(margins, motion, settings, refuse);
}

}  // namespace hotblade::pipeline

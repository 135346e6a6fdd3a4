// The pose stage: the blade's shape, both clamps and the time of every waypoint of a strip.
//
// Between ribs the state of the rib's elastica at its middle is interpolated by a cubic spline over the
// sweep; an interpolated state is again an exact elastica of the blade's exact length, so clamp poses follow
// without solving a boundary value problem, and the whole strip is one continuous path in the space of
// shapes.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "pipeline/plan/ribs/strip_plan.hpp"
#include "pipeline/verify/refusal.hpp"

namespace hotblade::pipeline {

// What the motion of a strip was measured to be, over all of its poses where nothing else is said.
struct MotionFacts {
  double duration_s = 0, cut_s = 0;
  double jerk_s = 0;        // of the duration, what limits of jerk take
  double off_plane_mm = 0;  // how far the clamps leave a common plane between waypoints, where planes turn
  double slowest_feed_mm_s = 0;  // of any blade point in foam while cutting at constant rate
  double smallest_margin = 0, largest_curvature_per_mm = 0, smallest_clearance_mm = 0;
  double largest_force_n = 0, largest_moment_n_mm = 0, largest_stress_mpa = 0;  // moment: at a clamp
  // Weight moves the part that forms the design by this, over the poses that cut: out of the plane, about the
  // blade, and in the plane, where that is not level.
  double droop_mm = 0, twist_rad = 0, in_plane_sag_mm = 0;
  double clamp_error_mm = 0;  // errors of the clamps (settings.machine) move the blade at the ribs, at worst
  // The clamps may err this far before the shape is lost (pipeline/plan/motion/clamp_margins.hpp): before it
  // snaps, and before it is straight and may bow to either side.
  double smallest_fold_mm = 0, smallest_straight_mm = 0;
  [[nodiscard]] double smallest_margin_mm() const {
    return smallest_fold_mm < smallest_straight_mm ? smallest_fold_mm : smallest_straight_mm;
  }
  // Of each rib's pose, mm by each clamp coordinate for 0.1 mm or 1 mrad (elastica/blade/sensitivity.hpp);
  // infinite where the blade is straight. None of a coarse look.
  std::vector<std::array<double, 6>> rib_sensitivity_mm;
  // Whether what clamps may err was looked at.
  [[nodiscard]] bool clamps_weighed() const { return !rib_sensitivity_mm.empty(); }
};

// A strip's motion: its poses, and what was measured of them.
struct BladeMotion {
  std::vector<BladePose> poses;
  MotionFacts facts;
  // How much higher than on the usual plinth the block has to stand for its clamps to stay clear of the
  // table, in whole cm, where machine.plinth_mm leaves it open. Poses lie in the design's frame and do not
  // change.
  double raise_mm = 0;
  std::vector<std::string> warnings;  // what the clamps do not decide
  std::vector<Refusal> refusals;      // limits exceeded by the poses themselves, re-measured from them
};

// Sets how long a strip and its cut take.
void time_facts(const std::vector<BladePose>& poses, MotionFacts& facts);

// How closely a motion is looked at.
enum class MotionLook {
  kFull,
  kCoarse,  // waypoints farther apart, and the clamps' errors left out, which take most of the time
};

// Returns the motion of the blade through the strip: every stretch of its path timed and checked. A coarse
// look finds what a strip cuts and refuses no motion that a full one would not.
[[nodiscard]] BladeMotion move_blade(const StripPlan& strip, const Settings& settings,
                                     MotionLook look = MotionLook::kFull);

}  // namespace hotblade::pipeline

#include "pipeline/plan/motion/rib_clamp_error.hpp"

#include <algorithm>

#include "pipeline/plan/ribs/rib_spline.hpp"
#include "pipeline/program/clamps.hpp"
#include "pipeline/verify/clamp_error.hpp"

namespace hotblade::pipeline {

namespace {

double moved_mm(const StripPlan& strip, double offset_mm, const elastica::Elastica& rib,
                const MachineSettings& machine) {
  BladePose pose;
  pose.frame = strip.plane(offset_mm);
  pose.blade = extended(rib, strip.blade_length_mm, strip.share_a);
  const double before_mm = strip.share_a * (strip.blade_length_mm - rib.length);
  const DesignPart formed = strip.formed_at(offset_mm);
  pose.foam = {{before_mm + formed.first * rib.length, before_mm + formed.last * rib.length}};
  const ClampPoses holding = clamps(pose.blade, pose.frame);
  const ClampPoses told = robot::told(holding, machine.clamps);
  pose.a = told.a;
  pose.b = told.b;
  const double slack_mm = strip.blade_length_mm - (holding.b.p - holding.a.p).norm();
  return clamp_error_mm(pose, slack_mm, machine);
}

}  // namespace

double rib_clamp_error_mm(const StripPlan& strip, const MachineSettings& machine) {
  constexpr int kParts = 4;  // of a gap
  const RibSpline spline(strip.ribs);
  double most_mm = 0;
  for (std::size_t i = 0; i + 1 < strip.ribs.size(); ++i) {
    const double from = strip.ribs[i].offset_mm, gap = strip.ribs[i + 1].offset_mm - from;
    for (int k = 0; k <= kParts; ++k) {
      const double offset_mm = from + gap * k / kParts;
      const elastica::Elastica rib = from_mid_state(spline.mid_at(offset_mm));
      most_mm = std::max(most_mm, moved_mm(strip, offset_mm, rib, machine));
    }
  }
  return most_mm;
}

}  // namespace hotblade::pipeline

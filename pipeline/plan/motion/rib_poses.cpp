#include "pipeline/plan/motion/rib_poses.hpp"

#include "pipeline/plan/ribs/fade.hpp"
#include "pipeline/plan/ribs/rib_spline.hpp"
#include "pipeline/program/clamps.hpp"

namespace hotblade::pipeline {

namespace {

BladePose pose_at(const StripPlan& strip, double offset_mm, const elastica::Elastica& rib,
                  const MachineSettings& machine) {
  BladePose pose;
  pose.frame = strip.plane(offset_mm);
  pose.blade = extended(rib, strip.blade_length_mm, strip.share_a);
  const double before_mm = strip.share_a * (strip.blade_length_mm - rib.length);
  const DesignPart formed = strip.formed_at(offset_mm);
  pose.foam = {{before_mm + formed.first * rib.length, before_mm + formed.last * rib.length}};
  const ClampPoses told = robot::told(clamps(pose.blade, pose.frame), machine.clamps);
  pose.a = told.a;
  pose.b = told.b;
  return pose;
}

}  // namespace

std::vector<BladePose> rib_poses(const StripPlan& strip, const MachineSettings& machine) {
  constexpr int kParts = 4;  // of a gap
  const RibSpline spline(strip.ribs, strip.on_mm);
  std::vector<BladePose> poses;
  for (std::size_t i = 0; i + 1 < strip.ribs.size(); ++i) {
    const double from = strip.ribs[i].offset_mm, gap = strip.ribs[i + 1].offset_mm - from;
    for (int k = i == 0 ? 0 : 1; k <= kParts; ++k) {
      const double offset_mm = from + gap * k / kParts;
      poses.push_back(pose_at(strip, offset_mm, spline.at(offset_mm), machine));
    }
  }
  return poses;
}

std::vector<BladePose> end_poses(const StripPlan& strip, const MachineSettings& machine) {
  const RibSpline spline(strip.ribs, strip.on_mm);
  const double past = strip.on_mm + kFadeMm;
  std::vector<BladePose> poses;
  for (const double offset_mm : {strip.ribs.front().offset_mm - past, strip.ribs.back().offset_mm + past})
    poses.push_back(pose_at(strip, offset_mm, spline.at(offset_mm), machine));
  return poses;
}

}  // namespace hotblade::pipeline

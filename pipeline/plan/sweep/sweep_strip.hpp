// A strip of ribs from a swept family: what the motion, the pose and the verify stages take.
#pragma once

#include <optional>

#include "pipeline/plan/ribs/strip_plan.hpp"
#include "pipeline/plan/sweep/sweep_fit.hpp"
#include "pipeline/settings/settings.hpp"
#include "pipeline/verify/refusal.hpp"

namespace hotblade::pipeline {

struct SweptStrip {
  std::optional<StripPlan> strip;
  Refusal refusal;   // without the strip's id, where there is no strip
  SweepBlade blade;  // of the strip, on its family
};

// As many ribs as the family has coefficients, evenly spaced: their interpolating spline is the family itself
// (SweepBasis). More, and near it to a hundredth of a millimetre, where slice.spacing_mm asks for closer
// ones. All are equally long, about the family's middles, and reach past what they form; the first and the
// last lie beyond the design's ends, so that no end pose forms what is behind its plane. The data was moved
// as the surface is. The blade is the shortest of the list, from `least_blade_mm` on, that the
// family serves (plan/motion/blade.hpp).
[[nodiscard]] SweptStrip make_swept_strip(const MovedSurface& moved, const SweepFitReport& fit,
                                          double least_blade_mm, const Settings& settings);

// Parts of a split design overlap by twice this, so that neither cuts what it has not seen.
inline constexpr double kSeamOverlapMm = 8;

// The sections that fits and strips are made from; seams are passed by kSeamOverlapMm.
[[nodiscard]] SweepSectionOptions section_options(const Settings& settings,
                                                  const std::vector<SweepSeam>& seams, int count,
                                                  double sample_mm, const SweepSag* sag,
                                                  const SweptBands* bands);

}  // namespace hotblade::pipeline

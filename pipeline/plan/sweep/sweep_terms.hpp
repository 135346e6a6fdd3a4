// What pulls at a swept family, in the five numbers of one section's blade: distances of the design's
// samples, and how far a blade is beyond what it must keep to. The fit of one strip and that of several
// together are made of these.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "pipeline/plan/sweep/sweep_fit.hpp"

namespace hotblade::pipeline {

// By y, theta, kappa, tension1, tension2 of a SweepState.
using ByState = Eigen::Matrix<double, 5, 1>;

// Returns what one unit of an unknown is of y, theta, kappa and both tensions: unknowns are coefficients in
// mm of what they do at half a rib's distance from the middle.
[[nodiscard]] ByState unknown_units(const SweepData& data, double x_mm);

// A sample against its section's curve.
struct SampleTerm {
  double foot_mm = 0;              // arc length of the nearest point
  double away_mm = 0;              // signed distance in space, positive on the waste's side of the curve
  ByState by = ByState::Zero();    // of away_mm
  Eigen::Vector2d by_point{0, 0};  // of away_mm, as the sample moves in its plane
};
// Returns a sample's term, its foot sought from `foot_mm`.
[[nodiscard]] SampleTerm sample_term(const SweepSample& sample, const SweepState& state,
                                     const SweepCurve& curve, double x_mm, double foot_mm);

// A number that is made zero: by how much a blade is beyond a limit, in mm of weight; 0 where it keeps to it.
struct LimitTerm {
  double over = 0;
  ByState by = ByState::Zero();
};
// Returns the radius at one of the curve's nodes.
[[nodiscard]] LimitTerm radius_term(const SweepPoint& node, const SweepFitOptions& options);
// Returns the turn of one of the curve's ends.
[[nodiscard]] LimitTerm turn_term(const SweepPoint& end, const SweepState& state,
                                  const SweepFitOptions& options);
// Returns how deep the clamp at one of the curve's ends is in the block; 0 where no block is given.
[[nodiscard]] LimitTerm clamp_term(const SweepPoint& end, const SweepState& state, double x_mm,
                                   const SweepFitOptions& options);
// Returns the same in mm, not weighted.
[[nodiscard]] double clamp_depth_mm(const SweepPoint& end, const SweepState& state, double x_mm,
                                    const SweepFitOptions& options);

// Returns what the clamps' errors move the part of a blade between two arc lengths from its middle by, across
// itself, mm: what elastica::sensitivity says, at the curve's nodes. Infinite where the blade is straight.
[[nodiscard]] double moved_by_clamps_mm(const SweepCurve& curve, double from_mm, double to_mm,
                                        const ClampPull& clamps);
// Returns by how much a blade that is pulled to be steady is more taut than its shape can be followed by its
// clamps with something to spare.
[[nodiscard]] LimitTerm tension_term(const SweepState& state, const SweepCurve& curve,
                                     const SweepFitOptions& options);
// Returns what the clamps' errors move it by as a number that is made small; nothing where it has no weight.
[[nodiscard]] LimitTerm clamp_error_term(const SweepState& state, const SweepCurve& curve, double from_mm,
                                         double to_mm, const SweepFitOptions& options);

// Returns the weight of the second differences of one of the five functions, and of its values.
[[nodiscard]] double smooth_weight(int function, int coefficients);
[[nodiscard]] double calm_weight(int function, double calm);

}  // namespace hotblade::pipeline

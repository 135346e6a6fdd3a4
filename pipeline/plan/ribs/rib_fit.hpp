// A rib of a strip: its elastica, what of the design it forms, and the cubic Bezier that stands for it.
#pragma once

#include <span>
#include <vector>

#include "elastica/bezier/bezier.hpp"
#include "elastica/fit/fit.hpp"
#include "pipeline/settings/settings.hpp"

namespace hotblade::pipeline {

// The part of a rib, by share of its length, that the design says. The rest is waste.
struct DesignPart {
  double first = 0, last = 1;
};

// Steeper ribs cannot be reached: the band would be wider than the blade's own width allows to correct.
inline constexpr double kMaxSlopeRad = 1.0471975511965976;  // 60 degrees

struct RibFit {
  double offset_mm = 0;
  double max_slope_rad = 0;             // of the design against the rib plane
  std::vector<Eigen::Vector2d> target;  // evenly spaced, strip axes; empty where the design says nothing
  std::vector<Eigen::Vector2d> course;  // the whole rib, evenly spaced
  DesignPart own;                       // what of it forms the design
  std::vector<Eigen::Vector2d> beside;  // points of the sections between this rib and the next ones, for the
                                        // block; none in a StripPlan
  elastica::Bezier bezier;              // after projection where its lambda-residual was above the threshold
  double lambda_residual = 0;
  bool projected = false;
  double bezier_deviation_mm = 0;  // Bezier before projection against target
  elastica::Elastica elastica;
  double deviation_mm = 0;  // elastica against target
  bool converged = false;
};

inline constexpr int kRibSamples = 65;
// Of a blade (elastica::turns_at_most): one that winds faster has snapped or yielded long before, and is not
// worth evaluating.
inline constexpr double kMostTurnsRad = 100;
// Whether a blade of this length through a rib's state does so.
[[nodiscard]] bool winds_up(const elastica::MidState& rib, double length_mm);

// The Bezier of a rib that runs along these evenly spaced points: near them, and projected where its
// lambda-residual is above the threshold.
void give_bezier(RibFit& fit, std::span<const Eigen::Vector2d> points, const FitSettings& settings);

}  // namespace hotblade::pipeline

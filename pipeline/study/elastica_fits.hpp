// True elastica fitted to many cubics, and a check of the fits by many starts.
#pragma once

#include <functional>
#include <vector>

#include "elastica/bezier/bezier.hpp"
#include "pipeline/study/distribution.hpp"

namespace hotblade::pipeline::study {

struct FittedCurve {
  double residual = 0;    // lambda-residual of the cubic
  double l2 = 0, h1 = 0;  // the paper's distances of the cubic to its elastica
};

using CurveOf = std::function<elastica::Bezier(std::size_t)>;

// Fits curves 0 to count - 1. A curve that no elastica can be fitted to (a cusp) has distances 0.
[[nodiscard]] std::vector<FittedCurve> fit_curves(std::size_t count, const CurveOf& curve,
                                                  const std::function<void(double)>& progress);

// The best L2 found for each of the first `count` curves, from many starts around its own fit.
[[nodiscard]] std::vector<double> check_fits(const std::vector<FittedCurve>& fits, std::size_t count,
                                             const CurveOf& curve,
                                             const std::function<void(double)>& progress);

struct FitSummary {
  std::size_t fitted = 0, over_good = 0, over_borderline = 0;  // L2 over 0.007 and 0.01
  Distribution l2, h1;
  std::size_t checked = 0, wrong_minima = 0;  // wrong: some other start gave an L2 clearly below
};
[[nodiscard]] FitSummary summarise(const std::vector<FittedCurve>& fits, const std::vector<double>& best_l2);

}  // namespace hotblade::pipeline::study

#include "pipeline/plan/ribs/rib_fit.hpp"

#include <algorithm>

#include "elastica/bezier/lambda_residual.hpp"
#include "elastica/projection/project.hpp"

namespace hotblade::pipeline {

bool winds_up(const elastica::MidState& rib, double length_mm) {
  // In the axes of its tangent.
  const elastica::Elastica along{0, 0, 0, rib.kappa, rib.tension1, rib.tension2, rib.length};
  return !(turns_at_most(along, std::max(rib.length, length_mm)) < kMostTurnsRad);
}

void give_bezier(RibFit& fit, std::span<const Eigen::Vector2d> points, const FitSettings& settings) {
  const elastica::BezierFit bezier = elastica::fit_bezier(points);
  fit.bezier = bezier.bezier;
  fit.bezier_deviation_mm = bezier.max;
  elastica::LambdaResidual residual = elastica::lambda_residual(fit.bezier);
  if (residual.value > settings.lambda_threshold) {
    const elastica::Projection projection =
        elastica::project_optimal(fit.bezier, elastica::WantedBranch::kBest);
    fit.projected = projection.bezier != fit.bezier;
    fit.bezier = projection.bezier;
    residual = elastica::lambda_residual(fit.bezier);
  }
  fit.lambda_residual = residual.value;
}

}  // namespace hotblade::pipeline

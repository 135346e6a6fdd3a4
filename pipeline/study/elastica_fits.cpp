#include "pipeline/study/elastica_fits.hpp"

#include <algorithm>
#include <cmath>

#include "elastica/bezier/lambda_residual.hpp"
#include "elastica/fit/fit.hpp"
#include "elastica/fit/fit_bezier.hpp"
#include "pipeline/study/random_curves.hpp"

namespace hotblade::pipeline::study {

namespace {

using elastica::Bezier;
using elastica::Elastica;

constexpr int kPoints = 65;
// Starts of the check around each curve's own first guess.
constexpr int kCheckStarts = 24;
// A minimum is wrong when another start undercuts it by more than this share of it, beyond this L2 of
// rounding and quadrature.
constexpr double kUndercut = 0.02, kNoise = 1e-6;

// The fitting problem of one cubic; absent at a cusp.
struct Task {
  std::vector<Eigen::Vector2d> points;
  Elastica guess;
};

Task task_of(const Bezier& b) {
  Task task;
  const elastica::LambdaResidual r = elastica::lambda_residual(b);
  if (r.status == elastica::ResidualStatus::kCusp) return task;
  for (const double t : elastica::even_parameters(b, kPoints))
    task.points.push_back(elastica::evaluate(b, t).p);
  task.guess = first_guess(b, r);
  return task;
}

// Curvature and force parameters scattered by up to half of what such a curve has.
std::vector<Elastica> scattered(const Elastica& guess, CurveRandom& random) {
  std::vector<Elastica> starts{guess};
  const double l = guess.length;
  for (int k = 0; k < kCheckStarts; ++k) {
    Elastica e = guess;
    constexpr double kMostTurn = 4, kMostForce = 30;  // kappa L and lambda L^2 of curves of up to a full wave
    e.theta += random.between(-0.5, 0.5);
    e.kappa += random.between(-kMostTurn, kMostTurn) / l;
    e.lambda1 += random.between(-kMostForce, kMostForce) / (l * l);
    e.lambda2 += random.between(-kMostForce, kMostForce) / (l * l);
    starts.push_back(e);
  }
  return starts;
}

}  // namespace

std::vector<FittedCurve> fit_curves(std::size_t count, const CurveOf& curve,
                                    const std::function<void(double)>& progress) {
  std::vector<FittedCurve> fits(count);
  over_blocks(count, progress, [&](std::size_t first, std::size_t end) {
    std::vector<Bezier> beziers;
    for (std::size_t i = first; i < end; ++i) beziers.push_back(curve(i));
    const std::vector<elastica::BezierElasticaFit> found = elastica::fit_bezier_elastica(beziers);
    for (std::size_t i = first; i < end; ++i) {
      const elastica::LambdaResidual r = elastica::lambda_residual(beziers[i - first]);
      const elastica::BezierElasticaFit& f = found[i - first];
      fits[i].residual = r.status == elastica::ResidualStatus::kCusp ? 1 : r.value;
      if (f.status == elastica::FitStatus::kUnsupported) continue;
      fits[i].l2 = f.l2;
      fits[i].h1 = f.h1;
    }
  });
  return fits;
}

std::vector<double> check_fits(const std::vector<FittedCurve>& fits, std::size_t count, const CurveOf& curve,
                               const std::function<void(double)>& progress) {
  std::vector<double> best(std::min(count, fits.size()));
  over_blocks(best.size(), progress, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      const Bezier b = curve(i);
      const Task task = task_of(b);
      best[i] = fits[i].l2;
      if (task.points.empty()) continue;
      const elastica::BezierElasticaFit all = elastica::fit_bezier_elastica(b, {.all_starts = true});
      if (all.status == elastica::FitStatus::kOk) best[i] = std::min(best[i], all.l2);
      CurveRandom random(i, 0);
      const elastica::ElasticaFit f = fit_elastica(task.points, scattered(task.guess, random), {});
      best[i] = std::min(best[i], f.rms / elastica::arc_lengths(b, kPoints).back());
    }
  });
  return best;
}

FitSummary summarise(const std::vector<FittedCurve>& fits, const std::vector<double>& best_l2) {
  FitSummary s;
  s.fitted = fits.size();
  std::vector<double> l2, h1;
  for (const FittedCurve& f : fits) {
    l2.push_back(f.l2);
    h1.push_back(f.h1);
    if (f.l2 > 0.007) ++s.over_good;
    if (f.l2 > 0.01) ++s.over_borderline;
  }
  s.l2 = distribution(l2);
  s.h1 = distribution(h1);
  s.checked = best_l2.size();
  for (std::size_t i = 0; i < best_l2.size(); ++i) {
    if (fits[i].l2 > (1 + kUndercut) * best_l2[i] + kNoise) ++s.wrong_minima;
  }
  return s;
}

}  // namespace hotblade::pipeline::study

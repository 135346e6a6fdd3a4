#include "pipeline/study/elastica_fits.hpp"

#include <algorithm>
#include <cmath>

#include "elastica/fit.hpp"
#include "elastica/lambda_residual.hpp"
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
  double residual = 1;
};

Task task_of(const Bezier& b) {
  Task task;
  const elastica::LambdaResidual r = elastica::lambda_residual(b);
  if (r.status == elastica::ResidualStatus::kCusp) return task;
  for (const double t : elastica::even_parameters(b, kPoints))
    task.points.push_back(elastica::evaluate(b, t).p);
  task.guess = first_guess(b, r);
  task.residual = r.value;
  return task;
}

elastica::CurveDistance fit(const Bezier& b, const Task& task, const std::vector<Elastica>& starts) {
  return distance(b, fit_elastica(task.points, starts, {}).elastica);
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
    for (std::size_t i = first; i < end; ++i) {
      const Bezier b = curve(i);
      const Task task = task_of(b);
      fits[i].residual = task.residual;
      if (task.points.empty()) continue;
      const elastica::CurveDistance d = fit(b, task, {task.guess});
      fits[i].l2 = d.l2;
      fits[i].h1 = d.h1;
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
      CurveRandom random(i, 0);
      for (const Elastica& start : scattered(task.guess, random))
        best[i] = std::min(best[i], fit(b, task, {start}).l2);
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

#include "pipeline/plan/ribs/rib_fit.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "elastica/bezier/lambda_residual.hpp"
#include "elastica/projection/project.hpp"

namespace hotblade::pipeline {

namespace {

using elastica::Elastica;
using elastica::MidState;

// Pull towards the neighbours, in shares of a rib's length per unit of (curvature x length, tension x
// length^2): a neighbour that differs by 5 units moves a 500 mm rib by about 0.02 mm at most.
constexpr double kNeighbourWeight = 1e-5;
constexpr int kSmoothingSweeps = 6;

// A point past the design's border counts by its distance over kFade of the rib, and kLeastCount at the
// least: the blade is to go on near it, but the design decides. Squares of distances are summed, so the least
// counts a distance as a twentieth of itself.
constexpr double kLeastCount = 0.003, kFade = 1.0 / 20;

std::vector<double> weights_of(const DesignPart& own, int points) {
  std::vector<double> weights;
  double sum = 0;
  for (int i = 0; i < points; ++i) {
    const double u = static_cast<double>(i) / (points - 1);
    const double away = std::max({0.0, own.first - u, u - own.last}) / kFade, square = 1 + away * away;
    weights.push_back(kLeastCount + (1 - kLeastCount) / (square * square));
    sum += weights.back();
  }
  for (double& w : weights) w /= sum;
  return weights;
}

// The points to follow, and of them what the design says.
void set_course(const RibTarget& rib, double u0, double u1, RibFit& fit) {
  if (!rib.own) {
    fit.target = resample(rib, u0, u1, kRibSamples);
    return;
  }
  fit.course = resample(rib, u0, u1, kRibSamples);
  fit.own = rib.own_of(u0, u1);
  fit.weights = weights_of(fit.own, kRibSamples);
  const double width = u1 - u0;
  if (fit.own.last > fit.own.first)
    fit.target = resample(rib, u0 + fit.own.first * width, u0 + fit.own.last * width, kRibSamples);
}

RibFit fit_rib(const RibTarget& rib, double u0, double u1, const FitSettings& settings) {
  RibFit fit;
  fit.offset_mm = rib.offset_mm;
  fit.max_slope_rad = rib.max_slope_rad;
  set_course(rib, u0, u1, fit);
  give_bezier(fit, fit.followed(), settings);
  const elastica::LambdaResidual residual = elastica::lambda_residual(fit.bezier);
  std::vector<Elastica> starts;
  if (has_value(residual.status)) starts.push_back(first_guess(fit.bezier, residual));
  const elastica::ElasticaFit best =
      fit_elastica(fit.followed(), starts, {kLeastTensionWeight, nullptr, 0, fit.weights});
  fit.elastica = best.elastica;
  fit.deviation_mm = fit.course.empty() ? best.max : fit.deviation_of(best.elastica);
  fit.converged = best.converged;
  return fit;
}

elastica::PlanarPose turned_back(const elastica::PlanarPose& s) {
  return {s.x, s.y, s.theta + std::numbers::pi};
}

// Clamped at the end alone: the same problem run through backwards.
elastica::ClampedFit fit_backwards(const RibFit& rib, const elastica::FitOptions& options) {
  const std::vector<Eigen::Vector2d> points(rib.followed().rbegin(), rib.followed().rend());
  const Elastica start[] = {reversed(rib.elastica)};
  elastica::FitOptions back = options;
  MidState prior;
  if (options.prior) {
    prior = *options.prior;
    prior.kappa = -prior.kappa;  // the tensions along and across the tangent stay
    back.prior = &prior;
  }
  std::vector<double> weights(options.weights.rbegin(), options.weights.rend());
  back.weights = weights;
  elastica::ClampedFit fit = fit_clamped(points, {turned_back(*rib.clamp_end), {}}, start, back);
  fit.elastica = reversed(fit.elastica);
  return fit;
}

elastica::ClampedFit fit_forwards(const RibFit& rib, const elastica::FitOptions& options) {
  elastica::ClampedEnds ends{*rib.clamp_start, rib.clamp_end};
  if (ends.end) {
    ends.end->theta =
        ends.start.theta + elastica::true_turning(rib.followed(), ends.start.theta, ends.end->theta);
  }
  const Elastica start[] = {rib.elastica};
  return fit_clamped(rib.followed(), ends, start, options);
}

// Fits again from where the rib is.
void refit(RibFit& rib, elastica::FitOptions options) {
  options.weights = rib.weights;
  if (rib.clamp_start || rib.clamp_end) {
    const elastica::ClampedFit fit =
        rib.clamp_start ? fit_forwards(rib, options) : fit_backwards(rib, options);
    const bool kept = fit.status != elastica::ClampedStatus::kNoCurve;
    rib.deviation_mm = !kept                ? std::numeric_limits<double>::infinity()
                       : rib.course.empty() ? fit.max
                                            : rib.deviation_of(fit.elastica);
    rib.converged = fit.status == elastica::ClampedStatus::kOk;
    if (kept) rib.elastica = fit.elastica;
    return;
  }
  const Elastica start[] = {rib.elastica};
  const elastica::ElasticaFit fit = fit_elastica(rib.followed(), start, options);
  rib.elastica = fit.elastica;
  rib.deviation_mm = rib.course.empty() ? fit.max : rib.deviation_of(fit.elastica);
  rib.converged = fit.converged;
}

// Curvature and tensions as pure numbers, independent of the rib's length.
Eigen::Vector3d pure(const MidState& m) {
  return {m.kappa * m.length, m.tension1 * m.length * m.length, m.tension2 * m.length * m.length};
}

// What the neighbours say this rib should be: the line through them, or through the next two at a strip's
// ends (a plain copy of one neighbour would drag the end ribs inwards). At least 3 ribs.
MidState neighbours_say(const std::vector<double>& offsets, const std::vector<MidState>& mids,
                        std::size_t i) {
  const std::size_t last = mids.size() - 1;
  const std::size_t a = i == 0 ? 1 : i - 1, b = i == 0 ? 2 : i == last ? last - 2 : i + 1;
  const double t = (offsets[i] - offsets[a]) / (offsets[b] - offsets[a]);
  const Eigen::Vector3d v = (1 - t) * pure(mids[a]) + t * pure(mids[b]);
  MidState prior = mids[i];
  prior.kappa = v[0] / prior.length;
  prior.tension1 = v[1] / (prior.length * prior.length);
  prior.tension2 = v[2] / (prior.length * prior.length);
  return prior;
}

}  // namespace

double RibFit::deviation_of(const Elastica& e) const {
  return target.empty() ? 0 : elastica::max_distance(target, e);
}

bool winds_up(const MidState& rib, double length_mm) {
  // In the axes of its tangent.
  const Elastica along{0, 0, 0, rib.kappa, rib.tension1, rib.tension2, rib.length};
  return !(turns_at_most(along, std::max(rib.length, length_mm)) < kMostTurnsRad);
}

std::vector<RibFit> fit_ribs(std::span<const RibTarget> ribs, double u0, double u1,
                             const FitSettings& settings) {
  std::vector<RibFit> fits(ribs.size());
  tbb::parallel_for(std::size_t{0}, ribs.size(),
                    [&](std::size_t i) { fits[i] = fit_rib(ribs[i], u0, u1, settings); });
  return fits;
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

void settle(RibFit& rib, const MidState& state) {
  rib.elastica = from_mid_state(state);
  if (rib.clamp_start || rib.clamp_end) {
    // A hundred times as strong as a neighbour's word: what the shared ends leave open is the state's.
    refit(rib, {0, &state, 100 * kNeighbourWeight, {}});
  } else {
    rib.deviation_mm = rib.deviation_of(rib.elastica);
  }
}

std::vector<RibFit> calmed(const std::vector<RibFit>& ribs, double tension_weight) {
  std::vector<RibFit> calm = ribs;
  elastica::FitOptions options;
  options.tension_weight = tension_weight;
  tbb::parallel_for(std::size_t{0}, ribs.size(), [&](std::size_t i) { refit(calm[i], options); });
  return calm;
}

void smooth_ribs(std::vector<RibFit>& ribs, double tension_weight, double allowance_mm, double most_mm) {
  if (ribs.size() < 3) return;
  std::vector<double> bound, offsets;
  for (const RibFit& rib : ribs) offsets.push_back(rib.offset_mm);
  for (const RibFit& rib : ribs) bound.push_back(std::min(rib.deviation_mm + allowance_mm, most_mm));
  for (int sweep = 0; sweep < kSmoothingSweeps; ++sweep) {
    std::vector<MidState> mids;
    for (const RibFit& rib : ribs) mids.push_back(mid_state(rib.elastica));
    // Every rib looks at the sweep's start only: the result does not depend on the order or the threads.
    tbb::parallel_for(std::size_t{0}, ribs.size(), [&](std::size_t i) {
      const MidState prior = neighbours_say(offsets, mids, i);
      RibFit candidate = ribs[i];
      refit(candidate, {tension_weight, &prior, kNeighbourWeight, {}});
      if (candidate.deviation_mm <= bound[i]) ribs[i] = std::move(candidate);
    });
  }
}

}  // namespace hotblade::pipeline

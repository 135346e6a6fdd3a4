#include "elastica/arcs/arcs_split.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace hotblade::elastica {

namespace {

// A piece may not turn farther: a convex arc that turns by less than pi is short, which the theorems need.
constexpr double kMostTurning = 3.0;
// Where the end of a piece is sought: to this part of what is left. Pieces come out as long as they may, less
// this.
constexpr double kSearchPart = 1e-3;

SpiralEnds ends_of(const std::function<CurvePoint(double)>& curve, double from, double to) {
  return {curve(from), curve(to), to - from};
}

// The error bound of one piece, infinite where there is none.
double bound(const std::function<CurvePoint(double)>& curve, double from, double to) {
  const SpiralEnds ends = ends_of(curve, from, to);
  if (std::abs(ends.b.theta - ends.a.theta) > kMostTurning) return INFINITY;
  return spiral_bound(ends);
}

// The farthest end of a piece from `from` whose bound is within the tolerance. The bound grows about as the
// cube of the length, by which the search starts.
double farthest(const std::function<CurvePoint(double)>& curve, double from, double to, double tolerance,
                double first_guess) {
  if (bound(curve, from, to) <= tolerance) return to;
  double lo = from, hi = to, step = std::min(first_guess, 0.5 * (to - from));
  while (hi - lo > kSearchPart * (lo - from)) {
    const double at = lo == from ? from + step : 0.5 * (lo + hi);
    const double e = bound(curve, from, at);
    (e <= tolerance ? lo : hi) = at;
    if (lo == from) {
      const double shrink = std::isfinite(e) ? 0.95 * std::cbrt(tolerance / e) : 0.5;
      step *= std::clamp(shrink, 0.02, 0.95);
      if (!(from + step > from)) {
        throw std::runtime_error("a curve's piece is no arc down to rounding: is it smooth?");
      }
    } else if (std::isfinite(e) && e > 0) {
      const double guess = from + (at - from) * std::cbrt(tolerance / e) * (1 - 0.3 * kSearchPart);
      if (guess > lo && guess < hi && bound(curve, from, guess) <= tolerance) lo = guess;
      const double beyond = guess + kSearchPart * (guess - from);
      if (lo == guess && beyond < hi && bound(curve, from, beyond) > tolerance) hi = beyond;
    }
  }
  return lo;
}

void append(ArcFit& fit, const SpiralArcs& piece) {
  fit.error_bound = std::max(fit.error_bound, piece.error_bound);
  ++fit.spirals;
  for (const Arc& arc : piece.arcs) {
    if (!(arc.length > 0)) continue;
    fit.length += arc.length;
    fit.arcs.push_back(arc);
  }
}

// Joins neighbouring arcs of one curvature: the circle of curvature at the joint of two triarcs.
void merge_equal(std::vector<Arc>& arcs) {
  std::vector<Arc> merged;
  for (const Arc& arc : arcs) {
    const auto equal = [&](const Arc& before) { return before.kappa == arc.kappa; };
    if (merged.empty() || !equal(merged.back())) {
      merged.push_back(arc);
      continue;
    }
    merged.back().length += arc.length;
  }
  arcs = std::move(merged);
}

}  // namespace

ArcFit fit_arcs_between(const std::function<CurvePoint(double)>& curve, const std::vector<double>& breaks,
                        double tolerance, ArcOrder order) {
  ArcFit fit;
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    double from = breaks[i], step = breaks[i + 1] - breaks[i];
    while (from < breaks[i + 1]) {
      double to = farthest(curve, from, breaks[i + 1], tolerance, step);
      // A remainder too short to have a shape of its own is shared.
      const double left = breaks[i + 1] - to;
      if (left > 0 && left < kSearchPart * (to - from)) to = 0.5 * (from + breaks[i + 1]);
      auto piece = spiral_arcs(ends_of(curve, from, to), order);
      while (!piece) {  // no spiral as far as rounding tells
        to = from + 0.5 * (to - from);
        if (!(to - from > 1e-12 * breaks.back())) {
          throw std::runtime_error("a curve's piece is no arc down to rounding: is it smooth?");
        }
        piece = spiral_arcs(ends_of(curve, from, to), order);
      }
      append(fit, *piece);
      step = 1.1 * (to - from);
      from = to;
    }
  }
  if (order == ArcOrder::kTriarc) merge_equal(fit.arcs);
  return fit;
}

}  // namespace hotblade::elastica

#include "pipeline/study/arc_measures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace hotblade::pipeline::study {

namespace {

using Eigen::Vector2d;
using elastica::Arc;
using elastica::CurvePoint;
using elastica::ElasticaCurve;

// A biarc may not turn farther; theorem 1 wants short arcs.
constexpr double kMostTurning = 3;
// Points that decide whether a biarc is near enough: 16 intervals, which miss a percent of the largest
// deviation.
constexpr int kPointsOfPiece = 17;

std::vector<Arc> biarc(const elastica::SpiralEnds& ends, Joint joint) {
  if (std::abs(ends.b.theta - ends.a.theta) > kMostTurning) return {};
  if (joint == Joint::kSameLength) {
    const auto found = elastica::spiral_arcs(ends, elastica::ArcOrder::kBiarc);
    return found ? found->arcs : std::vector<Arc>{};
  }
  const auto family = elastica::BiarcFamily::between(ends.a, ends.b);
  if (!family) return {};
  const auto two = family->arcs(1);
  return {two[0], two[1]};
}

}  // namespace

double distance_to(const Arc& arc, const Vector2d& point) {
  const Vector2d at = point - Vector2d(arc.x, arc.y);
  const double c = std::cos(arc.theta), s = std::sin(arc.theta);
  const double x = c * at.x() + s * at.y(), y = c * at.y() - s * at.x();
  double along = arc.kappa == 0 ? x : std::atan2(arc.kappa * x, 1 - arc.kappa * y) / arc.kappa;
  if (along < 0 && arc.kappa != 0) along += 2 * std::numbers::pi / std::abs(arc.kappa);
  if (along >= 0 && along <= arc.length) {
    // | |point - centre| - radius | without the difference of two large numbers.
    const double power = arc.kappa * (x * x + y * y) - 2 * y;
    return std::abs(power) / (1 + std::sqrt(std::max(0.0, 1 + arc.kappa * power)));
  }
  return std::min(at.norm(), (point - point_at(arc, arc.length).position()).norm());
}

double deviation(const ElasticaCurve& curve, double from, std::span<const Arc> arcs, int points) {
  double whole = 0, worst = 0, done = 0;
  for (const Arc& arc : arcs) whole += arc.length;
  std::size_t k = 0;
  for (int i = 0; i < points; ++i) {
    const double s = whole * i / (points - 1);
    while (k + 1 < arcs.size() && done + arcs[k].length < s) done += arcs[k++].length;
    const Vector2d p = curve.at(from + s).position();
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t j = k < 2 ? 0 : k - 2; j < std::min(k + 3, arcs.size()); ++j) {
      nearest = std::min(nearest, distance_to(arcs[j], p));
    }
    worst = std::max(worst, nearest);
  }
  return worst;
}

elastica::Elastica random_elastica(std::uint64_t seed, std::uint64_t index) {
  CurveRandom random(seed, index);
  const double length = random.between(200, 1400), kappa = random.between(-0.008, 0.008);
  const double force = std::pow(10, random.between(-7, -3)),
               direction = random.between(-std::numbers::pi, std::numbers::pi);
  const double x = random.between(-100, 100), y = random.between(-100, 100);
  return {x,
          y,
          random.between(-std::numbers::pi, std::numbers::pi),
          kappa,
          force * std::cos(direction),
          force * std::sin(direction),
          length};
}

BisectedArcs bisected_arcs(const ElasticaCurve& curve, std::span<const double> breaks, double tolerance,
                           Joint joint) {
  BisectedArcs result;
  std::vector<double> ends(breaks.rbegin(), breaks.rend());  // still to be reached, the nearest last
  double from = ends.back();
  ends.pop_back();
  while (!ends.empty()) {
    const double to = ends.back();
    const std::vector<Arc> arcs = biarc({curve.at(from), curve.at(to), to - from}, joint);
    const double middle = 0.5 * (from + to);
    // A piece that cannot be halved any more is as good as it gets.
    const bool divisible = middle > from && middle < to;
    if (divisible && (arcs.empty() || deviation(curve, from, arcs, kPointsOfPiece) > tolerance)) {
      ends.push_back(middle);
      continue;
    }
    result.arcs += arcs.size();
    for (const Arc& arc : arcs) result.length += arc.length;
    from = to;
    ends.pop_back();
  }
  return result;
}

std::vector<Arc> random_spiral(CurveRandom& random, double k1, double k2, double l) {
  const int inner = 2 + static_cast<int>(7 * random.unit());
  std::vector<double> levels{0, 1}, cuts{0, 1};
  for (int i = 0; i < inner; ++i) levels.push_back(random.unit());
  for (int i = 0; i <= inner; ++i) cuts.push_back(random.unit());
  std::sort(levels.begin(), levels.end());
  std::sort(cuts.begin(), cuts.end());
  std::vector<Arc> arcs;
  CurvePoint at;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    arcs.push_back({at.x, at.y, at.theta, k1 + levels[i] * (k2 - k1), l * (cuts[i + 1] - cuts[i])});
    at = point_at(arcs.back(), arcs.back().length);
  }
  return arcs;
}

}  // namespace hotblade::pipeline::study

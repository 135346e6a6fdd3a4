#include "pipeline/plan/direction.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "pipeline/plan/body_axes.hpp"
#include "pipeline/plan/strips.hpp"
#include "surface/slice.hpp"

namespace hotblade::pipeline {

namespace {

// An estimate looks at few sections, a coarse plan at enough for its ribs.
constexpr int kEstimatePlanes = 5, kCoarsePlanes = 9;
constexpr std::size_t kPlanned = 6;
// One percent of the design left out weighs as much as one more strip.
constexpr double kUncoveredWeight = 100;
// A blade that has turned this far over a rib has left the block by its sides.
constexpr double kTurnPerStrip = 2;

double extent(const surface::TriangleMesh& mesh, const surface::PlaneFamily& planes) {
  double low = planes.offset(mesh.vertices.front()), high = low;
  for (const Eigen::Vector3d& p : mesh.vertices) {
    low = std::min(low, planes.offset(p));
    high = std::max(high, planes.offset(p));
  }
  return high - low;
}

// Even sections in the middles of `planes` slabs: a border that is not quite parallel to the planes then does
// not leave a sliver for the first and the last of them.
struct Coarse {
  TargetReport targets;
  double slab_mm = 0;
};

Coarse coarse_targets(const surface::DesignSurface& design, const DirectionScore& of, int planes,
                      const Settings& settings) {
  surface::SliceOptions options;
  options.normal = of.normal;
  options.fan = of.fan;
  const double wide = extent(
      design.mesh, of.fan ? fan_about(design.mesh, *of.fan) : surface::PlaneFamily::parallel(of.normal));
  if (!(wide > 2 * planes * options.end_inset_mm)) return {};
  // Rounding must not add a plane.
  options.spacing_mm = (1 + 1e-9) * wide / planes;
  options.end_inset_mm = 0.5 * wide / planes;
  return {make_targets(slice(design, options), settings), options.spacing_mm};
}

// The area that ribs of these lengths, offsets and slopes stand for. The slope over the surface is about half
// of the largest on a rib.
double area_between(double length_a, double length_b, double distance, double slope) {
  return 0.5 * (length_a + length_b) * distance / std::cos(0.5 * slope);
}

// How far a rib's points move for each mm of offset, on average: less than 1 where planes turn.
double mean_rate(const ChainTarget& chain, const RibTarget& rib) {
  if (!chain.planes.turns()) return 1;
  double sum = 0;
  for (std::size_t i = 1; i < rib.points.size(); ++i)
    sum += (rib.s[i] - rib.s[i - 1]) * chain.rate(0.5 * (rib.points[i - 1] + rib.points[i]));
  return sum / rib.s.back();
}

double turning(const RibTarget& rib) {
  // Over stretches of a 32nd of the rib, so that facets do not count.
  const std::vector<Eigen::Vector2d> q = resample(rib, 0, 1, 33);
  double sum = 0;
  for (std::size_t i = 2; i < q.size(); ++i) {
    const Eigen::Vector2d a = q[i - 1] - q[i - 2], b = q[i] - q[i - 1];
    sum += std::abs(std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)));
  }
  return sum;
}

// How much the ribs of a chain grow and shrink, as a share of the longest: 0 where the borders are square to
// the planes, 2 from corner to corner. Short ribs at a corner say little about the blade's shape and cost
// ribs.
double raggedness(const ChainTarget& chain) {
  double change = 0, longest = 0;
  for (std::size_t i = 0; i < chain.ribs.size(); ++i) {
    longest = std::max(longest, chain.ribs[i].s.back());
    if (i > 0) change += std::abs(chain.ribs[i].s.back() - chain.ribs[i - 1].s.back());
  }
  return change / longest;
}

double raggedness(const TargetReport& targets) {
  double sum = 0;
  for (const ChainTarget& chain : targets.chains) sum += raggedness(chain);
  return sum;
}

// Mean of the steepest slope of each rib, as a share of what can be cut.
double steepness(const TargetReport& targets) {
  double sum = 0, ribs = 0;
  for (const ChainTarget& chain : targets.chains) {
    for (const RibTarget& rib : chain.ribs) sum += rib.max_slope_rad / kMaxSlopeRad;
    ribs += static_cast<double>(chain.ribs.size());
  }
  return ribs > 0 ? sum / ribs : 1;
}

void finish(DirectionScore& result, double covered_mm2, const surface::DesignSurface& design,
            const Settings& settings) {
  result.covered_share = std::min(1.0, covered_mm2 / design.health.area_mm2);
  result.score = static_cast<double>(result.strips) + kUncoveredWeight * (1 - result.covered_share) +
                 result.deviation_mm / settings.design.tolerance_mm + result.raggedness + result.steepness;
}

// Strips by length, turning and extent along the sweep alone.
DirectionScore estimate(const surface::DesignSurface& design, const Eigen::Vector3d& n,
                        const Settings& settings, const std::optional<surface::FanAxis>& fan = {}) {
  DirectionScore result{n};
  result.fan = fan;
  double area = 0;
  const double longest = settings.blade.free_lengths_mm.back() - 2 * settings.stock.clearance_mm;
  const double block =
      *std::max_element(settings.stock.max_size_mm.begin(), settings.stock.max_size_mm.end());
  const Coarse coarse = coarse_targets(design, result, kEstimatePlanes, settings);
  result.raggedness = raggedness(coarse.targets);
  result.steepness = steepness(coarse.targets);
  for (const ChainTarget& chain : coarse.targets.chains) {
    double pieces = 1;
    for (const RibTarget& rib : chain.ribs) {
      pieces = std::max(
          {pieces, rib.s.back() / std::max(1.0, std::min(longest, block)), turning(rib) / kTurnPerStrip});
      area +=
          mean_rate(chain, rib) * area_between(rib.s.back(), rib.s.back(), coarse.slab_mm, rib.max_slope_rad);
    }
    const double sweep = coarse.slab_mm + chain.ribs.back().offset_mm - chain.ribs.front().offset_mm;
    result.strips += static_cast<std::size_t>(std::ceil(pieces) * std::ceil(sweep / block));
  }
  finish(result, area, design, settings);
  return result;
}

DirectionScore plan_coarsely(const surface::DesignSurface& design, const Eigen::Vector3d& n,
                             const Settings& settings) {
  DirectionScore result{n};
  result.estimated = false;
  double area = 0;
  const Coarse coarse = coarse_targets(design, result, kCoarsePlanes, settings);
  result.raggedness = raggedness(coarse.targets);
  result.steepness = steepness(coarse.targets);
  const StripLayout layout = lay_out_strips(coarse.targets, settings);
  for (const StripPlan& strip : layout.strips) {
    const auto& ribs = strip.ribs;
    for (const RibFit& rib : ribs) result.deviation_mm = std::max(result.deviation_mm, rib.deviation_mm);
    for (std::size_t i = 1; i < ribs.size(); ++i) {
      area += area_between(ribs[i - 1].elastica.length, ribs[i].elastica.length,
                           ribs[i].offset_mm - ribs[i - 1].offset_mm, ribs[i].max_slope_rad);
    }
    // Half a slab beyond the first and the last rib.
    area += area_between(ribs.front().elastica.length, ribs.back().elastica.length, coarse.slab_mm,
                         ribs.front().max_slope_rad);
  }
  result.strips = layout.strips.size();
  finish(result, area, design, settings);
  return result;
}

void sort_by_score(std::vector<DirectionScore>& ranking, std::size_t count) {
  std::stable_sort(ranking.begin(), ranking.begin() + static_cast<std::ptrdiff_t>(count),
                   [](const DirectionScore& a, const DirectionScore& b) { return a.score < b.score; });
}

}  // namespace

std::vector<DirectionScore> rank_directions(const surface::DesignSurface& design, const Settings& settings) {
  if (settings.slice.fan_axis) {
    const auto& a = *settings.slice.fan_axis;
    const surface::FanAxis axis{{a[0], a[1], a[2]}, {a[3], a[4], a[5]}};
    return {estimate(design, fan_about(design.mesh, axis).normal(0), settings, axis)};
  }
  if (settings.slice.direction) {
    const auto& d = *settings.slice.direction;
    return {estimate(design, Eigen::Vector3d(d[0], d[1], d[2]).normalized(), settings)};
  }
  const BodyAxes body = body_axes(design.mesh);
  std::vector<Eigen::Vector3d> candidates = along_borders(design.mesh, body);
  // A direction nearly along a straight border is worse than the one along it: its first rib is a sliver.
  constexpr double kSame = 0.99;  // within 8 degrees, about half of the hemisphere's steps
  const std::size_t borders = candidates.size();
  for (const Eigen::Vector3d& n : hemisphere(body)) {
    const bool known =
        std::any_of(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(borders),
                    [&](const Eigen::Vector3d& m) { return std::abs(m.dot(n)) > kSame; });
    if (!known) candidates.push_back(n);
  }
  std::vector<DirectionScore> ranking(candidates.size());
  tbb::parallel_for(std::size_t{0}, candidates.size(), [&](std::size_t i) {
    ranking[i] = estimate(design, with_sense(design.mesh, body, candidates[i]), settings);
  });
  sort_by_score(ranking, ranking.size());
  tbb::parallel_for(std::size_t{0}, kPlanned,
                    [&](std::size_t i) { ranking[i] = plan_coarsely(design, ranking[i].normal, settings); });
  sort_by_score(ranking, kPlanned);
  return ranking;
}

}  // namespace hotblade::pipeline

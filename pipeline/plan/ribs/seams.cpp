#include "pipeline/plan/ribs/seams.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hotblade::pipeline {

namespace {

using elastica::CurvePoint;
using elastica::PlanarPose;

CurvePoint end_point(const elastica::Elastica& e) {
  return elastica::ElasticaCurve(e).at(e.length);
}

double turn_between(double from, double to) {
  return std::remainder(to - from, 2 * std::numbers::pi);
}

// Between two states: the share `to_after` of the way from the piece before to the piece after.
PlanarPose state_between(const elastica::Elastica& before, const elastica::Elastica& after, double to_after) {
  const CurvePoint p = end_point(before);
  return {p.x + to_after * (after.x - p.x), p.y + to_after * (after.y - p.y),
          p.theta + to_after * turn_between(p.theta, after.theta)};
}

// An outer piece has one end free and can yield to an inner one, which two clamps leave a single freedom:
// `yield` 0 is the middle between both, 0.5 the inner one's own end.
double share_of_after(std::size_t seam, std::size_t pieces, double yield) {
  const bool outer_before = seam == 0, outer_after = seam + 2 == pieces;
  return outer_before == outer_after ? 0.5 : outer_before ? 0.5 + yield : 0.5 - yield;
}

double worst_deviation(const std::vector<RibFit>& ribs) {
  double worst = 0;
  for (const RibFit& rib : ribs) worst = std::max(worst, rib.deviation_mm);
  return worst;
}

// The pieces with the chosen seams closed; seam i lies before piece i + 1.
std::vector<std::vector<RibFit>> joined(const std::vector<std::vector<RibFit>>& pieces,
                                        const std::vector<bool>& seams, double yield) {
  std::vector<std::vector<RibFit>> clamped = pieces;
  for (std::size_t i = 0; i < seams.size(); ++i) {
    if (!seams[i]) continue;
    for (std::size_t r = 0; r < pieces[i].size(); ++r) {
      const PlanarPose state = state_between(pieces[i][r].elastica, pieces[i + 1][r].elastica,
                                             share_of_after(i, pieces.size(), yield));
      clamped[i][r].clamp_end = state;
      clamped[i + 1][r].clamp_start = state;
    }
  }
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const bool any = (i > 0 && seams[i - 1]) || (i < seams.size() && seams[i]);
    if (any) clamped[i] = calmed(clamped[i], kLeastTensionWeight);
  }
  return clamped;
}

}  // namespace

void join_pieces(std::vector<std::vector<RibFit>>& pieces, double allowed_mm) {
  if (pieces.size() < 2) return;
  std::vector<bool> seams(pieces.size() - 1, true);
  // Every round gives up at least one seam, or ends with the yield that leaves the least deviation.
  while (std::find(seams.begin(), seams.end(), true) != seams.end()) {
    std::vector<std::vector<RibFit>> best;
    std::vector<double> worst;
    for (const double yield : {0.0, 0.25, 0.5}) {
      std::vector<std::vector<RibFit>> clamped = joined(pieces, seams, yield);
      std::vector<double> deviations;
      for (const std::vector<RibFit>& ribs : clamped) deviations.push_back(worst_deviation(ribs));
      const bool first = best.empty();
      if (first || *std::max_element(deviations.begin(), deviations.end()) <
                       *std::max_element(worst.begin(), worst.end())) {
        best = std::move(clamped);
        worst = std::move(deviations);
      }
      if (pieces.size() == 2) break;  // both are outer: nothing yields
    }
    bool all = true;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      if (worst[i] <= allowed_mm) continue;
      all = false;
      if (i > 0) seams[i - 1] = false;
      if (i < seams.size()) seams[i] = false;
    }
    if (!all) continue;
    pieces = std::move(best);
    return;
  }
}

SeamFacts measure_seam(const std::vector<RibFit>& before, const std::vector<RibFit>& after) {
  SeamFacts facts;
  for (std::size_t r = 0, t = 0; r < before.size() && t < after.size();) {
    const RibFit &a = before[r], &b = after[t];
    if (a.offset_mm <= b.offset_mm) ++r;
    if (b.offset_mm <= a.offset_mm) ++t;
    const bool in_design = a.own.last >= 1 && b.own.first <= 0;
    if (a.offset_mm != b.offset_mm || !in_design) continue;
    const CurvePoint p = end_point(a.elastica);
    const elastica::Elastica& q = b.elastica;
    facts.gap_mm = std::max(facts.gap_mm, std::hypot(q.x - p.x, q.y - p.y));
    facts.kink_deg =
        std::max(facts.kink_deg, std::abs(turn_between(p.theta, q.theta)) * 180 / std::numbers::pi);
  }
  return facts;
}

}  // namespace hotblade::pipeline

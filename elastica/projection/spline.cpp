#include "elastica/projection/spline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "elastica/bezier/curve_distance.hpp"
#include "elastica/bezier/standard_position.hpp"
#include "elastica/fit/fit_clamped.hpp"
#include "elastica/projection/project_polish.hpp"

namespace hotblade::elastica {

namespace {

// Lengths tried at a joint; the first grid spans the domain by steps of 10%, each later one a third of it.
constexpr int kLengths = 57, kSplineRounds = 9;
constexpr double kSplineShrink = 1.0 / 3;
constexpr double kNone = std::numeric_limits<double>::infinity();

void expect_chain(std::span<const Bezier> chain) {
  constexpr double kMeet = 1e-9, kTangent = 1e-6;
  if (chain.empty()) throw std::logic_error("project_spline: no segments");
  for (std::size_t i = 1; i < chain.size(); ++i) {
    const Bezier &a = chain[i - 1], &b = chain[i];
    const Eigen::Vector2d in = (a[3] - a[2]).normalized(), out = (b[1] - b[0]).normalized();
    if (!((a[3] - b[0]).norm() <= kMeet * (a[3] - a[0]).norm()) || !((in - out).norm() <= kTangent))
      throw std::logic_error("project_spline: segments do not meet in one point and tangent");
  }
}

struct Segment {
  StandardPosition input;
  double log_chord;
};

// Sum of squares for one grid of logarithmic lengths a joint; the choice with the least one.
struct Choice {
  std::vector<int> at;
  double sum = kNone;
};

Choice least(const std::vector<Segment>& segments, const std::vector<std::vector<double>>& grids) {
  const EdgeBox all = edge_domain();
  const auto place = [](int i, int j) { return static_cast<std::size_t>(i * kLengths + j); };
  std::vector<double> sums(kLengths, 0);
  std::vector<std::vector<int>> came;
  for (std::size_t s = 0; s < segments.size(); ++s) {
    std::vector<double> u, v;
    for (const double from : grids[s]) {
      for (const double to : grids[s + 1]) {
        u.push_back(from - segments[s].log_chord);
        v.push_back(to - segments[s].log_chord);
      }
    }
    const std::vector<double> e2 = squared_residuals(segments[s].input.a1, segments[s].input.a2, u, v);
    std::vector<double> next(kLengths, kNone);
    came.emplace_back(kLengths, 0);
    for (int i = 0; i < kLengths; ++i) {
      for (int j = 0; j < kLengths; ++j) {
        const std::size_t k = place(i, j);
        const double sum = sums[static_cast<std::size_t>(i)] + e2[k];
        const bool inside = u[k] >= all.u0 && u[k] <= all.u1 && v[k] >= all.v0 && v[k] <= all.v1;
        if (!inside || e2[k] > 1 || !(sum < next[static_cast<std::size_t>(j)])) continue;
        next[static_cast<std::size_t>(j)] = sum;
        came.back()[static_cast<std::size_t>(j)] = i;
      }
    }
    sums = next;
  }
  const auto best = std::min_element(sums.begin(), sums.end());
  Choice choice{{static_cast<int>(best - sums.begin())}, *best};
  for (std::size_t s = segments.size(); s-- > 0;)
    choice.at.insert(choice.at.begin(), came[s][static_cast<std::size_t>(choice.at.front())]);
  return choice;
}

// Logarithms of the edge lengths at every joint and end; absent when none fits.
std::optional<std::vector<double>> joint_lengths(const std::vector<Segment>& segments) {
  const EdgeBox all = edge_domain();
  std::vector<double> middles(segments.size() + 1);
  for (std::size_t k = 0; k < middles.size(); ++k) {
    const double before = segments[k > 0 ? k - 1 : 0].log_chord,
                 after = segments[std::min(k, segments.size() - 1)].log_chord;
    middles[k] = 0.5 * (all.u0 + all.u1) + 0.5 * (before + after);
  }
  double half = 0.5 * (all.u1 - all.u0);
  for (int round = 0; round < kSplineRounds; ++round, half *= kSplineShrink) {
    std::vector<std::vector<double>> grids;
    for (const double middle : middles) {
      grids.emplace_back();
      for (int i = 0; i < kLengths; ++i)
        grids.back().push_back(middle + half * (2.0 * i / (kLengths - 1) - 1));
    }
    const Choice choice = least(segments, grids);
    if (choice.sum == kNone) return std::nullopt;
    for (std::size_t k = 0; k < middles.size(); ++k)
      middles[k] = grids[k][static_cast<std::size_t>(choice.at[k])];
  }
  return middles;
}

Bezier piece_of(const Bezier& b, double from, double to) {
  const BezierPoint start = evaluate(b, from), end = evaluate(b, to);
  const double third = (to - from) / 3;
  return {start.p, start.p + third * start.d1, end.p - third * end.d1, end.p};
}

std::optional<SplitPiece> served(const Bezier& b, double from, double to, double tolerance) {
  const Bezier piece = piece_of(b, from, to);
  const ClampedFit fit = fit_clamped(piece);
  if (fit.status != ClampedStatus::kOk || fit.max > tolerance) return std::nullopt;
  const double deviation = distance(piece, fit.elastica).hausdorff;
  if (!(deviation <= tolerance)) return std::nullopt;
  return SplitPiece{from, to, fit.elastica, deviation};
}

}  // namespace

SplineProjection project_spline(std::span<const Bezier> chain, Continuity continuity) {
  expect_chain(chain);
  SplineProjection unsupported{
      {chain.begin(), chain.end()}, std::vector<double>(chain.size()), ProjectStatus::kUnsupported};
  SplineProjection result;
  std::vector<Segment> segments;
  for (const Bezier& b : chain) {
    const auto s = standard_position(b);
    if (!s) return unsupported;
    segments.push_back({*s, std::log((b[3] - b[0]).norm())});
  }
  const auto lengths = continuity == Continuity::kC1 ? joint_lengths(segments)
                                                     : std::optional<std::vector<double>>(std::in_place);
  if (!lengths) return unsupported;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    Projection p;
    if (continuity == Continuity::kG1) {
      p = project_optimal(chain[i], WantedBranch::kBest);
      if (p.status == ProjectStatus::kUnsupported) return unsupported;
    } else {
      StandardPosition s = segments[i].input;
      s.l1 = std::exp((*lengths)[i] - segments[i].log_chord);
      s.l2 = std::exp((*lengths)[i + 1] - segments[i].log_chord);
      p = projection(chain[i], segments[i].input, s, 1);
    }
    result.chain.push_back(p.bezier);
    result.residuals.push_back(p.lambda_residual);
  }
  return result;
}

ElasticaSplit split_to_elastica(const Bezier& b, double tolerance, int candidates) {
  if (!(tolerance > 0) || candidates < 1 || candidates > 256)
    throw std::logic_error("split_to_elastica: tolerance must be positive, candidates 1 to 256");
  const std::vector<double> t = even_parameters(b, candidates + 1);
  // The piece by which each place was first reached, with the place that it starts at.
  std::vector<std::optional<std::pair<std::size_t, SplitPiece>>> reached(t.size());
  const std::size_t last = t.size() - 1;
  std::vector<std::size_t> layer{0};
  while (!layer.empty() && !reached[last]) {
    std::vector<std::size_t> next;
    // The end first: once it is reached nothing else matters.
    for (std::size_t to = last; to > 0 && !reached[last]; --to) {
      for (const std::size_t from : layer) {
        if (from >= to || reached[to]) continue;
        if (const auto piece = served(b, t[from], t[to], tolerance)) {
          reached[to] = {from, *piece};
          next.push_back(to);
        }
      }
    }
    layer = next;
  }
  ElasticaSplit split;
  if (!reached[last]) return split;
  split.within = true;
  for (std::size_t at = last; at > 0; at = reached[at]->first)
    split.pieces.insert(split.pieces.begin(), reached[at]->second);
  return split;
}

}  // namespace hotblade::elastica

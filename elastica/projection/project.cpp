#include "elastica/projection/project.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "elastica/bezier/standard_position.hpp"
#include "elastica/projection/project_zone.hpp"

namespace hotblade::elastica {

namespace {

using Standard = StandardPosition;

// Shortest end edge of an inflectional curve (the paper prints 2.7 for 0.27), and of a plain one.
constexpr double kMinInflectional = 0.27;
constexpr double kMinPlain = 0.12;
constexpr int kSteps = 10;  // the paper's t = 0, 0.1 .. 1
constexpr int kRounds = 2;  // and its repetition of the whole procedure
// The paper's fitted minimiser of the first edge of plain curves (with max, not min, of 0.12 and f). The fit
// was made for a >= 0; curves on the other side are mirrored. b is taken in [0, 2 pi), where the paper's
// curves have it.
double plain_edge(double a, double b) {
  a = wrapped(a);
  if (a < 0) {
    a = -a;
    b = -b;
  }
  b = wrapped(b);
  if (b < 0) b += 2 * std::numbers::pi;
  const double f = 0.00001475 * std::exp(10.39 * a - 10.48 * b) +
                   0.4574 * a * std::exp(1.711 * a - 2.535 * b) +
                   2.772 * b * std::exp(-0.08504 * a - 0.9109 * b) - 0.2957 * a * b * std::exp(-0.6606 * a);
  // Outside the paper's curves the exponentials run away: kept within four chords.
  constexpr double kLongest = 4;
  return std::clamp(f, kMinPlain, kLongest);
}

std::array<double, 2> plain_target(double a1, double a2) {
  return {plain_edge(a1, a2), plain_edge(std::numbers::pi - a2, std::numbers::pi - a1)};
}

struct Scored {
  Standard s;
  double e;
};

// Walks from `from` to edge lengths (m1, m2), stopping at the threshold or, when `inflectional_only`, at the
// first plain curve, which still counts. Returns the best curve of the walk.
Scored walk(const Standard& from, const std::array<double, 2>& target, double threshold,
            bool inflectional_only) {
  Scored best{from, score(from)};
  for (int i = 1; i <= kSteps && best.e > threshold; ++i) {
    const double t = static_cast<double>(i) / kSteps;
    const Standard s{from.a1, from.a2, (1 - t) * from.l1 + t * target[0], (1 - t) * from.l2 + t * target[1]};
    // Both ends of a plain walk may be free of a crossing and its middle not.
    if (const double e = score(s); e < best.e && !edges_cross(s)) best = {s, e};
    if (inflectional_only && !inflectional(s)) break;
  }
  return best;
}

// One run of the paper's steps (3) and (4), from edges that do not cross.
Scored deform(const Standard& start, double threshold) {
  const double lmax = edge_limits(start.a1, start.a2).longest;
  Standard adjusted = start;
  adjusted.l1 = std::clamp(start.l1, kMinInflectional, lmax);
  adjusted.l2 = std::clamp(start.l2, kMinInflectional, lmax);
  if (inflectional(adjusted)) return walk(adjusted, {kMinInflectional, kMinInflectional}, threshold, true);
  return walk(start, plain_target(start.a1, start.a2), threshold, false);
}

}  // namespace

Projection project_feedback(const Bezier& b, double threshold) {
  const auto input = standard_position(b);
  if (!input) {
    Projection result;
    result.bezier = b;
    result.status = ProjectStatus::kUnsupported;
    return result;
  }
  Standard from = uncrossed(*input);
  Scored best{from, score(from)};
  for (int round = 0; round < kRounds && best.e > threshold; ++round) {
    const Scored next = deform(from, threshold);
    if (next.e < best.e) best = next;
    from = next.s;
  }
  return projection(b, *input, best.s, threshold);
}

Projection projection(const Bezier& b, const StandardPosition& input, const StandardPosition& s,
                      double threshold) {
  Projection result;
  result.bezier = with_edges(b, input, s);
  result.lambda_residual = score(s);
  result.branch = inflectional(s) ? Branch::kInflectional : Branch::kPlain;
  result.moved = {s.l1 - input.l1, s.l2 - input.l2};
  result.angle_constraints_hold = angle_constraints_hold(input);
  result.status = result.lambda_residual <= threshold ? ProjectStatus::kReached : ProjectStatus::kNotReached;
  return result;
}

}  // namespace hotblade::elastica

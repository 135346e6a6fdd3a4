#include "elastica/project.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "elastica/lambda_residual.hpp"

namespace hotblade::elastica {

namespace {

using Complex = std::complex<double>;
constexpr double kPi = std::numbers::pi;

// Standard position: ends at 0 and 1, end edges of length l1, l2 in directions a1 (p0 -> p1) and a2 (p3 ->
// p2).
struct Standard {
  double a1, a2, l1, l2;
};

// Shortest end edge of an inflectional curve (the paper prints 2.7 for 0.27), and of a plain one.
constexpr double kMinInflectional = 0.27;
constexpr double kMinPlain = 0.12;
constexpr int kSteps = 10;  // the paper's t = 0, 0.1 .. 1
constexpr int kRounds = 2;  // and its repetition of the whole procedure
// Crossing edges are shortened to this share of the way to their crossing.
constexpr double kUncross = 0.98;

double wrapped(double a) {
  a = std::remainder(a, 2 * kPi);
  return a <= -kPi ? kPi : a;
}

Bezier standard_bezier(const Standard& s) {
  const Complex p1 = std::polar(s.l1, s.a1), p2 = 1.0 + std::polar(s.l2, s.a2);
  return {Eigen::Vector2d(0, 0), {p1.real(), p1.imag()}, {p2.real(), p2.imag()}, {1, 0}};
}

// Where the first and third edge cross, both are shortened to just before the crossing.
Standard uncrossed(Standard s) {
  const double d = std::sin(s.a2 - s.a1);
  if (d == 0) return s;
  // 0 + u e(a1) = 1 + v e(a2)
  const double u = std::sin(s.a2) / d, v = std::sin(s.a1) / d;
  if (u > 0 && v > 0 && u <= s.l1 && v <= s.l2) {
    s.l1 = std::min(s.l1, kUncross * u);
    s.l2 = std::min(s.l2, kUncross * v);
  }
  return s;
}

// Inner polygon angles phi1, phi2 on different sides of pi.
bool inflectional(const Standard& s) {
  const Complex p1 = std::polar(s.l1, s.a1), p2 = 1.0 + std::polar(s.l2, s.a2);
  const auto cross = [](Complex a, Complex b) { return (std::conj(a) * b).imag(); };
  return cross(p1, p2 - p1) * cross(p2 - p1, 1.0 - p2) < 0;
}

double longest_edge(double a1, double a2) {
  const double d = (a2 < 0 ? -1.0 : 1.0) * (a1 - a2) / kPi;
  return std::max(1.2 * (1 + 5 * d), 0.58);
}

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
  if (b < 0) b += 2 * kPi;
  const double f = 0.00001475 * std::exp(10.39 * a - 10.48 * b) +
                   0.4574 * a * std::exp(1.711 * a - 2.535 * b) +
                   2.772 * b * std::exp(-0.08504 * a - 0.9109 * b) - 0.2957 * a * b * std::exp(-0.6606 * a);
  // Outside the paper's curves the exponentials run away: kept within four chords.
  constexpr double kLongest = 4;
  return std::clamp(f, kMinPlain, kLongest);
}

std::array<double, 2> plain_target(double a1, double a2) {
  return {plain_edge(a1, a2), plain_edge(kPi - a2, kPi - a1)};
}

struct Scored {
  Standard s;
  double e;
};

double score(const Standard& s) {
  const LambdaResidual r = lambda_residual(standard_bezier(s));
  return r.status == ResidualStatus::kCusp ? 1.0 : r.value;
}

// Walks from `from` to edge lengths (m1, m2), stopping at the threshold or, when `inflectional_only`, at the
// first plain curve, which still counts. Returns the best curve of the walk.
Scored walk(const Standard& from, const std::array<double, 2>& target, double threshold,
            bool inflectional_only) {
  Scored best{from, score(from)};
  for (int i = 1; i <= kSteps && best.e > threshold; ++i) {
    const double t = static_cast<double>(i) / kSteps;
    const Standard s{from.a1, from.a2, (1 - t) * from.l1 + t * target[0], (1 - t) * from.l2 + t * target[1]};
    const double e = score(s);
    if (e < best.e) best = {s, e};
    if (inflectional_only && !inflectional(s)) break;
  }
  return best;
}

// One run of the paper's steps (3) and (4).
Scored deform(const Standard& input, double threshold) {
  const Standard start = uncrossed(input);
  const double lmax = longest_edge(start.a1, start.a2);
  Standard adjusted = start;
  adjusted.l1 = std::clamp(start.l1, kMinInflectional, lmax);
  adjusted.l2 = std::clamp(start.l2, kMinInflectional, lmax);
  if (inflectional(adjusted)) return walk(adjusted, {kMinInflectional, kMinInflectional}, threshold, true);
  return walk(start, plain_target(start.a1, start.a2), threshold, false);
}

bool angle_constraints(const Standard& s) {
  const auto positive = [](double a) { return a < 0 ? a + 2 * kPi : a; };
  const double b1 = positive(wrapped(kPi - s.a1)), b2 = positive(s.a2);
  const auto inside = [](double b) { return b > kPi / 3 && b < 5 * kPi / 3; };
  return inside(b1) && inside(b2) && std::abs(b1 - b2) < 0.4 * kPi;
}

}  // namespace

Projection project_feedback(const Bezier& b, double threshold) {
  const auto z = [](const Eigen::Vector2d& p) { return Complex(p.x(), p.y()); };
  const Complex chord = z(b[3]) - z(b[0]);
  const Complex e1 = z(b[1]) - z(b[0]), e2 = z(b[2]) - z(b[3]);
  Projection result;
  result.bezier = b;
  if (std::abs(chord) == 0 || std::abs(e1) == 0 || std::abs(e2) == 0) {
    result.status = ProjectStatus::kUnsupported;
    return result;
  }
  const Standard input{wrapped(std::arg(e1 / chord)), wrapped(std::arg(e2 / chord)), std::abs(e1 / chord),
                       std::abs(e2 / chord)};
  Scored best{input, score(input)};
  Standard from = input;
  for (int round = 0; round < kRounds && best.e > threshold; ++round) {
    const Scored next = deform(from, threshold);
    if (next.e < best.e) best = next;
    from = next.s;
  }
  // Only the edge lengths change: the end tangents keep their direction to the last bit of the division.
  result.bezier[1] = b[0] + (b[1] - b[0]) * (best.s.l1 / input.l1);
  result.bezier[2] = b[3] + (b[2] - b[3]) * (best.s.l2 / input.l2);
  result.lambda_residual = best.e;
  result.branch = inflectional(best.s) ? Branch::kInflectional : Branch::kPlain;
  result.moved = {best.s.l1 - input.l1, best.s.l2 - input.l2};
  result.angle_constraints_hold = angle_constraints(input);
  result.status = best.e <= threshold ? ProjectStatus::kReached : ProjectStatus::kNotReached;
  return result;
}

}  // namespace hotblade::elastica

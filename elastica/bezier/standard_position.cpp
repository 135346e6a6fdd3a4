#include "elastica/bezier/standard_position.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "elastica/bezier/lambda_residual.hpp"

namespace hotblade::elastica {

namespace {

using Complex = std::complex<double>;

Complex complex(const Eigen::Vector2d& p) {
  return {p.x(), p.y()};
}

}  // namespace

double wrapped(double angle) {
  const double a = std::remainder(angle, 2 * std::numbers::pi);
  return a <= -std::numbers::pi ? std::numbers::pi : a;
}

std::optional<StandardPosition> standard_position(const Bezier& b) {
  const Complex chord = complex(b[3]) - complex(b[0]);
  const Complex e1 = complex(b[1]) - complex(b[0]), e2 = complex(b[2]) - complex(b[3]);
  if (std::abs(chord) == 0 || std::abs(e1) == 0 || std::abs(e2) == 0) return std::nullopt;
  return StandardPosition{wrapped(std::arg(e1 / chord)), wrapped(std::arg(e2 / chord)), std::abs(e1 / chord),
                          std::abs(e2 / chord)};
}

Bezier to_bezier(const StandardPosition& s) {
  const Complex p1 = std::polar(s.l1, s.a1), p2 = 1.0 + std::polar(s.l2, s.a2);
  return {Eigen::Vector2d(0, 0), {p1.real(), p1.imag()}, {p2.real(), p2.imag()}, {1, 0}};
}

Bezier with_edges(const Bezier& b, const StandardPosition& input, const StandardPosition& s) {
  // Only lengths change: the end tangents keep their direction to the last bit of the multiplication, and an
  // edge that stays keeps its point.
  const auto moved = [](const Eigen::Vector2d& end, const Eigen::Vector2d& inner, double was, double is) {
    return is == was ? inner : Eigen::Vector2d(end + (inner - end) * (is / was));
  };
  return {b[0], moved(b[0], b[1], input.l1, s.l1), moved(b[3], b[2], input.l2, s.l2), b[3]};
}

bool inflectional(const StandardPosition& s) {
  const Complex p1 = std::polar(s.l1, s.a1), p2 = 1.0 + std::polar(s.l2, s.a2);
  const auto cross = [](Complex a, Complex b) { return (std::conj(a) * b).imag(); };
  return cross(p1, p2 - p1) * cross(p2 - p1, 1.0 - p2) < 0;
}

std::optional<std::array<double, 2>> edge_meeting(const StandardPosition& s) {
  const double d = std::sin(s.a2 - s.a1);
  if (d == 0) return std::nullopt;
  // u e(a1) = 1 + v e(a2)
  return std::array<double, 2>{std::sin(s.a2) / d, std::sin(s.a1) / d};
}

bool edges_cross(const StandardPosition& s) {
  const auto meeting = edge_meeting(s);
  return meeting && (*meeting)[0] > 0 && (*meeting)[1] > 0 && (*meeting)[0] <= s.l1 && (*meeting)[1] <= s.l2;
}

StandardPosition uncrossed(StandardPosition s) {
  if (!edges_cross(s)) return s;
  // Shortened to this share of the way to the crossing.
  constexpr double kUncross = 0.98;
  const auto meeting = *edge_meeting(s);
  s.l1 = std::min(s.l1, kUncross * meeting[0]);
  s.l2 = std::min(s.l2, kUncross * meeting[1]);
  return s;
}

bool angle_constraints_hold(const StandardPosition& s, const AngleConstraints& constraints) {
  const auto positive = [](double a) { return a < 0 ? a + 2 * std::numbers::pi : a; };
  const double b1 = positive(wrapped(std::numbers::pi - s.a1)), b2 = positive(s.a2);
  const auto inside = [&constraints](double b) {
    return b > constraints.from_chord && b < 2 * std::numbers::pi - constraints.from_chord;
  };
  return inside(b1) && inside(b2) && std::abs(b1 - b2) < constraints.difference;
}

double score(const StandardPosition& s) {
  const LambdaResidual r = lambda_residual(to_bezier(s));
  return has_value(r.status) ? r.value : 1.0;
}

}  // namespace hotblade::elastica

#include "elastica/curve/features.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "elastica/curve/closed_form.hpp"

namespace hotblade::elastica {

namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

// A root of f between a and b, where it changes sign, to rounding.
template <typename F>
double bisected(const F& f, double a, double b) {
  const bool rising = f(a) <= 0;
  for (int i = 0; i < 80; ++i) {
    const double m = 0.5 * (a + b);
    if (m <= a || m >= b) break;
    ((f(m) <= 0) == rising ? a : b) = m;
  }
  return 0.5 * (a + b);
}

// Arc lengths in [0, length] at which rate s + phase = first + j step, ascending.
std::vector<double> at_arguments(const Shape& shape, double length, double first, double step) {
  const double a = shape.phase, b = shape.rate * length + shape.phase;
  // What rounding of the phase can move, so that a segment cut at a feature has it at its end.
  const double slack = 16 * kEpsilon * (std::abs(a) + std::abs(b) + std::abs(first) + step);
  const double from = std::ceil((std::min(a, b) - slack - first) / step);
  const double to = std::floor((std::max(a, b) + slack - first) / step);
  std::vector<double> found;
  if (!(to >= from)) return found;
  if (!(to - from < static_cast<double>(kMaxFeatures)))
    throw std::logic_error("elastica: too many periods to list");
  for (double j = from; j <= to; ++j) {
    found.push_back(std::clamp((first + j * step - shape.phase) / shape.rate, 0.0, length));
  }
  std::sort(found.begin(), found.end());
  return found;
}

bool straight(const Elastica& e) {
  const double axis = std::atan2(e.lambda2, e.lambda1);
  const bool unloaded = e.lambda1 == 0 && e.lambda2 == 0;
  return e.kappa == 0 && (unloaded || std::sin(e.theta - axis) == 0);
}

// A curve too short for a closed form turns by less than 0.6 rad and has at most one inflection: between two,
// kappa'' =
// -|lambda| cos(psi) kappa needs pi / sqrt|lambda|.
std::vector<double> inflection_of_piece(const Elastica& e) {
  const ElasticaCurve curve(e);
  const auto kappa = [&](double s) { return curve.at(s).kappa; };
  if (kappa(0) == 0) return {0};
  if ((kappa(0) > 0) == (kappa(e.length) > 0)) return {};
  return {bisected(kappa, 0, e.length)};
}

// Between its inflection and its ends the direction is monotone, so each part meets the axis, kappa' = 0,
// once at most.
std::vector<double> vertices_of_piece(const Elastica& e) {
  const ElasticaCurve curve(e);
  const auto slope = [&](double s) {
    const double theta = curve.at(s).theta;
    return e.lambda2 * std::cos(theta) - e.lambda1 * std::sin(theta);
  };
  std::vector<double> found, ends{0};
  for (const double s : inflection_of_piece(e)) ends.push_back(s);
  ends.push_back(e.length);
  if (slope(0) == 0) found.push_back(0);
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    const double a = slope(ends[i]), b = slope(ends[i + 1]);
    if (a * b < 0) found.push_back(bisected(slope, ends[i], ends[i + 1]));
  }
  return found;
}

// The distances d in (0, reach] at which the curve meets itself about the vertex at arc length c: where c + d
// and c - d are at one place along the axis. Between the arc lengths of `turning`, where the tangent is
// square to the axis, the difference is monotone.
class Meetings {
 public:
  Meetings(const ClosedForm& curve, std::vector<double> turning)
      : curve_(curve), turning_(std::move(turning)) {
    axis_ = {std::cos(curve.shape().axis), std::sin(curve.shape().axis)};
  }

  void about(double c, double reach, std::vector<Crossing>& found) const {
    const auto apart = [&](double d) {
      return axis_.dot(curve_.at(c + d).position() - curve_.at(c - d).position());
    };
    double a = 0;
    auto next = std::upper_bound(turning_.begin(), turning_.end(), c);
    while (a < reach) {
      const double b = next == turning_.end() ? reach : std::min(reach, *next++ - c);
      // At a = 0 the difference is 0 and nothing has been met.
      if (a > 0 && apart(a) * apart(b) <= 0) add(c, bisected(apart, a, b), found);
      a = b;
    }
  }

 private:
  void add(double c, double d, std::vector<Crossing>& found) const {
    // The tangents are mirror images of each other: alike, or opposite, along the axis and across it.
    constexpr double kTouching = 1e-9;
    const double psi = curve_.at(c + d).theta - curve_.shape().axis;
    if (std::abs(std::sin(2 * psi)) < kTouching) return;
    if (found.size() >= kMaxFeatures) throw std::logic_error("elastica: too many self-intersections to list");
    found.push_back({c - d, c + d});
  }

  const ClosedForm& curve_;
  std::vector<double> turning_;
  Eigen::Vector2d axis_;
};

// Where the tangent is square to the axis: half direction pi/4, that is am(v) = pi/4 when winding, k sn v =
// sin(pi/4) with inflections.
std::vector<double> square_to_axis(const ClosedForm& curve, double length) {
  const Shape& shape = curve.shape();
  const std::optional<double> v = curve.argument_square_to_axis();
  if (!v) return {};
  const double step = 2 * curve.quarter_argument();
  std::vector<double> found = at_arguments(shape, length, *v, step);
  const std::vector<double> mirrored = at_arguments(shape, length, -*v, step);
  found.insert(found.end(), mirrored.begin(), mirrored.end());
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace

std::vector<double> inflections(const Elastica& e) {
  if (straight(e)) return {};
  const auto closed = ClosedForm::of(e);
  if (!closed) return inflection_of_piece(e);
  const Shape& shape = closed->shape();
  if (shape.regime != Regime::kInflectional || shape.modulus == 0) return {};
  return at_arguments(shape, e.length, shape.quarter_period, 2 * shape.quarter_period);
}

std::vector<double> vertices(const Elastica& e) {
  if (straight(e) || (e.lambda1 == 0 && e.lambda2 == 0)) return {};
  const auto closed = ClosedForm::of(e);
  if (!closed) return vertices_of_piece(e);
  const double step = closed->quarter_argument() * (closed->shape().regime == Regime::kWinding ? 1 : 2);
  return at_arguments(closed->shape(), e.length, 0, step);
}

std::optional<double> curvature_period(const Elastica& e) {
  if (straight(e) || (e.lambda1 == 0 && e.lambda2 == 0)) return std::nullopt;
  Elastica longer = e;
  // Long enough to have a closed form; its period does not depend on where it ends.
  longer.length = std::max(e.length, 1 / taylor_rate(e.theta, e.kappa, e.lambda1, e.lambda2));
  const double period = ClosedForm::of(longer)->period();
  return std::isfinite(period) ? std::optional(period) : std::nullopt;
}

std::vector<Crossing> self_intersections(const Elastica& e) {
  // Without its place, which would cost digits.
  Elastica at_origin = e;
  at_origin.x = at_origin.y = 0;
  const auto closed = ClosedForm::of(at_origin);
  std::vector<Crossing> found;
  if (!closed) return found;
  const Meetings meetings(*closed, square_to_axis(*closed, e.length));
  for (const double c : vertices(at_origin)) meetings.about(c, std::min(c, e.length - c), found);
  return found;
}

std::vector<Elastica> split(const Elastica& e, std::span<const double> at) {
  std::vector<Elastica> pieces;
  double from = 0;
  for (const double s : at) {
    if (!(s > from && s < e.length))
      throw std::logic_error("split: arc lengths must ascend within (0, length)");
    pieces.push_back(segment(e, from, s));
    from = s;
  }
  pieces.push_back(segment(e, from, e.length));
  return pieces;
}

Elastica transformed(const Elastica& e, const Similarity& map) {
  if (!(map.scale > 0)) throw std::logic_error("similarity: scale must be above 0");
  const double sign = map.mirrored ? -1 : 1, c = std::cos(map.rotation), s = std::sin(map.rotation);
  const double y = sign * e.y;
  // kappa' = -lambda1 sin(theta) + lambda2 cos(theta): mirrored, theta and kappa change sign, so lambda1
  // keeps its own and lambda2 changes; turned, the pair turns along.
  const double l1 = e.lambda1, l2 = sign * e.lambda2, area = map.scale * map.scale;
  return {map.scale * (c * e.x - s * y) + map.dx,
          map.scale * (s * e.x + c * y) + map.dy,
          sign * e.theta + map.rotation,
          sign * e.kappa / map.scale,
          (c * l1 - s * l2) / area,
          (s * l1 + c * l2) / area,
          map.scale * e.length};
}

}  // namespace hotblade::elastica

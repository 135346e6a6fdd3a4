#include "pipeline/study/quadratic_oracle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace hotblade::pipeline::study {

namespace {

using Eigen::Vector2d;
using elastica::Objective;
using elastica::Quadratic;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

__extension__ typedef __float128 Quad;

Vector2d in_square(CurveRandom& random) {
  const double x = random.between(-1, 1);
  return {x, random.between(-1, 1)};
}

// 1/sqrt(a) for a > 0, from 16 to 32 to 34 digits.
Quad inverse_root(Quad a) {
  Quad r = 1 / std::sqrt(static_cast<double>(a));
  for (int i = 0; i < 2; ++i) r *= (3 - a * r * r) / 2;
  return r;
}

// Gauss-Legendre on [-1, 1]: on a panel whose half width is a third of the distance to the singularities the
// error is 5.8^-44 = 1e-33.
struct Gauss {
  static constexpr int kCount = 22;
  std::array<Quad, kCount> x, w;
  Gauss() {
    for (std::size_t i = 0; i < kCount; ++i) {
      Quad z = std::cos(std::numbers::pi * (static_cast<double>(i) + 0.75) / (kCount + 0.5)), slope = 1;
      for (int step = 0; step < 6; ++step) {  // Newton's method on the Legendre polynomial
        Quad p = 1, before = 0;
        for (int j = 0; j < kCount; ++j) {
          const Quad next = ((2 * j + 1) * z * p - j * before) / (j + 1);
          before = p;
          p = next;
        }
        slope = kCount * (z * p - before) / (z * z - 1);
        z -= p / slope;
      }
      x[i] = z;
      w[i] = 2 / ((1 - z * z) * slope * slope);
    }
  }
};

// Int v dt and Int v^-5 dt for half the speed v, v^2 = n2 + d2 (t - t0)^2, where t0 is the parameter of least
// speed.
struct SpeedIntegrals {
  Quad n2, d2, length = 0, inverse_fifth = 0;

  void add_panel(Quad a, Quad b) {
    static const Gauss gauss;
    const Quad middle = (a + b) / 2, half = (b - a) / 2;
    for (std::size_t i = 0; i < Gauss::kCount; ++i) {
      const Quad t = middle + half * gauss.x[i], v2 = n2 + d2 * t * t, r = inverse_root(v2), r2 = r * r;
      length += half * gauss.w[i] * v2 * r;
      inverse_fifth += half * gauss.w[i] * r2 * r2 * r;
    }
  }
  // From a >= 0 to b, both from t0 on, in panels as wide as their distance from the singularities at t0 +- i
  // h.
  void add(Quad a, Quad b, Quad h) {
    while (true) {
      const Quad end = a + (a > h ? a : h);
      if (!(end < b)) break;
      add_panel(a, end);
      a = end;
    }
    add_panel(a, b);
  }
};

// Local minima of the objective over consecutive points; a point that is not finite ends a component.
void collect(const TangentProblem& problem, const std::vector<Vector2d>& b1, bool closed,
             std::vector<SampledMinimum>& found) {
  const std::size_t n = b1.size();
  std::vector<double> f(n);
  for (std::size_t i = 0; i < n; ++i) f[i] = b1[i].allFinite() ? problem.value(b1[i]) : kNaN;
  for (std::size_t i = 0; i < n; ++i) {
    if (!closed && (i == 0 || i + 1 == n)) continue;
    const std::size_t before = (i + n - 1) % n, after = (i + 1) % n;
    if (!(f[i] < f[before] && f[i] <= f[after])) continue;
    found.push_back({b1[i], f[i], (b1[i] - b1[before]).norm() + (b1[i] - b1[after]).norm()});
  }
}

// A line of middle control points, dense about `at`; never `at` itself, which may be an end point.
std::vector<Vector2d> along(const Vector2d& at, const Vector2d& direction, double chord, int samples) {
  std::vector<Vector2d> points;
  const int even = samples + samples % 2;
  for (int i = 0; i < even; ++i)
    points.emplace_back(at + chord / 10 * std::sinh(12 * ((2.0 * i + 1) / even - 1)) * direction);
  return points;
}

bool on_circle(const TangentProblem& p, const Vector2d& end) {
  return p.circle && std::abs((end - p.place).norm() - p.radius) < 1e-12 * p.radius;
}

}  // namespace

Quadratic random_triangle(std::uint64_t seed, std::uint64_t index) {
  CurveRandom random(seed, index);
  const Vector2d b0 = in_square(random), b2 = in_square(random), any = in_square(random);
  const double tiny = std::pow(10, random.between(-12, 0)), share = random.between(-1, 2);
  switch (index % kTriangleKinds.size()) {
    case 0:
      return {b0, any, b2};
    case 1: {
      const double first = std::pow(10, random.between(-5, 4)), last = std::pow(10, random.between(-5, 4));
      return {0.01 * b0, first * any, last * b2};
    }
    case 2:
      return {b0, b0 + share * (b2 - b0) + tiny * any, b2};
    case 3:
      return {b0, 0.5 * (b0 + b2) + tiny * any, b2};
    default:
      return {b0, b0 + tiny * any, b2};
  }
}

QuadraticIntegrals quadrature(const Quadratic& q) {
  const Quad ux = Quad(q[1].x()) - q[0].x(), uy = Quad(q[1].y()) - q[0].y();
  const Quad dx = Quad(q[2].x()) - q[1].x() - ux, dy = Quad(q[2].y()) - q[1].y() - uy;
  const Quad d2 = dx * dx + dy * dy, cross = ux * dy - uy * dx;
  const Quad n2 = cross * cross / d2, h2 = n2 / d2, h = h2 * inverse_root(h2);
  const Quad from = (ux * dx + uy * dy) / d2, to = from + 1;  // t - t0 at the ends
  SpeedIntegrals sum{n2, d2};
  if (from < 0 && to > 0) {
    sum.add(0, -from, h);
    sum.add(0, to, h);
  } else {
    sum.add(from < 0 ? -to : from, from < 0 ? -from : to, h);
  }
  return {static_cast<double>(2 * sum.length), static_cast<double>(cross * cross * sum.inverse_fifth / 4)};
}

elastica::TangentCurves TangentProblem::solve() const {
  return circle ? tangent_to_circle(b0, b2, place, radius, objective)
                : tangent_to_line(b0, b2, place, direction, objective);
}

double TangentProblem::value(const Vector2d& b1) const {
  return objective == Objective::kLength ? elastica::length({b0, b1, b2}) : elastica::energy({b0, b1, b2});
}

TangentProblem random_problem(std::uint64_t seed, std::uint64_t index) {
  CurveRandom random(seed, index);
  const std::size_t kinds = kTangentKinds.size(), kind = index % kinds;
  TangentProblem p;
  p.objective = index / kinds % 2 == 0 ? Objective::kLength : Objective::kEnergy;
  p.circle = kind > 0;
  p.place = in_square(random);
  if (!p.circle) {
    p.direction = in_square(random);
    const Vector2d up{-p.direction.y(), p.direction.x()};
    for (Vector2d* end : {&p.b0, &p.b2}) {
      *end = p.place + random.between(-2, 2) * p.direction;
      *end += random.between(0, 2) * up;
    }
    return p;
  }
  p.radius = random.between(0.05, 1.05);
  enum Where { kOutside, kOn, kInside };
  constexpr Where kEnds[6][2] = {{kOutside, kOutside}, {kOutside, kInside}, {kOutside, kOn},
                                 {kInside, kInside},   {kOn, kInside},      {kOn, kOn}};
  const auto end = [&](Where where) {
    const double angle = random.between(-std::numbers::pi, std::numbers::pi), q = random.unit();
    const double outside = 1 + 3 * q * q, inside = std::sqrt(q);
    const double r = p.radius * (where == kOutside ? outside : where == kInside ? inside : 1);
    return Vector2d{p.place + r * Vector2d(std::cos(angle), std::sin(angle))};
  };
  p.b0 = end(kEnds[kind - 1][0]);
  p.b2 = end(kEnds[kind - 1][1]);
  if (random.unit() < 0.5) std::swap(p.b0, p.b2);
  return p;
}

Vector2d locus(const TangentProblem& p, double theta) {
  const Vector2d n{std::cos(theta), std::sin(theta)}, contact = p.place + p.radius * n;
  const double d0 = (contact - p.b0).dot(n), d2 = (contact - p.b2).dot(n);
  if (!(d0 * d2 > 0)) return {kNaN, kNaN};
  return contact + 0.5 * (std::sqrt(d2 / d0) * (contact - p.b0) + std::sqrt(d0 / d2) * (contact - p.b2));
}

std::vector<SampledMinimum> sampled_minima(const TangentProblem& p, int samples) {
  std::vector<SampledMinimum> found;
  const double chord = (p.b2 - p.b0).norm();
  if (!p.circle) {  // proposition 4.1
    const Vector2d u = p.direction.normalized(), v{-u.y(), u.x()};
    const double a = v.dot(p.b0 - p.place), c = v.dot(p.b2 - p.place);
    const Vector2d below = -std::copysign(std::sqrt(a * c), a) * v;
    const Vector2d middle = p.place + u.dot(0.5 * (p.b0 + p.b2) - p.place) * u;
    collect(p, along(middle + below, u, chord, samples), false, found);
    return found;
  }
  // Next to an end on the circle equation 6 loses its digits, and past it b1 jumps: no samples there.
  const double cut = 7.0 / samples;
  std::vector<Vector2d> b1;
  for (int i = 0; i < samples; ++i) {
    const double theta = 2 * std::numbers::pi * (i + 0.5) / samples;
    b1.push_back(locus(p, theta));
    for (const Vector2d& end : {p.b0, p.b2}) {
      const double angle = std::atan2(end.y() - p.place.y(), end.x() - p.place.x());
      if (on_circle(p, end) && std::abs(std::remainder(angle - theta, 2 * std::numbers::pi)) < cut)
        b1.back() = {kNaN, kNaN};
    }
  }
  collect(p, b1, true, found);
  if (p.objective == Objective::kLength) return found;  // on an end's tangent its least value is the chord
  for (const Vector2d& end : {p.b0, p.b2}) {
    const Vector2d r = (end - p.place) / p.radius;
    if (on_circle(p, end)) collect(p, along(end, {-r.y(), r.x()}, chord, samples), false, found);
  }
  return found;
}

double tangency_error(const TangentProblem& p, const elastica::TangentMinimum& m) {
  const Vector2d at = elastica::point_at(m.curve, m.contact_t), first = m.curve[1] - m.curve[0],
                 last = m.curve[2] - m.curve[1];
  const Vector2d velocity = (1 - m.contact_t) * first + m.contact_t * last;
  const Vector2d line_normal = Vector2d(-p.direction.y(), p.direction.x()).normalized();
  const Vector2d normal = p.circle ? Vector2d((at - p.place).normalized()) : line_normal;
  const double off = p.circle ? (at - p.place).norm() - p.radius : normal.dot(at - p.place);
  const double size = first.norm() + last.norm() + p.radius;
  return std::max({std::abs(off), std::abs(normal.dot(velocity)), (at - m.contact).norm()}) / size;
}

}  // namespace hotblade::pipeline::study

#include "elastica/quadratic/quadratic.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "elastica/kernels/quadratic.h"

namespace hotblade::elastica {

namespace {

using Eigen::Vector2d;

hb_quadratic_edges edges(const Quadratic& q) {
  return hb_quadratic_edges_of(q[0].x(), q[0].y(), q[1].x(), q[1].y(), q[2].x(), q[2].y());
}

// The root in [lo, hi] of an increasing function that is negative at lo and positive at hi: Anderson and
// Bjorck's regula falsi, a bisection when an end stays.
template <typename F>
double rising_root(double lo, double f_lo, double hi, double f_hi, double small, const F& f) {
  constexpr int kMost = 100;  // twice what bisection needs for the bits of a double
  int side = 0;               // of the last step, when the other end stayed
  for (int i = 0; i < kMost && hi - lo > 1e-15 * hi; ++i) {
    double x = (lo * f_hi - hi * f_lo) / (f_hi - f_lo);
    if (!(x > lo && x < hi) || i % 8 == 7) x = 0.5 * (lo + hi);
    const double y = f(x);
    if (std::abs(y) <= small) return x;
    const double m = 1 - y / (y > 0 ? f_hi : f_lo), shrink = m > 0 ? m : 0.5;
    if (y > 0) {
      hi = x;
      f_hi = y;
      if (side > 0) f_lo *= shrink;
      side = 1;
    } else {
      lo = x;
      f_lo = y;
      if (side < 0) f_hi *= shrink;
      side = -1;
    }
  }
  return 0.5 * (lo + hi);
}

// The distance from the midpoint along a direction at which `value` of the middle control point there,
// increasing, reaches `level`; it is at least `scale` small.
template <typename F>
double reach(double scale, double level, const F& value) {
  double lo = 0, f_lo = value(0.0) - level;
  double hi = scale, f_hi = value(hi) - level;
  while (f_hi < 0) {
    lo = hi;
    f_lo = f_hi;
    hi *= 2;
    f_hi = value(hi) - level;
  }
  while (!std::isfinite(f_hi) || f_hi > 4 * level) {  // far up a pole regula falsi is slow: come near first
    const double middle = 0.5 * (lo + hi), f = value(middle) - level;
    if (hi - lo <= 1e-15 * hi) return middle;
    (f < 0 ? lo : hi) = middle;
    (f < 0 ? f_lo : f_hi) = f;
  }
  return rising_root(lo, f_lo, hi, f_hi, 4e-15 * level, [&](double x) { return value(x) - level; });
}

void check_level(const Vector2d& b0, const Vector2d& b2, double level, int n) {
  const double chord = (b2 - b0).norm();
  if (!(chord > 0) || !std::isfinite(chord) || !std::isfinite(level) || n < 3) {
    throw std::logic_error("level set needs distinct finite ends, a finite value and at least 3 points");
  }
}

}  // namespace

Vector2d point_at(const Quadratic& q, double t) {
  const double s = 1 - t;
  return s * s * q[0] + 2 * s * t * q[1] + t * t * q[2];
}

double length(const Quadratic& curve) {
  return hb_quadratic_length(edges(curve));
}

double length_to(const Quadratic& curve, double t) {
  return hb_quadratic_length_to(edges(curve), std::clamp(t, 0.0, 1.0));
}

double parameter_at(const Quadratic& curve, double s) {
  return hb_quadratic_parameter_at(edges(curve), s);
}

double energy(const Quadratic& curve) {
  return hb_quadratic_energy(edges(curve));
}

Parabola parabola(const Quadratic& q) {
  const hb_parabola p = hb_quadratic_parabola(q[0].x(), q[0].y(), q[1].x(), q[1].y(), q[2].x(), q[2].y());
  return {{p.origin_x, p.origin_y},
          {p.axis_x, p.axis_y},
          p.scale,
          p.x0,
          p.x1,
          static_cast<ParabolaStatus>(p.degenerate)};
}

QuadraticNearest nearest(const Quadratic& q, const Vector2d& query) {
  const hb_quadratic_nearest_point p =
      hb_quadratic_nearest(q[0].x(), q[0].y(), q[1].x(), q[1].y(), q[2].x(), q[2].y(), query.x(), query.y());
  return {p.t, {p.x, p.y}, std::sqrt(p.distance_sq)};
}

std::vector<Vector2d> length_level_set(const Vector2d& b0, const Vector2d& b2, double level, int n) {
  check_level(b0, b2, level, n);
  const double chord = (b2 - b0).norm();
  if (!(level > chord)) return {};
  const Vector2d middle = 0.5 * (b0 + b2), along = (b2 - b0) / chord, across{-along.y(), along.x()};
  // b1 is at most half the length from the midpoint plus half the chord: |b0 b1| + |b1 b2| <= 2 length.
  const double wide = level, high = std::sqrt((level - chord) * (level + chord));
  std::vector<Vector2d> points;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * std::numbers::pi * i / n;
    const Vector2d direction = wide * std::cos(a) * along + high * std::sin(a) * across;
    const double r = reach(1.0, level, [&](double x) { return length({b0, middle + x * direction, b2}); });
    points.push_back(middle + r * direction);
  }
  return points;
}

std::vector<Vector2d> energy_level_set(const Vector2d& b0, const Vector2d& b2, double level, int n) {
  check_level(b0, b2, level, n);
  if (!(level > 0)) return {};
  const Vector2d middle = 0.5 * (b0 + b2), half = 0.5 * (b2 - b0), across{-half.y(), half.x()};
  std::vector<Vector2d> points;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * std::numbers::pi * i / n;
    if (2 * i % n == 0) {  // on the chord's line the energy jumps from 0 to infinity at the ends
      points.push_back(i == 0 ? b2 : b0);
      continue;
    }
    const Vector2d direction = std::cos(a) * half + std::sin(a) * across;
    const double r = reach(1.0, level, [&](double x) { return energy({b0, middle + x * direction, b2}); });
    points.push_back(middle + r * direction);
  }
  return points;
}

}  // namespace hotblade::elastica

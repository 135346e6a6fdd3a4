// Random cubics of every kind that a lambda-residual meets, near-cusps among them.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <vector>

#include "elastica/bezier/bezier.hpp"

namespace hotblade::elastica {

class RandomCubics {
 public:
  explicit RandomCubics(unsigned seed) : random_(seed) {}

  // One of ten is a loop about to become a cusp, or past it: its derivative is 1e-6 to 1 somewhere inside.
  Bezier next() {
    switch (count_++ % 10) {
      case 0:
        return near_cusp();
      case 1:
        return flattened(near_cusp());
      case 2:
        return flattened(anything());
      case 3:
        return tiny_handles();
      case 4:
        return near_points();
      case 5:
        return raised_quadratic();
      case 6:
        return near_arc();
      case 7:
        return ordinary();
      case 8:
        return far_away();
      default:
        return anything();
    }
  }

  // Like a rib's: a chord, handles of a third of it, bent by up to 30 degrees or so.
  Bezier ordinary() {
    const double a = 0.06 * u(), b = 0.06 * u(), c = 0.2 * u();
    return {Eigen::Vector2d(0, 0), {1.0 / 3 + a, c}, {2.0 / 3 + b, 0.2 * u()}, {1, 0}};
  }

  // Control points anywhere in a square.
  Bezier anything() {
    Bezier b;
    for (Eigen::Vector2d& p : b) p = point();
    return b;
  }

  // The derivative at a random t is as small as 1e-6.
  Bezier near_cusp() {
    Bezier b = anything();
    const double t = 0.5 + 0.5 * u(), o = 1 - t, size = small(6);
    const std::array<double, 4> by{-o * o, o * o - 2 * o * t, 2 * o * t - t * t, t * t};
    std::size_t most = 1;
    for (std::size_t i = 2; i < 4; ++i) most = std::abs(by[i]) > std::abs(by[most]) ? i : most;
    Eigen::Vector2d sum = size / 3 * direction();
    for (std::size_t i = 0; i < 4; ++i) {
      if (i != most) sum -= by[i] * b[i];
    }
    b[most] = sum / by[most];
    return b;
  }

 private:
  double u() { return uniform_(random_); }
  // 10^-digits to 1, evenly in the logarithm.
  double small(double digits) { return std::pow(10, -digits * (0.5 + 0.5 * u())); }
  Eigen::Vector2d point() {
    const double x = u();
    return {x, u()};
  }
  Eigen::Vector2d direction() {
    const double angle = std::numbers::pi * u();
    return {std::cos(angle), std::sin(angle)};
  }

  Bezier flattened(Bezier b) {
    const double flat = small(5);
    const Eigen::Vector2d along = direction(), across(-along.y(), along.x());
    for (Eigen::Vector2d& p : b) p = (p.x() * along + flat * p.y() * across).eval();
    return b;
  }

  Bezier tiny_handles() {
    Bezier b = anything();
    b[1] = b[0] + small(6) * direction();
    if (u() > 0) b[2] = b[3] + small(6) * direction();
    return b;
  }

  // Two control points are one, or nearly.
  Bezier near_points() {
    Bezier b = anything();
    const std::size_t i = random_() % 4, j = (i + 1 + random_() % 3) % 4;
    b[i] = b[j];
    if (u() > 0) b[i] += small(6) * point();
    return b;
  }

  Bezier raised_quadratic() {
    const Eigen::Vector2d p = point(), q = point(), r = point();
    const double off = small(12);
    return {p, (p + 2 * q) / 3 + off * point(), (2 * q + r) / 3 + off * point(), r};
  }

  Bezier near_arc() {
    const double a = 0.7 + 0.6 * u(), h = 4.0 / 3 * std::tan(a / 4), c = std::cos(a), s = std::sin(a);
    Bezier b{Eigen::Vector2d(1, 0), {1, h}, {c + h * s, s - h * c}, {c, s}};
    const double off = 0.1 * small(8);
    for (Eigen::Vector2d& p : b) p += off * point();
    return b;
  }

  // One control point, or none, is far from the others; all are, in the end, from the origin.
  Bezier far_away() {
    Bezier b = anything();
    b[random_() % 4] *= 1 / small(4);
    const Eigen::Vector2d at = 100 * point();
    for (Eigen::Vector2d& p : b) p += at;
    return b;
  }

  std::mt19937_64 random_;
  std::uniform_real_distribution<double> uniform_{-1, 1};
  std::size_t count_ = 0;
};

}  // namespace hotblade::elastica

// Length and energy of quadratic Beziers by quadrature in 34 digits, and triangles of every kind to try them
// on.
#pragma once

#include <cmath>
#include <numbers>
#include <random>

#include "elastica/quadratic/quadratic.hpp"

namespace hotblade::elastica {

struct QuadraticIntegrals {
  double length = 0, energy = 0;
};

namespace quadrature {

__extension__ typedef __float128 Quad;

inline Quad root(Quad a) {
  if (!(a > 0)) return 0;
  Quad r = std::sqrt(static_cast<double>(a));
  for (int i = 0; i < 2; ++i) r = (r + a / r) / 2;  // 16, 32, 64 digits
  return r;
}

// Nodes and weights of 24-point Gauss quadrature on [-1, 1], by Newton's method on the Legendre polynomial.
struct Gauss {
  static constexpr int kCount = 24;
  Quad x[kCount], w[kCount];
  Gauss() {
    for (int i = 0; i < kCount; ++i) {
      Quad z = std::cos(std::numbers::pi * (i + 0.75) / (kCount + 0.5)), slope = 1;
      for (int step = 0; step < 6; ++step) {
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

struct Sums {
  Quad length = 0, inverse_fifth = 0;
};

// Int w du and Int w^-5 du over [a, b], w^2 = u^2 + h^2.
inline void add(Sums& sums, Quad a, Quad b, Quad h2) {
  static const Gauss gauss;
  for (int i = 0; i < Gauss::kCount; ++i) {
    const Quad u = (a + b) / 2 + (b - a) / 2 * gauss.x[i], w2 = u * u + h2, w = root(w2);
    sums.length += (b - a) / 2 * gauss.w[i] * w;
    sums.inverse_fifth += (b - a) / 2 * gauss.w[i] / (w2 * w2 * w);
  }
}

// From 0 to u > 0 in panels that double, so that the singularities +-ih are never nearer than three half
// widths.
inline Sums from_zero(Quad u, Quad h, Quad h2) {
  Sums sums;
  Quad a = 0, b = h;
  for (int i = 0; b < u && i < 200; ++i) {
    add(sums, a, b, h2);
    a = b;
    b *= 2;
  }
  add(sums, a, u, h2);
  return sums;
}

}  // namespace quadrature

// The exact integrals of the curve whose control points are these doubles, rounded to double.
inline QuadraticIntegrals integrate(const Quadratic& q) {
  using namespace quadrature;
  const Quad d0x = Quad(q[1].x()) - q[0].x(), d0y = Quad(q[1].y()) - q[0].y();
  const Quad d1x = Quad(q[2].x()) - q[1].x(), d1y = Quad(q[2].y()) - q[1].y();
  const Quad dx = d1x - d0x, dy = d1y - d0y, a = dx * dx + dy * dy, g = root(a);
  const Quad cross = d0x * d1y - d0y * d1x, h2 = cross * cross / (a * a), h = root(h2);
  const Quad u0 = (d0x * dx + d0y * dy) / a, u1 = u0 + 1;
  Sums sums;
  if (u0 < 0 && u1 > 0) {
    const Sums left = from_zero(-u0, h, h2), right = from_zero(u1, h, h2);
    sums = {left.length + right.length, left.inverse_fifth + right.inverse_fifth};
  } else {
    Quad from = u0 < 0 ? -u1 : u0;
    const Quad to = from + 1;
    for (int i = 0; i < 200; ++i) {  // panels no longer than their distance from the singularities
      const Quad end = from + (from + h);
      if (!(end < to)) break;
      add(sums, from, end, h2);
      from = end;
    }
    add(sums, from, to, h2);
  }
  return {static_cast<double>(2 * g * sums.length), static_cast<double>(h2 / (4 * g) * sums.inverse_fifth)};
}

// Triangles by turns: uniform in a square; with edges of sizes log-uniform over nine decades; nearly
// collinear, in order or folded, by angles down to 1e-12; nearly uniform parametrisations; a middle point
// next to an end.
class TriangleSource {
 public:
  explicit TriangleSource(unsigned seed) : random_(seed) {}
  Quadratic next() {
    const int kind = turn_++ % 5;
    const Eigen::Vector2d b0 = vector(), b2 = vector();
    const double tiny = std::pow(10, -12 * u01_(random_));
    switch (kind) {
      case 0:
        return {b0, vector(), b2};
      case 1:
        return {1e-2 * b0, std::pow(10, 9 * u01_(random_) - 5) * vector(),
                std::pow(10, 9 * u01_(random_) - 5) * b2};
      case 2:
        return {b0, b0 + (3 * u01_(random_) - 1) * (b2 - b0) + tiny * vector(), b2};
      case 3:
        return {b0, 0.5 * (b0 + b2) + tiny * vector(), b2};
      default:
        return {b0, b0 + tiny * vector(), b2};
    }
  }

 private:
  Eigen::Vector2d vector() { return {2 * u01_(random_) - 1, 2 * u01_(random_) - 1}; }
  std::mt19937_64 random_;
  std::uniform_real_distribution<double> u01_;
  int turn_ = 0;
};

}  // namespace hotblade::elastica

// Eight elasticas at a time, as pure shapes: length 1, run through in both senses from their middle, which
// lies at the origin with tangent (1, 0). A shape is the triple z = (K, T1, T2) of curvature and tensions at
// the middle, made pure numbers by the length:
//   kappa = K - T1 y + T2 x,   theta'' = -T1 sin theta + T2 cos theta.
// Internal to the fits: always inlined, so that each instruction set gets its own copy (fit_lanes.cpp).
#pragma once

#include <cstddef>

#include "elastica/kernels/lanes.hpp"

namespace hotblade::elastica::lanes {

// The order of the Taylor step between two nodes. When omega times the step is at most kMostOmegaStep, the
// truncated tail is below (omega h / 2.8)^11 of a step (taylor.hpp): 1e-6 at the limit, where a search may
// pass through, and 2e-11 at kFineOmegaStep, which results keep to.
inline constexpr int kStepOrder = 10;
inline constexpr double kMostOmegaStep = 0.8, kFineOmegaStep = 0.3;

// The shapes at nodes 0 .. steps (even), evenly spaced by arc length, and their derivatives by z.
struct ShapeNodes {
  explicit ShapeNodes(int step_count)
      : steps(step_count), storage(13 * (static_cast<std::size_t>(step_count) + 1)) {
    x = column(0);
    y = column(1);
    c = column(2);
    s = column(3);
    for (std::size_t k = 0; k < 3; ++k) {
      dtheta[k] = column(4 + k);
      dx[k] = column(7 + k);
      dy[k] = column(10 + k);
    }
  }
  ShapeNodes(const ShapeNodes&) = delete;
  ShapeNodes& operator=(const ShapeNodes&) = delete;

  int steps;
  Column storage;
  Lanes *x, *y, *c, *s;  // positions, cos and sin of theta
  Lanes *dtheta[3], *dx[3], *dy[3];

 private:
  Lanes* column(std::size_t i) { return &storage[i * (static_cast<std::size_t>(steps) + 1)].v; }
};

// Taylor coefficients about a node in units of the step h: cos and sin of theta.
struct StepSeries {
  Lanes c[kStepOrder + 1], s[kStepOrder + 1];
};

// kh = h kappa, t1 = h^2 T1, t2 = h^2 T2.
HOTBLADE_INLINE void expand_step(const Lanes& c0, const Lanes& s0, const Lanes& kh, const Lanes& t1,
                                 const Lanes& t2, StepSeries& out) {
  Lanes rate[kStepOrder + 1];  // (j + 1) times the coefficient j + 1 of theta
  out.c[0] = c0;
  out.s[0] = s0;
  rate[0] = kh;
#pragma GCC unroll 16
  for (int k = 0; k < kStepOrder; ++k) {
    rate[k + 1] = (t2 * out.c[k] - t1 * out.s[k]) * (1.0 / (k + 1));
    Lanes dc = rate[0] * out.s[k], ds = rate[0] * out.c[k];
#pragma GCC unroll 16
    for (int j = 1; j <= k; ++j) {
      dc += rate[j] * out.s[k - j];
      ds += rate[j] * out.c[k - j];
    }
    out.c[k + 1] = dc * (-1.0 / (k + 1));
    out.s[k + 1] = ds * (1.0 / (k + 1));
  }
}

// Nodes on one side of the middle; dir = +1 or -1.
HOTBLADE_INLINE void trace_side(const Lanes* z, int dir, ShapeNodes& out) {
  const int middle = out.steps / 2;
  const double h = dir / static_cast<double>(out.steps);
  const Lanes t1 = z[1] * (h * h), t2 = z[2] * (h * h);
  Lanes x = z[0] * 0.0, y = x, c = x + 1.0, s = x;
  out.x[middle] = x;
  out.y[middle] = y;
  out.c[middle] = c;
  out.s[middle] = s;
  for (int i = 1; i <= middle; ++i) {
    StepSeries q;
    expand_step(c, s, (z[0] - z[1] * y + z[2] * x) * h, t1, t2, q);
    Lanes sx = q.c[kStepOrder] * (1.0 / (kStepOrder + 1)), sy = q.s[kStepOrder] * (1.0 / (kStepOrder + 1));
    c = q.c[kStepOrder];
    s = q.s[kStepOrder];
#pragma GCC unroll 16
    for (int k = kStepOrder - 1; k >= 0; --k) {
      sx += q.c[k] * (1.0 / (k + 1));
      sy += q.s[k] * (1.0 / (k + 1));
      c += q.c[k];
      s += q.s[k];
    }
    x += sx * h;
    y += sy * h;
    const int n = middle + dir * i;
    out.x[n] = x;
    out.y[n] = y;
    out.c[n] = c;
    out.s[n] = s;
  }
}

// Derivatives of theta at the nodes next to the middle, by the series of the variational equation
//   dtheta'' = -(T1 cos theta + T2 sin theta) dtheta + (0, -sin theta, cos theta).
HOTBLADE_INLINE void start_derivatives(const Lanes* z, ShapeNodes& out) {
  constexpr int kOrder = 8;  // beyond the order of the recurrence that goes on from here
  const double h = 1.0 / out.steps;
  const Lanes t1 = z[1] * (h * h), t2 = z[2] * (h * h), zero = z[0] * 0.0;
  StepSeries q;
  expand_step(zero + 1.0, zero, z[0] * h, t1, t2, q);
  const int m = out.steps / 2;
#pragma GCC unroll 3
  for (int column = 0; column < 3; ++column) {
    Lanes a[kOrder + 3];
    a[0] = zero;
    a[1] = column == 0 ? zero + h : zero;
    Lanes even = zero, odd = a[1];
#pragma GCC unroll 16
    for (int k = 0; k <= kOrder; ++k) {
      Lanes sum = column == 0 ? zero : column == 1 ? q.s[k] * (-h * h) : q.c[k] * (h * h);
#pragma GCC unroll 16
      for (int j = 0; j <= k; ++j) sum -= (t1 * q.c[j] + t2 * q.s[j]) * a[k - j];
      a[k + 2] = sum * (1.0 / ((k + 1) * (k + 2)));
      (k % 2 == 0 ? even : odd) += a[k + 2];
    }
    out.dtheta[column][m] = zero;
    out.dtheta[column][m + 1] = even + odd;
    out.dtheta[column][m - 1] = even - odd;
  }
}

// Numerov's recurrence for the derivatives of theta, outwards on one side. Its relative error, of order
// (omega h)^4 / 240, bends the descent directions only: residuals and costs never see it.
HOTBLADE_INLINE void derivatives_of_angle(const Lanes* z, int dir, ShapeNodes& out) {
  const double h2 = 1.0 / (static_cast<double>(out.steps) * out.steps);
  const int middle = out.steps / 2;
  const Lanes t1 = z[1] * (h2 / 12), t2 = z[2] * (h2 / 12);
  const auto w = [&](int n) __attribute__((always_inline)) {
    return t1 * out.c[n] + t2 * out.s[n];
  };
  Lanes w0 = w(middle), w1 = w(middle + dir);
  for (int i = 2; i <= middle; ++i) {
    const int n = middle + dir * i, p = n - dir, o = p - dir;
    const Lanes w2 = w(n), share = 1.0 / (1.0 + w2), back = 1.0 + w0, mid = 2.0 - 10.0 * w1;
    const Lanes g1 = (out.s[n] + 10.0 * out.s[p] + out.s[o]) * (-h2 / 12);
    const Lanes g2 = (out.c[n] + 10.0 * out.c[p] + out.c[o]) * (h2 / 12);
    const auto next = [&](const Lanes* d) __attribute__((always_inline)) {
      return mid * d[p] - back * d[o];
    };
    out.dtheta[0][n] = next(out.dtheta[0]) * share;
    out.dtheta[1][n] = (next(out.dtheta[1]) + g1) * share;
    out.dtheta[2][n] = (next(out.dtheta[2]) + g2) * share;
    w0 = w1;
    w1 = w2;
  }
}

// Derivatives of the positions: d(x + i y) = Int i exp(i theta) dtheta ds, by cubics through four nodes.
HOTBLADE_INLINE void derivatives_of_position(int dir, ShapeNodes& out) {
  const int middle = out.steps / 2;
  const double h = dir / (24.0 * out.steps);
#pragma GCC unroll 3
  for (int k = 0; k < 3; ++k) {
    const Lanes* d = out.dtheta[k];
    const auto fx = [&](int n) __attribute__((always_inline)) {
      return -out.s[n] * d[n];
    };
    const auto fy = [&](int n) __attribute__((always_inline)) {
      return out.c[n] * d[n];
    };
    Lanes x = d[middle] * 0.0, y = x;
    out.dx[k][middle] = x;
    out.dy[k][middle] = y;
    Lanes x0 = fx(middle - dir), y0 = fy(middle - dir), x1 = fx(middle), y1 = fy(middle);
    Lanes x2 = fx(middle + dir), y2 = fy(middle + dir);
    for (int i = 1; i < middle; ++i) {
      const int n = middle + dir * i;
      const Lanes x3 = fx(n + dir), y3 = fy(n + dir);
      x += (13.0 * (x1 + x2) - (x0 + x3)) * h;
      y += (13.0 * (y1 + y2) - (y0 + y3)) * h;
      out.dx[k][n] = x;
      out.dy[k][n] = y;
      x0 = x1, x1 = x2, x2 = x3;
      y0 = y1, y1 = y2, y2 = y3;
    }
    const int n = middle + dir * middle;
    const Lanes xb = fx(n - 3 * dir), yb = fy(n - 3 * dir);
    out.dx[k][n] = x + (xb - 5.0 * x0 + 19.0 * x1 + 9.0 * x2) * h;
    out.dy[k][n] = y + (yb - 5.0 * y0 + 19.0 * y1 + 9.0 * y2) * h;
  }
}

// All nodes of the shapes z[0..2] = (K, T1, T2), with derivatives.
HOTBLADE_INLINE void trace(const Lanes* z, ShapeNodes& out) {
  trace_side(z, 1, out);
  trace_side(z, -1, out);
  start_derivatives(z, out);
  for (const int dir : {1, -1}) {
    derivatives_of_angle(z, dir, out);
    derivatives_of_position(dir, out);
  }
}

// trace() on the widest vectors the processor has.
void trace_all(const Lanes* z, ShapeNodes& out);

}  // namespace hotblade::elastica::lanes

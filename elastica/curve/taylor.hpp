// Taylor expansion of an elastica about a point, for any scalar type (double, or a dual number for
// derivatives).
//
// theta'' = -lambda1 sin(theta) + lambda2 cos(theta) is the pendulum equation, so the coefficients of theta,
// cos(theta) and sin(theta) follow from one recurrence. The nearest complex singularity lies at
// least 2.8/omega away, omega^2 = kappa_max^2 + |lambda| (poles of the Jacobi functions; the worst case is a
// curve that winds fast), so a piece of length kStepOmega/omega at order 18 is exact to (0.6/2.8)^19 = 2e-13
// of a piece at worst, and to rounding for curves whose turning a blade can take.
#pragma once

#include <cmath>

namespace hotblade::elastica {

inline constexpr int kTaylorOrder = 18;
inline constexpr double kStepOmega = 0.6;

template <typename T>
struct TaylorPiece {
  T c[kTaylorOrder + 1];  // cos(theta)
  T s[kTaylorOrder + 1];  // sin(theta)
  T t[kTaylorOrder + 2];  // theta
};

template <typename T>
struct TaylorPoint {
  T x, y, theta, kappa;
};

// The largest rate omega of the curve: no Taylor piece may be longer than kStepOmega / omega.
inline double taylor_rate(double theta, double kappa, double lambda1, double lambda2) {
  const double lambda = std::hypot(lambda1, lambda2);
  const double along = lambda1 * std::cos(theta) + lambda2 * std::sin(theta);
  // kappa^2/2 - (lambda1 cos + lambda2 sin) is constant along the curve, so this bounds kappa.
  return std::sqrt(kappa * kappa + 2 * (lambda - along) + lambda);
}

// The expansion about a point with this tangent direction and curvature.
template <typename T>
TaylorPiece<T> expand(const T& theta, const T& kappa, const T& lambda1, const T& lambda2) {
  using std::cos;
  using std::sin;
  TaylorPiece<T> p;
  p.t[0] = theta;
  p.t[1] = kappa;
  p.c[0] = cos(theta);
  p.s[0] = sin(theta);
  for (int k = 0; k < kTaylorOrder; ++k) {
    p.t[k + 2] = (lambda2 * p.c[k] - lambda1 * p.s[k]) / double((k + 1) * (k + 2));
    T dc = T(0.0), ds = T(0.0);
    for (int j = 0; j <= k; ++j) {
      const T rate = double(j + 1) * p.t[j + 1];
      dc -= rate * p.s[k - j];
      ds += rate * p.c[k - j];
    }
    p.c[k + 1] = dc / double(k + 1);
    p.s[k + 1] = ds / double(k + 1);
  }
  return p;
}

// The point at arc length h from the piece's centre, which lies at (0, 0).
template <typename T>
TaylorPoint<T> evaluate(const TaylorPiece<T>& p, double h) {
  T x = T(0.0), y = T(0.0), theta = T(0.0), kappa = T(0.0);
  for (int k = kTaylorOrder; k >= 0; --k) {
    x = x * h + p.c[k] / double(k + 1);
    y = y * h + p.s[k] / double(k + 1);
    theta = theta * h + p.t[k];
    if (k > 0) kappa = kappa * h + double(k) * p.t[k];
  }
  return {x * h, y * h, theta, kappa};
}

}  // namespace hotblade::elastica

#include "elastica/stability.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "elastica/end_map.hpp"

namespace hotblade::elastica {

namespace {

constexpr int kCells = 128;
constexpr int kInner = kCells - 1;

struct Discrete {
  Eigen::Array<double, kInner, 1> diagonal;      // of H times length^2; off-diagonal is -1/h^2
  Eigen::Matrix<double, kInner, 2> constraints;  // orthonormal columns
  int rank = 0;
};

Discrete discretise(const Elastica& e) {
  const ElasticaCurve curve(e);
  const double h = 1.0 / kCells;
  Discrete d;
  const double middle = curve.at(0.5 * e.length).theta;
  for (int i = 0; i < kInner; ++i) {
    const double theta = curve.at(e.length * (i + 1) * h).theta;
    d.diagonal[i] =
        2 / (h * h) - (e.lambda1 * std::cos(theta) + e.lambda2 * std::sin(theta)) * e.length * e.length;
    d.constraints(i, 0) = std::cos(theta - middle);
    d.constraints(i, 1) = std::sin(theta - middle);
  }
  // On a straight blade the second constraint is empty: the end point cannot move along the chord to first
  // order.
  constexpr double kEmpty = 1e-7;
  d.constraints.col(0).normalize();
  const double size = std::sqrt(static_cast<double>(kInner));
  d.constraints.col(1) -= d.constraints.col(0) * d.constraints.col(0).dot(d.constraints.col(1));
  const double rest = d.constraints.col(1).norm();
  d.rank = rest > kEmpty * size ? 2 : 1;
  if (d.rank == 2) d.constraints.col(1) /= rest;
  return d;
}

// Number of eigenvalues of the constrained problem below sigma: inertia of the tridiagonal H - sigma bordered
// by the constraints, by Sturm's sequence and the 2 x 2 Schur complement (Haynsworth's additivity).
int eigenvalues_below(const Discrete& d, double sigma) {
  const double off = -static_cast<double>(kCells) * kCells;
  std::array<double, kInner> pivot;
  int negative = 0;
  Eigen::Matrix<double, kInner, 2> x = d.constraints;
  for (std::size_t i = 0; i < kInner; ++i) {
    pivot[i] = d.diagonal[static_cast<Eigen::Index>(i)] - sigma;
    if (i > 0) {
      const double factor = off / pivot[i - 1];
      pivot[i] -= factor * off;
      x.row(static_cast<Eigen::Index>(i)) -= factor * x.row(static_cast<Eigen::Index>(i) - 1);
    }
    // An exact zero pivot is moved by rounding's own size: sigma is then an eigenvalue of a leading block.
    if (pivot[i] == 0) pivot[i] = -off * 1e-16;
    if (pivot[i] < 0) ++negative;
  }
  // Schur complement -C^T (H - sigma)^-1 C = -X^T D^-1 X with X = L^-1 C.
  Eigen::Matrix2d schur = Eigen::Matrix2d::Zero();
  for (std::size_t i = 0; i < kInner; ++i) {
    const auto row = x.row(static_cast<Eigen::Index>(i));
    schur -= row.transpose() * row / pivot[i];
  }
  int schur_negative = 0;
  if (d.rank == 2) {
    const double trace = schur.trace(), det = schur.determinant();
    schur_negative = det < 0 ? 1 : trace < 0 ? 2 : 0;
  } else {
    schur_negative = schur(0, 0) < 0 ? 1 : 0;
  }
  return negative + schur_negative - d.rank;
}

}  // namespace

double stability_margin(const Elastica& e) {
  return stability_margin(e, std::numeric_limits<double>::quiet_NaN());
}

double stability_margin(const Elastica& e, double nearby) {
  if (!(e.length > 0)) return 0;
  const Discrete d = discretise(e);
  const double load = std::hypot(e.lambda1, e.lambda2) * e.length * e.length;
  // The free operator's eigenvalues lie above -load; with two constraints the smallest is at most the third
  // of the unloaded clamped string, 9 pi^2, plus the load.
  double low = -load - 1, high = 100 + load;
  if (std::isfinite(nearby)) {
    // Neighbouring waypoints differ by less, mostly.
    const double reach = 1e-3 * (1 + std::abs(nearby));
    for (const double at : {nearby - reach, nearby + reach}) {
      if (at > low && at < high) (eigenvalues_below(d, at) > 0 ? high : low) = at;
    }
  }
  constexpr double kRelative = 1e-6;
  while (high - low > kRelative * (1 + std::abs(high) + std::abs(low))) {
    const double middle = 0.5 * (low + high);
    (eigenvalues_below(d, middle) > 0 ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

std::optional<double> first_conjugate_point(const Elastica& elastica, double furthest) {
  if (!(furthest > 0)) return std::nullopt;
  Elastica start = elastica;
  start.length = furthest;
  // The index only grows along the curve, and of the fields at the pieces' ends the first with one is near
  // the place.
  double stable = 0, unstable = 0;
  for (const JacobiFields& f : jacobi_fields(start)) {
    if (f.index > 0) {
      unstable = f.s;
      break;
    }
    stable = f.s;
  }
  if (unstable == 0) return std::nullopt;
  constexpr double kExact = 1e-9;
  while (unstable - stable > kExact * furthest) {
    start.length = 0.5 * (stable + unstable);
    (end_map(start).index > 0 ? unstable : stable) = start.length;
  }
  return 0.5 * (stable + unstable);
}

}  // namespace hotblade::elastica

#include "elastica/bezier/bezier.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "elastica/linear/cross.hpp"
#include "elastica/linear/solve.hpp"

namespace hotblade::elastica {

namespace {

// 5-point Gauss-Legendre on [0, 1].
constexpr std::array<double, 5> kNode{0.046910077030668004, 0.23076534494715845, 0.5, 0.76923465505284155,
                                      0.95308992296933200};
constexpr std::array<double, 5> kWeight{0.11846344252809454, 0.23931433524968324, 0.28444444444444444,
                                        0.23931433524968324, 0.11846344252809454};

std::array<double, 4> bernstein(double t) {
  const double u = 1 - t;
  return {u * u * u, 3 * u * u * t, 3 * u * t * t, t * t * t};
}

// Inner control points by linear least squares for given parameters.
void solve_inner(std::span<const Eigen::Vector2d> q, const std::vector<double>& t, Bezier& b) {
  Eigen::Matrix2d a = Eigen::Matrix2d::Zero();
  Eigen::Matrix2d r = Eigen::Matrix2d::Zero();
  for (std::size_t i = 0; i < q.size(); ++i) {
    const auto w = bernstein(t[i]);
    const Eigen::Vector2d rest = q[i] - w[0] * b[0] - w[3] * b[3];
    const Eigen::Vector2d basis(w[1], w[2]);
    a += basis * basis.transpose();
    r += basis * rest.transpose();
  }
  const Eigen::Matrix2d x = a.ldlt().solve(r);
  b[1] = x.row(0);
  b[2] = x.row(1);
}

// Squared distances across the curve, foot points held: how the inner control points change their sum, to
// second order (Gauss-Newton).
struct Across {
  Eigen::Matrix4d a = Eigen::Matrix4d::Zero();
  Eigen::Vector4d r = Eigen::Vector4d::Zero();

  Across(std::span<const Eigen::Vector2d> q, const std::vector<double>& t, const Bezier& b) {
    for (std::size_t i = 0; i < q.size(); ++i) {
      const BezierPoint p = evaluate(b, t[i]);
      const double speed = p.d1.norm();
      if (!(speed > 0)) continue;
      const Eigen::Vector2d normal(-p.d1.y() / speed, p.d1.x() / speed);
      const auto w = bernstein(t[i]);
      const Eigen::Vector4d row(w[1] * normal.x(), w[1] * normal.y(), w[2] * normal.x(), w[2] * normal.y());
      a += row * row.transpose();
      r += row * normal.dot(q[i] - p.p);
    }
  }
  // On a flat rib sliding along the line changes hardly anything: the damping, a share of the trace, keeps
  // the control points near to where they are.
  [[nodiscard]] Eigen::Vector4d step(double damping) const {
    Eigen::Matrix4d damped = a;
    damped.diagonal().array() += damping * a.trace();
    return solve_symmetric(damped, r);
  }
};

// One Newton step of the foot point, kept inside [0, 1].
double closer_parameter(const Bezier& b, const Eigen::Vector2d& q, double t) {
  const BezierPoint e = evaluate(b, t);
  const Eigen::Vector2d r = e.p - q;
  const double f = r.dot(e.d1), df = e.d1.squaredNorm() + r.dot(e.d2);
  if (!(df > 0)) return t;
  return std::clamp(t - f / df, 0.0, 1.0);
}

// Moves the parameters to the points' feet, as far as two steps do, the ends' left; returns the sum of
// squared distances.
double project(std::span<const Eigen::Vector2d> q, const Bezier& b, std::vector<double>& t) {
  double sum = 0;
  for (std::size_t i = 1; i + 1 < q.size(); ++i) {
    for (int k = 0; k < 2; ++k) t[i] = closer_parameter(b, q[i], t[i]);
    sum += (evaluate(b, t[i]).p - q[i]).squaredNorm();
  }
  return sum;
}

}  // namespace

BezierPoint evaluate(const Bezier& b, double t) {
  const double u = 1 - t;
  const auto w = bernstein(t);
  return {w[0] * b[0] + w[1] * b[1] + w[2] * b[2] + w[3] * b[3],
          3 * (u * u * (b[1] - b[0]) + 2 * u * t * (b[2] - b[1]) + t * t * (b[3] - b[2])),
          6 * (u * (b[2] - 2 * b[1] + b[0]) + t * (b[3] - 2 * b[2] + b[1]))};
}

double curvature(const BezierPoint& p) {
  const double speed = p.d1.norm();
  return speed > 0 ? cross(p.d1, p.d2) / (speed * speed * speed) : 0;
}

std::vector<double> arc_lengths(const Bezier& b, int n) {
  std::vector<double> s(static_cast<std::size_t>(n) + 1, 0.0);
  for (int i = 0; i < n; ++i) {
    double sum = 0;
    for (std::size_t g = 0; g < kNode.size(); ++g)
      sum += kWeight[g] * evaluate(b, (i + kNode[g]) / n).d1.norm();
    s[static_cast<std::size_t>(i) + 1] = s[static_cast<std::size_t>(i)] + sum / n;
  }
  return s;
}

std::vector<double> even_parameters(const Bezier& b, int n) {
  if (n < 2) throw std::logic_error("even_parameters needs at least 2 points");
  const int cells = 128;
  const std::vector<double> s = arc_lengths(b, cells);
  std::vector<double> t(static_cast<std::size_t>(n));
  std::size_t cell = 0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    const double want = s.back() * static_cast<double>(i) / static_cast<double>(n - 1);
    while (cell + 2 < s.size() && s[cell + 1] < want) ++cell;
    const double width = s[cell + 1] - s[cell];
    double x = (static_cast<double>(cell) + (width > 0 ? (want - s[cell]) / width : 0)) / cells;
    // Two Newton steps on the arc length inside the cell, by Gauss quadrature from the cell's start.
    const double t0 = static_cast<double>(cell) / cells;
    for (int k = 0; k < 2; ++k) {
      double length = 0;
      for (std::size_t g = 0; g < kNode.size(); ++g) {
        length += kWeight[g] * evaluate(b, t0 + (x - t0) * kNode[g]).d1.norm();
      }
      const double speed = evaluate(b, x).d1.norm();
      if (speed > 0) x = std::clamp(x - ((x - t0) * length - (want - s[cell])) / speed, 0.0, 1.0);
    }
    t[i] = x;
  }
  return t;
}

BezierFit fit_bezier(std::span<const Eigen::Vector2d> q) {
  if (q.size() < 4 || (q.front() - q.back()).norm() <= 0) {
    throw std::logic_error("fit_bezier needs at least 4 points and distinct ends");
  }
  std::vector<double> t(q.size(), 0.0);
  for (std::size_t i = 1; i < q.size(); ++i) t[i] = t[i - 1] + (q[i] - q[i - 1]).norm();
  for (double& v : t) v /= t.back();
  BezierFit fit;
  fit.bezier = {q.front(), q.front(), q.back(), q.back()};
  constexpr int kAlternating = 4, kNewton = 12;
  double sum = 0;
  for (int round = 0; round < kAlternating; ++round) {
    solve_inner(q, t, fit.bezier);
    sum = project(q, fit.bezier, t);
  }
  // Converges quadratically where alternating creeps: on ribs of up to a half turn these settle to rounding.
  constexpr double kLeastDamping = 1e-9, kMostDamping = 1, kSettled = 1e-12;
  double damping = kLeastDamping;
  for (int round = 0; round < kNewton && damping < kMostDamping; ++round) {
    const Eigen::Vector4d step = Across(q, t, fit.bezier).step(damping);
    Bezier next = fit.bezier;
    next[1] += step.head<2>();
    next[2] += step.tail<2>();
    std::vector<double> at = t;
    const double other = project(q, next, at);
    if (!(other < sum)) {
      if (step.norm() <= kSettled * (q.back() - q.front()).norm()) break;
      damping *= 100;
      continue;
    }
    damping = std::max(kLeastDamping, 0.1 * damping);
    const bool settled = sum - other <= kSettled * sum;
    fit.bezier = next;
    t = std::move(at);
    sum = other;
    if (settled) break;
  }
  for (std::size_t i = 0; i < q.size(); ++i)
    fit.max = std::max(fit.max, (evaluate(fit.bezier, t[i]).p - q[i]).norm());
  fit.rms = std::sqrt(sum / static_cast<double>(q.size()));
  return fit;
}

}  // namespace hotblade::elastica

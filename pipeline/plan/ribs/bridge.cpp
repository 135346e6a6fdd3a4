#include "pipeline/plan/ribs/bridge.hpp"

#include <Eigen/Dense>
#include <algorithm>

#include "elastica/linear/solve.hpp"

namespace hotblade::pipeline {

namespace {

using Eigen::Vector2d;

constexpr int kSideSamples = 32;
constexpr int kFillSamples = 63;
constexpr int kCoefficients = 5;
// Of the gap's width on either side.
constexpr double kSideShare = 0.5;
// Pull of the n-th coefficient to zero is this times 3^n, n >= 1: facets of a short piece would swing it.
constexpr double kPull = 1e-3;

// The gap's chord as the interval from (0, 0) to (1, 0).
struct GapFrame {
  Vector2d origin, x;  // x as long as the gap

  [[nodiscard]] Vector2d in(const Vector2d& q) const {
    const Vector2d d = (q - origin) / x.squaredNorm();
    return {x.dot(d), x.x() * d.y() - x.y() * d.x()};
  }
  [[nodiscard]] Vector2d out(const Vector2d& u) const {
    return origin + u.x() * x + u.y() * Vector2d(-x.y(), x.x());
  }
};

using Row = Eigen::Matrix<double, 1, kCoefficients>;

// Chebyshev polynomials over [-1, 2] times u (u - 1): zero at both ends of the gap.
Row basis(double u) {
  const double t = (2 * u - 1) / 3, square = t * t;
  Row row;
  row << 1, t, 2 * square - 1, t * (4 * square - 3), 8 * square * (square - 1) + 1;
  return u * (u - 1) * row;
}

// Points spread evenly over the first `reach` of a piece that starts at the gap, without its start.
std::vector<Vector2d> beside(std::span<const Vector2d> piece, double reach) {
  double length = 0;
  for (std::size_t i = 1; i < piece.size(); ++i) length += (piece[i] - piece[i - 1]).norm();
  const double step = std::min(reach, length) / kSideSamples;
  std::vector<Vector2d> points;
  double passed = 0;
  for (std::size_t i = 1; i < piece.size() && points.size() < kSideSamples; ++i) {
    const Vector2d edge = piece[i] - piece[i - 1];
    const double edge_length = edge.norm();
    const bool last = i + 1 == piece.size();
    while (points.size() < kSideSamples) {
      const double at = step * static_cast<double>(points.size() + 1) - passed;
      if (at > edge_length && !last) break;
      points.push_back(piece[i - 1] + std::min(1.0, at / edge_length) * edge);
    }
    passed += edge_length;
  }
  return points;
}

bool rises(const std::vector<Vector2d>& points) {
  return std::is_sorted(points.begin(), points.end(),
                        [](const Vector2d& a, const Vector2d& b) { return a.x() <= b.x(); });
}

}  // namespace

std::optional<std::vector<Vector2d>> fill_gap(std::span<const Vector2d> before,
                                              std::span<const Vector2d> after) {
  const GapFrame frame{before.back(), after.front() - before.back()};
  const double width = frame.x.norm();
  if (!(width > 0)) return std::vector<Vector2d>{};
  const std::vector<Vector2d> back(before.rbegin(), before.rend());
  std::vector<Vector2d> left = beside(back, kSideShare * width), right = beside(after, kSideShare * width);
  std::reverse(left.begin(), left.end());
  std::vector<Vector2d> known;
  for (const auto& side : {left, right}) {
    for (const Vector2d& q : side) known.push_back(frame.in(q));
  }
  if (!rises(known)) return std::nullopt;
  const auto count = static_cast<Eigen::Index>(known.size());
  Eigen::Matrix<double, Eigen::Dynamic, kCoefficients> a(count + kCoefficients, kCoefficients);
  Eigen::VectorXd y = Eigen::VectorXd::Zero(a.rows());
  for (Eigen::Index i = 0; i < count; ++i) {
    a.row(i) = basis(known[static_cast<std::size_t>(i)].x());
    y[i] = known[static_cast<std::size_t>(i)].y();
  }
  a.bottomRows<kCoefficients>().setZero();
  double pull = kPull;
  for (int n = 1; n < kCoefficients; ++n) a(count + n, n) = pull *= 3;
  const Eigen::Matrix<double, kCoefficients, 1> c = elastica::shortest_solution(a, y);
  std::vector<Vector2d> fill;
  for (int k = 1; k <= kFillSamples; ++k) {
    const double u = static_cast<double>(k) / (kFillSamples + 1);
    fill.push_back(frame.out({u, basis(u).dot(c)}));
  }
  return fill;
}

}  // namespace hotblade::pipeline

#include "elastica/sensitivity.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "elastica/end_map.hpp"
#include "elastica/stability.hpp"

namespace hotblade::elastica {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d frame(double theta) {
  Matrix3d m = Matrix3d::Identity();
  m(0, 0) = m(1, 1) = std::cos(theta);
  m(1, 0) = std::sin(theta);
  m(0, 1) = -m(1, 0);
  return m;
}

// Where displacements are looked at: a maximum between two places is missed by a thousandth.
constexpr int kPlaces = 64;

// What a rigid move (dx, dy, dtheta) about `a` does to the point p, in (x, y, theta).
Vector3d carried(const Vector3d& move, const ClampPose& a, const CurvePoint& p) {
  return {move[0] - move[2] * (p.y - a.y), move[1] + move[2] * (p.x - a.x), move[2]};
}

}  // namespace

Sensitivity sensitivity(const Elastica& e, const SensitivityOptions& options) {
  const std::vector<JacobiFields> fields = jacobi_fields(e, kPlaces);
  const JacobiFields& end = fields.back();
  const ClampPose a{e.x, e.y, e.theta};
  const auto solver = end.fields.partialPivLu();
  Sensitivity result;
  for (std::size_t i = 0; i < 6; ++i) {
    const bool at_a = i < 3;
    Vector3d error = Vector3d::Zero();
    error[static_cast<Eigen::Index>(i % 3)] =
        i % 3 == 2 ? options.angle_error_rad : options.position_error_mm;
    error = frame(at_a ? e.theta : end.point.theta) * error;
    // An error of A carries the blade along; what is then amiss at B is bent back.
    const Vector3d move = at_a ? error : Vector3d::Zero();
    const Vector3d amiss = at_a ? Vector3d(-carried(move, a, end.point)) : error;
    const Vector3d change = solver.solve(amiss);
    double largest = error.head<2>().norm() * (at_a ? 1 : 0);
    for (const JacobiFields& f : fields) {
      largest = std::max(largest, (carried(move, a, f.point) + f.fields * change).head<2>().norm());
    }
    result.displacement_mm[i] = std::isfinite(largest) ? largest : std::numeric_limits<double>::infinity();
    result.total_mm += result.displacement_mm[i];
  }
  return result;
}

namespace {

// Errors of clamp B in the axes of A, a turn in mm: the way to the fold of one shape.
class FoldSearch {
 public:
  FoldSearch(const Elastica& e, const ClampMarginOptions& options)
      : e_(e),
        held_(clamps_of(e)),
        weight_(1, 1, options.mm_per_rad > 0 ? options.mm_per_rad : 0.5 * e.length) {
    best_.margin_mm = options.largest_mm;
  }

  [[nodiscard]] const ClampMargin& best() const { return best_; }

  // Walks up to the best margin so far. When the shape is lost before, that is the new best, and the nearest
  // point of the fold's tangent plane shows the next direction.
  void look(Vector3d direction) {
    constexpr int kMostTurns = 6;
    for (int turn = 0; turn < kMostTurns && direction.norm() > 0; ++turn) {
      const Vector3d error = best_.margin_mm * direction.normalized();
      FollowOptions walk;
      walk.smallest_step = 1e-4;  // of the way: as exact as a margin needs to be
      const FollowReport way = follow(e_, erring(error), walk);
      if (way.status != FollowStatus::kSnapped) return;
      best_.margin_mm *= way.fraction;
      const Vector3d lost = way.fraction * error;
      for (Eigen::Index i = 0; i < 3; ++i) best_.error[static_cast<std::size_t>(i)] = lost[i] / weight_[i];
      direction = normal_at(way.shape.elastica);
      if (direction.dot(lost) < 0) direction = -direction;
    }
  }

  // Direction in which the smallest eigenvalue falls fastest, by central differences.
  [[nodiscard]] Vector3d steepest() const {
    const double step = 1e-4 * e_.length;
    Vector3d slope = Vector3d::Zero();
    for (Eigen::Index i = 0; i < 3; ++i) {
      const auto high = solve_clamped(e_, erring(step * Vector3d::Unit(i)));
      const auto low = solve_clamped(e_, erring(-step * Vector3d::Unit(i)));
      if (high && low) slope[i] = stability_margin(high->elastica) - stability_margin(low->elastica);
    }
    return -slope;
  }

  // The direction that the end fields reach least: at a fold, its normal.
  [[nodiscard]] Vector3d normal_at(const Elastica& e) const {
    const Matrix3d fields = weight_.asDiagonal() * frame(e_.theta).transpose() * end_map(e).fields;
    const double l3 = e.length * e.length * e.length;
    const Vector3d per_unknown(1 / e.length, 1 / l3, 1 / l3);
    const Eigen::JacobiSVD<Matrix3d> svd(fields * per_unknown.asDiagonal(), Eigen::ComputeFullU);
    return svd.matrixU().col(2);
  }

 private:
  [[nodiscard]] ClampPair erring(const Vector3d& error) const {
    const Vector3d move = frame(e_.theta) * error.cwiseQuotient(weight_);
    return {held_.a, {held_.b.x + move[0], held_.b.y + move[1], held_.b.theta + move[2]}};
  }

  Elastica e_;
  ClampPair held_;
  Vector3d weight_;
  ClampMargin best_;
};

}  // namespace

ClampMargin clamp_margin(const Elastica& e, const ClampMarginOptions& options) {
  if (!(options.largest_mm > 0) || !(options.mm_per_rad >= 0)) {
    throw std::logic_error("a clamp's largest error must be positive, the weight of a turn not negative");
  }
  if (end_map(e).index != 0) return {};
  FoldSearch search(e, options);
  const Vector3d steepest = search.steepest(), weakest = search.normal_at(e);
  for (const Vector3d& direction : {steepest, weakest, Vector3d(-weakest)}) search.look(direction);
  for (Eigen::Index i = 0; i < 3; ++i) {
    for (const double sign : {1.0, -1.0}) search.look(sign * Vector3d::Unit(i));
  }
  return search.best();
}

}  // namespace hotblade::elastica

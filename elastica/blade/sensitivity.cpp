#include "elastica/blade/sensitivity.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "elastica/blade/end_map.hpp"

namespace hotblade::elastica {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
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
Vector3d carried(const Vector3d& move, const PlanarPose& a, const CurvePoint& p) {
  return {move[0] - move[2] * (p.y - a.y), move[1] + move[2] * (p.x - a.x), move[2]};
}

}  // namespace

Sensitivity sensitivity(const Elastica& e, const SensitivityOptions& options) {
  const std::vector<JacobiFields> fields = jacobi_fields(e, kPlaces);
  const JacobiFields& end = fields.back();
  const PlanarPose a{e.x, e.y, e.theta};
  const auto solver = end.fields.partialPivLu();
  Sensitivity result;
  std::vector<double> across(fields.size(), 0);
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
    for (std::size_t k = 0; k < fields.size(); ++k) {
      const JacobiFields& f = fields[k];
      const Vector2d moved = (carried(move, a, f.point) + f.fields * change).head<2>();
      largest = std::max(largest, moved.norm());
      across[k] += std::abs(std::cos(f.point.theta) * moved.y() - std::sin(f.point.theta) * moved.x());
    }
    result.displacement_mm[i] = std::isfinite(largest) ? largest : std::numeric_limits<double>::infinity();
  }
  // A part between two places is as far off as the farther of the two around it.
  for (std::size_t k = 0; k < fields.size(); ++k) {
    const double before = k > 0 ? fields[k - 1].s : 0,
                 behind = k + 1 < fields.size() ? fields[k + 1].s : fields[k].s;
    if (behind < options.from_mm || before > options.to_mm) continue;
    result.total_mm = std::max(
        result.total_mm, std::isfinite(across[k]) ? across[k] : std::numeric_limits<double>::infinity());
  }
  return result;
}

double straight_bow(double length, double slack) {
  // y = bow (1 - cos(2 pi s / length)) / 2 is longer than its chord by (pi bow)^2 / (4 length).
  return 2 / std::numbers::pi * std::sqrt(std::max(0.0, slack) * length);
}

double straight_response_mm(double length, double slack, bool keeps_side, const SensitivityOptions& options) {
  const double along = 2 * options.position_error_mm, across = options.position_error_mm;
  const double bow = straight_bow(length, slack), pushed = straight_bow(length, slack + along);
  const double pulled = straight_bow(length, slack - along);
  const double bowed = keeps_side ? std::max(pushed - bow, bow - pulled) : pushed + bow;
  // A clamp's turn lifts a strip held at both ends by s (1 - s/length)^2 at most.
  constexpr double kTurned = 4.0 / 27;
  return bowed + across + 2 * kTurned * length * options.angle_error_rad;
}

}  // namespace hotblade::elastica

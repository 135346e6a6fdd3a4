#include <algorithm>
#include <cmath>

#include "elastica/blade/clamp_margin.hpp"

namespace hotblade::elastica {

namespace {

using Eigen::Rotation2Dd, Eigen::Vector2d;

}  // namespace

double clamp_distance(const ClampPair& a, const ClampPair& b, double mm_per_rad) {
  const Vector2d p = Rotation2Dd(-a.a.theta) * Vector2d(a.b.x - a.a.x, a.b.y - a.a.y);
  const Vector2d q = Rotation2Dd(-b.a.theta) * Vector2d(b.b.x - b.a.x, b.b.y - b.a.y);
  const double more = (b.b.theta - b.a.theta) - (a.b.theta - a.a.theta), w2 = mm_per_rad * mm_per_rad;
  // b turned by `by` against a: any turn bounds the distance from above; Newton's method finds the least.
  const auto squared = [&](double by) {
    return 0.5 * (p - Rotation2Dd(by) * q).squaredNorm() + w2 * (by * by + (by + more) * (by + more));
  };
  double by = -0.5 * more;
  constexpr int kSteps = 4;  // the turn is small, and the second derivative nearly constant
  for (int i = 0; i < kSteps; ++i) {
    const Vector2d r = Rotation2Dd(by) * q;
    const double slope = p.x() * r.y() - p.y() * r.x() + w2 * (4 * by + 2 * more);
    const double step = slope / (std::max(0.0, p.dot(r)) + 4 * w2);
    by -= step;
    // Squared it is lost in rounding.
    constexpr double kEnough = 1e-9;
    if (std::abs(step) < kEnough) break;
  }
  return std::sqrt(std::min(squared(by), squared(-0.5 * more)));
}

}  // namespace hotblade::elastica

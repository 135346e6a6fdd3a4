#include "elastica/lambda_residual.hpp"

#include <Eigen/Dense>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>

namespace hotblade::elastica {

namespace {

constexpr int kNodes = 24;
// A speed below this share of the control polygon's length is a cusp: the curvature integral is then
// dominated by one node and says nothing.
constexpr double kCuspShare = 1e-9;
// Curvature whose total turning stays below this is rounding of a straight line.
constexpr double kStraightTurn = 1e-12;

struct Nodes {
  std::array<double, kNodes> t{}, w{};
  Nodes() {
    using Gauss = boost::math::quadrature::gauss<double, kNodes>;
    const auto& x = Gauss::abscissa();
    const auto& g = Gauss::weights();
    for (std::size_t i = 0; i < x.size(); ++i) {
      t[2 * i] = 0.5 * (1 - x[i]);
      t[2 * i + 1] = 0.5 * (1 + x[i]);
      w[2 * i] = w[2 * i + 1] = 0.5 * g[i];
    }
  }
};

}  // namespace

LambdaResidual lambda_residual(const Bezier& b) {
  static const Nodes nodes;
  const double polygon = (b[1] - b[0]).norm() + (b[2] - b[1]).norm() + (b[3] - b[2]).norm();
  LambdaResidual result;
  if (!(polygon > 0)) {
    result.status = ResidualStatus::kCusp;
    return result;
  }
  // Rows sqrt(ds) (1, -y, x | kappa) in a frame centred on the curve and scaled by the polygon, so that the
  // columns are of one size.
  const Eigen::Vector2d centre = 0.25 * (b[0] + b[1] + b[2] + b[3]);
  Eigen::Matrix<double, kNodes, 3> a;
  Eigen::Matrix<double, kNodes, 1> k;
  double turn = 0;
  for (int i = 0; i < kNodes; ++i) {
    const auto n = static_cast<std::size_t>(i);
    const BezierPoint p = evaluate(b, nodes.t[n]);
    const double speed = p.d1.norm() / polygon;
    if (!(speed > kCuspShare)) {
      result.status = ResidualStatus::kCusp;
      return result;
    }
    const double root = std::sqrt(nodes.w[n] * speed);
    const Eigen::Vector2d r = (p.p - centre) / polygon;
    a.row(i) << root, -root * r.y(), root * r.x();
    k[i] = root * curvature(p) * polygon;
    turn += std::abs(k[i]) * root;
  }
  if (turn < kStraightTurn) {
    result.status = ResidualStatus::kStraight;
    return result;
  }
  const Eigen::Vector3d x = a.completeOrthogonalDecomposition().solve(k);
  result.value = std::min(1.0, (a * x - k).norm() / k.norm());
  result.lambda1 = x[1] / (polygon * polygon);
  result.lambda2 = x[2] / (polygon * polygon);
  result.alpha = x[0] / polygon + result.lambda1 * centre.y() - result.lambda2 * centre.x();
  return result;
}

Elastica first_guess(const Bezier& b, const LambdaResidual& r) {
  const Eigen::Vector2d d = evaluate(b, 0).d1;
  Elastica e;
  e.x = b[0].x();
  e.y = b[0].y();
  e.theta = std::atan2(d.y(), d.x());
  e.kappa = r.alpha - r.lambda1 * e.y + r.lambda2 * e.x;
  e.lambda1 = r.lambda1;
  e.lambda2 = r.lambda2;
  e.length = arc_lengths(b, 32).back();
  return e;
}

}  // namespace hotblade::elastica

#include "elastica/bezier/lambda_residual.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

namespace hotblade::elastica {
namespace {

Bezier random_bezier(std::mt19937_64& random) {
  std::uniform_real_distribution<double> u(-1, 1);
  Bezier b;
  for (auto& p : b) p = {u(random), u(random)};
  return b;
}

TEST(LambdaResidual, IsInvariantUnderSimilarity) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const Bezier b = random_bezier(random);
    const LambdaResidual r = lambda_residual(b);
    if (r.status != ResidualStatus::kOk) continue;
    const Eigen::Matrix2d turn = 730.0 * Eigen::Rotation2Dd(1.1).toRotationMatrix();
    Bezier moved;
    for (std::size_t i = 0; i < 4; ++i) moved[i] = turn * b[i] + Eigen::Vector2d(4000, -900);
    EXPECT_NEAR(lambda_residual(moved).value, r.value, 1e-8);
  }
}

TEST(LambdaResidual, OfAStraightLineIsZeroByDefinition) {
  const LambdaResidual r = lambda_residual({Eigen::Vector2d(0, 0), {1, 1}, {2, 2}, {3, 3}});
  EXPECT_EQ(r.status, ResidualStatus::kStraight);
  EXPECT_EQ(r.value, 0);
}

TEST(LambdaResidual, OfACuspHasAStatus) {
  const Eigen::Vector2d p(1, 2);
  EXPECT_EQ(lambda_residual({p, p, p, p}).status, ResidualStatus::kCusp);
}

// The residual is the best of an affine fit: no other coefficients do better, by dense quadrature written
// apart.
TEST(LambdaResidual, IsTheMinimumOverAffineCurvatures) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> nudge(0, 0.05);
  const auto integral = [](const Bezier& b, double l1, double l2, double alpha) {
    double misfit = 0, total = 0;
    constexpr int n = 20000;
    for (int i = 0; i < n; ++i) {
      const BezierPoint p = evaluate(b, (i + 0.5) / n);
      const double k = curvature(p), d = k + l1 * p.p.y() - l2 * p.p.x() - alpha;
      misfit += d * d * p.d1.norm();
      total += k * k * p.d1.norm();
    }
    return std::sqrt(misfit / total);
  };
  for (int trial = 0; trial < 10; ++trial) {
    const Bezier b{Eigen::Vector2d(0, 0), {0.3, 0.2 + 0.05 * trial}, {0.7, 0.4}, {1, 0}};
    const LambdaResidual r = lambda_residual(b);
    EXPECT_NEAR(integral(b, r.lambda1, r.lambda2, r.alpha), r.value, 1e-5);
    for (int i = 0; i < 5; ++i) {
      EXPECT_GE(integral(b, r.lambda1 + nudge(random), r.lambda2 + nudge(random), r.alpha + nudge(random)),
                r.value - 1e-6);
    }
  }
}

}  // namespace
}  // namespace hotblade::elastica

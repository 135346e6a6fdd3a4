#include "elastica/projection/spline.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "elastica/bezier/lambda_residual.hpp"

namespace hotblade::elastica {
namespace {

// Two cubics, tangent at (3, 1), of different edge lengths there.
std::vector<Bezier> wave() {
  return {{Eigen::Vector2d(0, 0), {0.4, 1.2}, {2, 0.5}, {3, 1}},
          {Eigen::Vector2d(3, 1), {3.6, 1.3}, {4.5, 3}, {6, 2}}};
}

double sum_of_squares(const std::vector<double>& residuals) {
  double sum = 0;
  for (const double e : residuals) sum += e * e;
  return sum;
}

TEST(ProjectSpline, KeepsJointsAndTangentsWhileEverySegmentReachesItsOptimum) {
  const auto chain = wave();
  const SplineProjection p = project_spline(chain, Continuity::kG1);
  ASSERT_EQ(p.status, ProjectStatus::kReached);
  for (std::size_t i = 0; i < chain.size(); ++i) {
    EXPECT_EQ(p.chain[i][0], chain[i][0]);
    EXPECT_EQ(p.chain[i][3], chain[i][3]);
    EXPECT_EQ(p.residuals[i], project_optimal(chain[i], WantedBranch::kBest).lambda_residual);
  }
  const Eigen::Vector2d in = p.chain[0][3] - p.chain[0][2], out = p.chain[1][1] - p.chain[1][0];
  EXPECT_LT((in.normalized() - out.normalized()).norm(), 1e-12);
}

TEST(ProjectSpline, GivesOneDerivativeAtAJointAndTheLeastSumThatBruteForceFinds) {
  const auto chain = wave();
  const SplineProjection p = project_spline(chain, Continuity::kC1);
  ASSERT_EQ(p.status, ProjectStatus::kReached);
  const Eigen::Vector2d in = p.chain[0][3] - p.chain[0][2], out = p.chain[1][1] - p.chain[1][0];
  EXPECT_LT((in - out).norm(), 1e-12);
  // For every length at the joint the outer lengths are free of each other.
  double least = 2;
  for (double joint = 0.1; joint < 6; joint *= 1.03) {
    double sum = 0;
    for (std::size_t i = 0; i < 2; ++i) {
      double best = 1;
      for (double free = 0.1; free < 6; free *= 1.03) {
        Bezier b = chain[i];
        const double l1 = i == 0 ? free : joint, l2 = i == 0 ? joint : free;
        b[1] = b[0] + l1 * (b[1] - b[0]).normalized();
        b[2] = b[3] + l2 * (b[2] - b[3]).normalized();
        const LambdaResidual r = lambda_residual(b);
        if (has_value(r.status)) best = std::min(best, r.value * r.value);
      }
      sum += best;
    }
    least = std::min(least, sum);
  }
  EXPECT_LE(sum_of_squares(p.residuals), least * 1.001);
  EXPECT_GE(sum_of_squares(p.residuals), sum_of_squares(project_spline(chain, Continuity::kG1).residuals));
}

TEST(ProjectSpline, RefusesSegmentsThatDoNotMeet) {
  auto chain = wave();
  chain[1][0].x() += 0.1;
  EXPECT_THROW((void)project_spline(chain, Continuity::kG1), std::logic_error);
  EXPECT_THROW((void)project_spline({}, Continuity::kG1), std::logic_error);
}

// A cubic in mm that one clamped elastica misses by several millimetres.
const Bezier kHook{Eigen::Vector2d(0, 0), {700, 500}, {900, -600}, {1000, 300}};

TEST(SplitToElastica, StaysWithinTheToleranceWithTangentJoints) {
  const double tolerance = 1;
  const ElasticaSplit split = split_to_elastica(kHook, tolerance, 10);
  ASSERT_TRUE(split.within);
  EXPECT_EQ(split.pieces.front().from, 0);
  EXPECT_EQ(split.pieces.back().to, 1);
  for (std::size_t i = 0; i < split.pieces.size(); ++i) {
    const SplitPiece& piece = split.pieces[i];
    EXPECT_LE(piece.deviation, tolerance);
    const auto points = sample(piece.elastica, 50);
    const BezierPoint start = evaluate(kHook, piece.from), end = evaluate(kHook, piece.to);
    EXPECT_LT((points.front().position() - start.p).norm(), 1e-6);
    EXPECT_LT((points.back().position() - end.p).norm(), 1e-6);
    EXPECT_NEAR(
        std::remainder(points.back().theta - std::atan2(end.d1.y(), end.d1.x()), 2 * std::numbers::pi), 0,
        1e-6);
    // Every sample lies near some point of the piece.
    for (const CurvePoint& q : points) {
      double nearest = 1e9;
      for (int k = 0; k <= 400; ++k) {
        const double t = piece.from + (piece.to - piece.from) * k / 400;
        nearest = std::min(nearest, (evaluate(kHook, t).p - q.position()).norm());
      }
      EXPECT_LE(nearest, tolerance);
    }
  }
}

TEST(SplitToElastica, NeedsNoFewerPiecesForATighterToleranceAndOneWhereOneServes) {
  EXPECT_EQ(split_to_elastica(kHook, 500, 8).pieces.size(), 1u);
  const std::size_t loose = split_to_elastica(kHook, 20, 8).pieces.size(),
                    tight = split_to_elastica(kHook, 2, 8).pieces.size();
  EXPECT_LE(loose, tight);
  EXPECT_GT(tight, 1u);
  EXPECT_THROW((void)split_to_elastica(kHook, 0), std::logic_error);
  // Without inner places there is nowhere to split.
  EXPECT_FALSE(split_to_elastica(kHook, 0.01, 1).within);
}

}  // namespace
}  // namespace hotblade::elastica

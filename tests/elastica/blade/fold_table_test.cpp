#include "elastica/blade/fold_table.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "elastica/blade/stability.hpp"

namespace hotblade::elastica {
namespace {

PressedBlade at_force(PressedBlade blade, double force) {
  blade.force = force;
  return blade;
}

int index_of_blade(const PressedBlade& blade) {
  return end_map(blade.elastica()).index;
}

TEST(PressedBlade, IsTheSameShapeWhereverItStands) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 50; ++i) {
    // Forces less than half a turn from the tangent.
    const PressedBlade blade{3 * unit(random), 6 * unit(random) - 3, 1 + 80 * unit(random)};
    Elastica e = blade.elastica();
    const double length = 700, turn = 5 * unit(random), c = std::cos(turn), s = std::sin(turn);
    e = {30,
         40,
         turn,
         e.kappa / length,
         (c * e.lambda1 - s * e.lambda2) / length / length,
         (s * e.lambda1 + c * e.lambda2) / length / length,
         length};
    const PressedBlade back = PressedBlade::of(e);
    EXPECT_NEAR(back.size, blade.size, 1e-12);
    EXPECT_NEAR((back.bend() - blade.bend()).norm(), 0, 1e-12);
    EXPECT_NEAR(back.force, blade.force, 1e-10);
  }
}

TEST(PressedBlade, SlopesAreThoseOfDifferences) {
  const PressedBlade blade{0.8, 2.1, 55};
  const auto values = [](const PressedBlade& b) {
    const Elastica e = b.elastica();
    return Eigen::Vector3d(e.kappa, e.lambda1, e.lambda2);
  };
  constexpr double kStep = 1e-6;
  Eigen::Matrix3d differences;
  PressedBlade more = blade, less = blade;
  more.size += kStep, less.size -= kStep;
  differences.col(0) = (values(more) - values(less)) / (2 * kStep);
  more = less = blade;
  more.phase += kStep, less.phase -= kStep;
  differences.col(1) = (values(more) - values(less)) / (2 * kStep);
  more = less = blade;
  more.force += kStep, less.force -= kStep;
  differences.col(2) = (values(more) - values(less)) / (2 * kStep);
  EXPECT_LT((blade.slopes() - differences).norm(), 1e-6);
}

TEST(FoldTable, HoldsTheLargestForcesOfStableShapes) {
  const FoldTable& table = FoldTable::shallow();
  for (int i = 0; i < table.sizes(); ++i) {
    for (int j = 0; j < table.phases(); ++j) {
      ASSERT_EQ(table.at(i, j).size(), 1U) << i << ' ' << j;
      const TabledFold& fold = table.at(i, j)[0];
      const double force = fold.blade.force;
      EXPECT_EQ(index_of_blade(at_force(fold.blade, 0.999 * force)), 0) << i << ' ' << j;
      EXPECT_GE(index_of_blade(at_force(fold.blade, 1.001 * force)), 1) << i << ' ' << j;
      // By the count of another method, and for any smaller force.
      EXPECT_NEAR(stability_margin(fold.blade.elastica()), 0, 0.1) << i << ' ' << j;
      for (int k = 1; k < 10; ++k) EXPECT_EQ(index_of_blade(at_force(fold.blade, 0.1 * k * force)), 0);
      const CurvePoint end = point_at(fold.blade.elastica(), 1);
      EXPECT_NEAR(std::hypot(end.x - fold.end.x, end.y - fold.end.y), 0, 1e-7);
      EXPECT_NEAR(end.theta, fold.end.theta, 1e-7);
    }
  }
}

// Of shallow shapes: theta = alpha (1 - cos w s) + kappa / w sin w s under any force w^2, so the folds are
// those of a straight column's modes, of one sign all along or not.
TEST(FoldTable, EdgesOfShallowShapesAreEulersColumns) {
  const FoldTable& table = FoldTable::shallow();
  const TabledFold& tangents = table.edge(FoldEdge::kTangents)[0];
  EXPECT_NEAR(tangents.blade.force, 4 * M_PI * M_PI, 1e-4);
  EXPECT_EQ(tangents.blade.phase, 0);
  const TabledFold& curvatures = table.edge(FoldEdge::kCurvatures)[0];
  const double half = 0.5 * std::sqrt(curvatures.blade.force);
  EXPECT_NEAR(std::tan(half), half, 1e-3);
  EXPECT_NEAR(curvatures.blade.phase, std::atan(2 / kBendRate), 1e-5);
}

TEST(FoldTable, EdgesAreAlikeFromBothEnds) {
  const FoldTable& table = FoldTable::shallow();
  for (const FoldEdge edge : {FoldEdge::kTangents, FoldEdge::kCurvatures}) {
    ASSERT_EQ(table.edge(edge).size(), static_cast<std::size_t>(table.sizes()));
    for (const TabledFold& fold : table.edge(edge)) {
      const ElasticaCurve curve(fold.blade.elastica());
      EXPECT_NEAR(stability_margin(curve.elastica()), 0, 0.1);
      for (const double s : {0.0, 0.1, 0.25, 0.4}) {
        const CurvePoint p = curve.at(s), q = curve.at(1 - s);
        if (edge == FoldEdge::kTangents) {
          EXPECT_NEAR(p.theta, q.theta, 1e-5 * fold.blade.size) << fold.blade.size << ' ' << s;
        } else {
          EXPECT_NEAR(p.kappa, q.kappa, 1e-4 * fold.blade.size) << fold.blade.size << ' ' << s;
        }
      }
    }
  }
}

TEST(FoldTable, OfDeepShapesIsWhereStabilityBeginsAndEnds) {
  const FoldTable& table = FoldTable::deep();
  int again = 0;
  for (int i = 0; i < table.sizes(); ++i) {
    for (int j = 0; j < table.phases(); ++j) {
      again += table.at(i, j).size() > 1 ? 1 : 0;
      for (const TabledFold& fold : table.at(i, j)) {
        const auto stable = [&](double more) {
          return index_of_blade(at_force(fold.blade, fold.blade.force + more)) == 0;
        };
        EXPECT_NE(stable(-0.05), stable(0.05)) << i << ' ' << j;
        EXPECT_LT(fold.end.position().norm(), FoldTable::kLongestDeepChord);
      }
    }
  }
  EXPECT_GT(again, 0);
}

TEST(FoldTable, FoldAtSaysWhereThereIsNone) {
  // Stable under any force up to 250.
  for (const double force : {1.0, 10.0, 50.0, 100.0, 250.0}) EXPECT_EQ(index_of_blade({3, 2.5, force}), 0);
  EXPECT_FALSE(fold_at(3, 2.5, 40));
}

}  // namespace
}  // namespace hotblade::elastica

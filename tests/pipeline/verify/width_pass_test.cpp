// The width of poses over the places of a row: alike on every instruction set, and nothing where the poses do
// not tell it.
#include "pipeline/verify/width_pass.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "elastica/blade/blade_batch.hpp"
#include "pipeline/verify/width_lanes.hpp"
#include "tests/pipeline/vault_program.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector3d;

constexpr double kWidth_mm = 8, kStep_mm = 0.5;
constexpr std::size_t kPlaces = 21;  // of no number of lanes

// A bent blade that goes along x, `rise` mm per mm, and turns about y over its way.
std::vector<BladePose> poses_of(int count, double rise, double turn_per_mm) {
  const BladePose pattern = testing::vault_program().strips.front().poses.front();
  std::vector<BladePose> poses;
  for (int i = 0; i < count; ++i) {
    const double x = kStep_mm * (i - count / 2), turn = turn_per_mm * x;
    BladePose& pose = poses.emplace_back(pattern);
    pose.frame =
        SharedFrame(Frame{{x, 0, rise * x}, Vector3d::UnitY(), Vector3d(-std::sin(turn), 0, std::cos(turn))});
    pose.blade = {0, 0, 0.3, -2e-3, 1e-6, 0, 400};
    pose.foam = {{100, 300}};
    pose.heat = true;
  }
  return poses;
}

struct Row {
  std::vector<Vector3d> normals, plane_normals;
};

Row row_of(const BladePose& pose, double rise) {
  const elastica::Part part{(*pose.foam)[0], (*pose.foam)[1]};
  const elastica::PartPoints on = elastica::sample_parts({&pose.blade, 1}, {&part, 1}, kPlaces);
  Row row;
  for (std::size_t j = 0; j < kPlaces; ++j) {
    const Vector3d left = -on.sin[j] * pose.frame.x() + on.cos[j] * pose.frame.y();
    row.plane_normals.push_back(pose.frame.normal());
    const Vector3d sweep = Vector3d(1, 0, rise), n = pose.frame.normal();
    row.normals.push_back((left - left.dot(sweep) / n.dot(sweep) * n).normalized());
  }
  return row;
}

TEST(WidthPasses, AreTheSameBitsOnEveryInstructionSet) {
  const std::vector<BladePose> poses = poses_of(41, -0.3, 0.001);
  const BladePose& own = poses[20];
  const Row row = row_of(own, -0.3);
  const elastica::Part part{(*own.foam)[0], (*own.foam)[1]};
  const auto passed = [&](elastica::Simd simd) {
    WidthOverRow over(own, part, row.normals, row.plane_normals, kWidth_mm);
    std::vector<WidthOverRow::Passed> told;
    for (std::size_t k = 21; k < poses.size(); ++k) {
      // The points themselves may differ between sets by rounding.
      const elastica::PartPoints on =
          elastica::sample_parts({&poses[k].blade, 1}, {&part, 1}, kPlaces, elastica::Simd::kBaseline);
      told.push_back(over.pass(poses[k], on, 0, simd));
    }
    EXPECT_EQ(told.front(), WidthOverRow::Passed::kNot);
    EXPECT_EQ(told.back(), WidthOverRow::Passed::kAll);
    return over.deepest_mm();
  };
  const std::vector<double> baseline = passed(elastica::Simd::kBaseline);
  double deepest = 0;
  for (const double d : baseline) deepest = std::max(deepest, d);
  EXPECT_GT(deepest, 0.5);
  int others = 0;
  for (const elastica::Simd simd : {elastica::Simd::kAvx2, elastica::Simd::kAvx512}) {
    if (!elastica::supported(simd)) continue;
    ++others;
    EXPECT_EQ(passed(simd), baseline);
  }
  if (others == 0) GTEST_SKIP() << "this machine has the baseline alone";
}

TEST(WidthPasses, ReachAsFarDownAsHalfTheWidthRises) {
  constexpr double kRise = 0.25;
  const std::vector<BladePose> poses = poses_of(41, kRise, 0);
  const Row row = row_of(poses[20], kRise);
  const auto deepest = WidthPasses(poses, kWidth_mm).deepest_mm(20, row.normals, row.plane_normals, kStep_mm);
  ASSERT_TRUE(deepest);
  for (std::size_t j = 0; j < kPlaces; ++j)
    EXPECT_NEAR((*deepest)[j], std::abs(row.normals[j].dot(row.plane_normals[j])) * kWidth_mm / 2, 1e-4) << j;
}

TEST(WidthPasses, SayNothingWherePosesDoNotTell) {
  const auto told = [](const std::vector<BladePose>& poses, std::size_t row) {
    const Row at = row_of(poses[row], 0.25);
    return WidthPasses(poses, kWidth_mm).deepest_mm(row, at.normals, at.plane_normals, kStep_mm).has_value();
  };
  std::vector<BladePose> poses = poses_of(41, 0.25, 0.001);
  EXPECT_TRUE(told(poses, 20));
  // They end 4 mm behind, which is half the width.
  EXPECT_FALSE(told(poses, 36));
  EXPECT_FALSE(told(poses, 3));
  std::vector<BladePose> cold = poses;
  cold[25].heat = false;
  EXPECT_FALSE(told(cold, 20));
  std::vector<BladePose> apart = poses;
  apart.erase(apart.begin() + 22, apart.begin() + 32);
  EXPECT_FALSE(told(apart, 20));
}

}  // namespace
}  // namespace hotblade::pipeline

// What keeps a million poses small: optionals without a flag, axes that are shared.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "pipeline/program/program.hpp"
#include "tests/pipeline/vault_program.hpp"

namespace hotblade::pipeline {
namespace {

using pipeline::testing::vault_program;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(CompactOptional, IsAbsentUntilItIsSetAndAfterItIsReset) {
  CompactOptional<double> value;
  EXPECT_FALSE(value.has_value());
  EXPECT_EQ(value, std::nullopt);
  EXPECT_THROW((void)value.value(), std::bad_optional_access);
  EXPECT_EQ(value.value_or(3), 3);
  value = -0.0;
  ASSERT_TRUE(value);
  EXPECT_EQ(*value, 0);
  EXPECT_EQ(value, 0.0);
  EXPECT_NE(value, std::nullopt);
  value.reset();
  EXPECT_FALSE(value);
  value = std::optional(2.5);
  EXPECT_EQ(std::optional<double>(value), 2.5);
  value = std::nullopt;
  EXPECT_EQ(std::optional<double>(value), std::nullopt);
}

TEST(CompactOptional, RefusesWhatWouldPassForAbsent) {
  CompactOptional<double> value = 1.5;
  EXPECT_THROW(value = kNan, std::logic_error);
  EXPECT_EQ(value, 1.5);
  EXPECT_THROW(CompactOptional<int>{std::numeric_limits<int>::min()}, std::logic_error);
  EXPECT_THROW((CompactOptional<std::array<double, 2>>{{kNan, 1}}), std::logic_error);
  EXPECT_THROW(CompactOptional<PoseLoads>{PoseLoads{.force_n = std::numeric_limits<float>::quiet_NaN()}},
               std::logic_error);
}

TEST(CompactOptional, TakesNoMoreThanItsValue) {
  EXPECT_EQ(sizeof(CompactOptional<double>), sizeof(double));
  EXPECT_EQ(sizeof(CompactOptional<PoseLoads>), sizeof(PoseLoads));
}

TEST(SharedFrame, IsTheFrameItIsMadeOf) {
  const Frame frame{{1, 2, 3}, {0, 1, 0}, {0, 0, 1}};
  const SharedFrame shared = frame;
  const Frame back = shared;
  EXPECT_EQ(back.origin, frame.origin);
  EXPECT_EQ(back.x, frame.x);
  EXPECT_EQ(back.y, frame.y);
  EXPECT_EQ(shared.normal(), frame.normal());
  EXPECT_EQ(shared.point(3, -4, 5), frame.point(3, -4, 5));
  EXPECT_EQ(Frame(SharedFrame()).x, Frame().x);
  EXPECT_EQ(Frame(SharedFrame()).y, Frame().y);
}

TEST(SharedFrame, TakesTheAxesOfAnotherOnlyWhereTheyAreTheSame) {
  const Frame first{{0, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const SharedFrame like = first;
  const SharedFrame moved({{7, 8, 9}, first.x, first.y}, like);
  EXPECT_EQ(moved.origin, Eigen::Vector3d(7, 8, 9));
  EXPECT_TRUE(moved.shares_axes(like));
  const SharedFrame turned({{7, 8, 9}, first.x, -first.y}, like);
  EXPECT_EQ(turned.y(), -first.y);
  EXPECT_FALSE(turned.shares_axes(like));
  EXPECT_EQ(like.y(), first.y);
}

TEST(PoseRow, IsThePoseItIsMadeOfInSevenNumbers) {
  const Pose pose{{1, 2, 3}, {0.5, -0.5, 0.1, 0.7}};
  const PoseRow row = pose;
  const Pose back = row;
  EXPECT_EQ(back.p, pose.p);
  EXPECT_EQ(back.q.coeffs(), pose.q.coeffs());
  static_assert(sizeof(PoseRow) == 7 * sizeof(double) && offsetof(PoseRow, w) == 3 * sizeof(double));
  EXPECT_EQ(row.w, 0.5);
  EXPECT_EQ(row.v, Eigen::Vector3d(-0.5, 0.1, 0.7));
  const Pose none = PoseRow();
  EXPECT_EQ(none.q.coeffs(), Pose().q.coeffs());
}

TEST(BladePose, HasNoGapsBetweenItsMembers) {
  const BladePose pose;
  const std::size_t members = sizeof(pose.t) + sizeof(pose.frame) + sizeof(pose.a) + sizeof(pose.b) +
                              sizeof(pose.blade) + sizeof(pose.foam) + sizeof(pose.margin) +
                              sizeof(pose.margin_mm) + sizeof(pose.loads) + sizeof(pose.rib) +
                              sizeof(pose.phase) + sizeof(pose.heat);
  EXPECT_LT(sizeof(BladePose) - members, alignof(double));
}

TEST(BladePose, SharesItsAxesWithThePoseBeforeHoweverItIsRead) {
  const std::string text = to_json(vault_program());
  std::string spread = text;  // other white space: the reader that tells places
  spread.insert(spread.find("\"poses\":") + 8, "  ");
  for (const std::string& way : {text, spread}) {
    const std::vector<BladePose> poses = parse_program(way, "job.json").strips[0].poses;
    for (std::size_t i = 1; i < poses.size(); ++i) {
      const Frame frame = poses[i].frame, before = poses[i - 1].frame;
      EXPECT_EQ(poses[i].frame.shares_axes(poses[i - 1].frame), frame.x == before.x && frame.y == before.y);
    }
  }
}

}  // namespace
}  // namespace hotblade::pipeline

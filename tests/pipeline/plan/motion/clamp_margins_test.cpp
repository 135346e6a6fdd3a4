#include "pipeline/plan/motion/clamp_margins.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "elastica/blade/clamp_margin.hpp"
#include "pipeline/verify/clamp_error.hpp"

namespace hotblade::pipeline {
namespace {

constexpr double kLength = 800;

// An arch turned over to just before its snap, as a strip's poses.
std::vector<BladePose> turned_over() {
  using elastica::follow;
  const elastica::Elastica arc{0, 0, 0.6, -1.2 / kLength, 0, 0, kLength};
  const auto up = follow(arc, {{0, 0, 0.6}, {740, 0, -0.6}}).shape.elastica;
  const double lost = follow(up, {{0, 0, -0.6}, {740, 0, 0.6}}).fraction;
  std::vector<BladePose> poses;
  elastica::Elastica shape = up;
  constexpr int kPoses = 120;
  for (int i = 0; i <= kPoses; ++i) {
    const double turn = 0.6 - 1.2 * lost * (0.6 + 0.398 * i / kPoses);
    shape = follow(shape, {{0, 0, turn}, {740, 0, -turn}}).shape.elastica;
    poses.emplace_back();
    poses.back().blade = shape;
  }
  return poses;
}

// A strip may come so near to a fold.
Settings least_margin(double mm) {
  Settings settings;
  settings.blade.min_margin_mm = mm;
  return settings;
}

TEST(ClampMargins, BoundTheMarginOfEveryPoseFromBelow) {
  const std::vector<BladePose> poses = turned_over();
  const std::vector<PoseMargin> margins = clamp_margins(poses, least_margin(0.01));
  ASSERT_EQ(margins.size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); i += 7) {
    const elastica::ClampMargin exact = elastica::clamp_margin(poses[i].blade, {kFarFromFoldMm, 0});
    EXPECT_LE(margins[i].fold_mm, exact.fold_mm * (1 + 1e-5)) << i;
    // Of the neighbour's value, which is at most a third more.
    EXPECT_GE(margins[i].fold_mm, kMarginShare / (2 - kMarginShare) * exact.fold_mm * (1 - 1e-5)) << i;
    EXPECT_NEAR(margins[i].straight_mm, exact.straight_mm, 1e-8);
  }
  EXPECT_EQ(margins.front().fold_mm, kFarFromFoldMm);
  EXPECT_LT(margins.back().fold_mm, 1.5);
}

// A strip that is refused is searched less closely, and the distance that refuses it told as closely.
TEST(ClampMargins, BoundTheSmallestOfARefusedStrip) {
  const std::vector<BladePose> poses = turned_over();
  const std::vector<PoseMargin> margins = clamp_margins(poses, least_margin(5));
  double least = kFarFromFoldMm, told = kFarFromFoldMm;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const elastica::ClampMargin exact = elastica::clamp_margin(poses[i].blade, {kFarFromFoldMm, 0});
    EXPECT_LE(margins[i].margin_mm, exact.margin_mm * (1 + 1e-5)) << i;
    least = std::min(least, exact.fold_mm);
    told = std::min(told, margins[i].fold_mm);
  }
  EXPECT_GE(told, kMarginShare * least * (1 - 1e-5));
}

// Formed to a stronger arc and on to an S, and back again: folds come near from afar, and go.
std::vector<BladePose> there_and_back() {
  using elastica::follow;
  const elastica::ClampPair arc{{0, 0, 0.3}, {780, 0, -0.3}}, bow{{0, 0, 0.9}, {690, 0, -0.9}},
      wave{{0, 0, 0.9}, {690, 60, 0.35}};
  std::vector<BladePose> poses;
  elastica::Elastica shape = follow({0, 0, 0.3, -0.6 / kLength, 0, 0, kLength}, arc).shape.elastica;
  const auto between = [](const elastica::PlanarPose& p, const elastica::PlanarPose& q, double t) {
    return elastica::PlanarPose{p.x + t * (q.x - p.x), p.y + t * (q.y - p.y),
                                p.theta + t * (q.theta - p.theta)};
  };
  const std::array way{arc, bow, wave, bow, arc};
  constexpr int kSteps = 60;
  for (std::size_t leg = 1; leg < way.size(); ++leg) {
    for (int i = 0; i < kSteps; ++i) {
      const double t = static_cast<double>(i) / kSteps;
      const auto moved =
          follow(shape, {between(way[leg - 1].a, way[leg].a, t), between(way[leg - 1].b, way[leg].b, t)});
      EXPECT_EQ(moved.status, elastica::FollowStatus::kFollowed);
      shape = moved.shape.elastica;
      poses.emplace_back();
      poses.back().blade = shape;
    }
  }
  return poses;
}

TEST(ClampMargins, AreNeverAboveASearchOfThePoseAlone) {
  const std::vector<BladePose> poses = there_and_back();
  const std::vector<PoseMargin> margins = clamp_margins(poses, {});
  for (std::size_t i = 0; i < poses.size(); i += 4) {
    const elastica::ClampMargin exact = elastica::clamp_margin(poses[i].blade, {kFarFromFoldMm, 0});
    const double told = std::min(margins[i].fold_mm, margins[i].straight_mm);
    EXPECT_LE(told, exact.margin_mm * (1 + 1e-5)) << i;
    EXPECT_GE(told, kMarginShare / (2 - kMarginShare) * exact.margin_mm * (1 - 1e-5)) << i;
  }
}

// Past the straight blade at 6 mm, pressed, to half a millimetre from a snap: a blade of a strip with a
// hollow.
std::vector<BladePose> pressed_past_the_straight_one() {
  struct Knot {
    double theta, kappa, lambda1, lambda2;  // of a blade 1 long
  };
  constexpr std::array<Knot, 7> kKnots{{{-0.1099, 0.123, 16.10, -1.763},
                                        {-0.1502, 0.066, 23.47, -2.694},
                                        {-0.1675, -0.096, 29.72, -3.427},
                                        {-0.1653, -0.311, 35.02, -3.908},
                                        {-0.1469, -0.544, 39.55, -4.110},
                                        {-0.1153, -0.770, 43.47, -4.023},
                                        {-0.0729, -0.976, 46.91, -3.645}}};
  constexpr double kShort = 400;
  constexpr int kBetween = 20;
  std::vector<BladePose> poses;
  for (std::size_t k = 1; k < kKnots.size(); ++k) {
    for (int i = 0; i < kBetween; ++i) {
      const double t = static_cast<double>(i) / kBetween;
      const auto at = [&](double Knot::*number) {
        return kKnots[k - 1].*number + t * (kKnots[k].*number - kKnots[k - 1].*number);
      };
      poses.emplace_back();
      poses.back().blade = {0,
                            0,
                            at(&Knot::theta),
                            at(&Knot::kappa) / kShort,
                            at(&Knot::lambda1) / (kShort * kShort),
                            at(&Knot::lambda2) / (kShort * kShort),
                            kShort};
    }
  }
  return poses;
}

// A search that ends at the straight blade says nothing of what lies farther away.
TEST(ClampMargins, BesideTheStraightBladeAreNoMoreThanOthersAndTheWayToThem) {
  const std::vector<BladePose> poses = pressed_past_the_straight_one();
  const std::vector<PoseMargin> margins = clamp_margins(poses, {});
  std::vector<double> most(poses.size(), kFarFromFoldMm);
  double least = kFarFromFoldMm;
  for (std::size_t k = 0; k < poses.size(); k += 4) {
    const double found = elastica::clamp_margin(poses[k].blade, {kFarFromFoldMm, 0}).margin_mm;
    least = std::min(least, found);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const double way = elastica::clamp_distance(elastica::clamps_of(poses[i].blade),
                                                  elastica::clamps_of(poses[k].blade), 200);
      // Along the motion the way is longer: by a tenth at most here.
      most[i] = std::min(most[i], found + 1.1 * way);
    }
  }
  EXPECT_LT(least, 0.6);
  // Folds lie closely beside the straight blade, and a search from a single pose may find the second nearest.
  for (std::size_t i = 0; i < poses.size(); ++i) EXPECT_LE(margins[i].margin_mm, 1.35 * most[i]) << i;
}

TEST(ClampMargins, OfAStraightBladeAreItsDistanceToTheStraightOne) {
  std::vector<BladePose> poses(3);
  for (std::size_t i = 0; i < poses.size(); ++i)
    poses[i].blade = {0, 0, 0, 1e-6 * static_cast<double>(i), 0, 0, kLength};
  const std::vector<PoseMargin> margins = clamp_margins(poses, {});
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double half_turn = 0.5e-6 * static_cast<double>(i) * kLength;
    EXPECT_NEAR(margins[i].straight_mm, std::sqrt(2.0) * 0.5 * kLength * half_turn, 1e-4);
    EXPECT_GE(margins[i].fold_mm, margins[i].straight_mm);
  }
}

TEST(ClampMargins, TheirLimitIsTwiceTheMachinesErrorsUnlessGiven) {
  Settings settings;
  settings.machine.clamp_error_mm = 0.3;
  settings.machine.clamp_error_rad = 0.001;
  EXPECT_NEAR(worst_clamp_error_mm(settings.machine, kLength), std::sqrt(2 * (0.09 + 0.16)), 1e-12);
  EXPECT_NEAR(smallest_margin_mm(settings, kLength), 2 * std::sqrt(0.5), 1e-12);
  settings.blade.min_margin_mm = 3;
  EXPECT_EQ(smallest_margin_mm(settings, kLength), 3);
}

}  // namespace
}  // namespace hotblade::pipeline

#include "pipeline/plan/motion/round_poses.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <charconv>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "elastica/curve/elastica.hpp"

namespace hotblade::pipeline {
namespace {

std::string shortest(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

std::size_t digits(double value) {
  std::string text = shortest(value);
  text = text.substr(0, text.find('e'));
  std::size_t count = 0;
  for (const char c : text.substr(text.find_first_not_of("-0."))) count += c >= '0' && c <= '9';
  return count;
}

// Blades of up to 3 m, bent as far as a 2 mm blade goes, on frames anywhere within 10 m.
std::vector<BladePose> random_poses(std::size_t count) {
  std::mt19937 random(11);
  const auto within = [&](double bound) { return std::uniform_real_distribution(-bound, bound)(random); };
  std::vector<BladePose> poses(count);
  for (BladePose& pose : poses) {
    const Eigen::Quaterniond turn = Eigen::Quaterniond::UnitRandom();
    pose.frame = Frame{{within(1e4), within(1e4), within(1e4)},
                       turn * Eigen::Vector3d::UnitX(),
                       turn * Eigen::Vector3d::UnitY()};
    const double length = 1750 + within(1250), sharpest = std::pow(10, -4 + within(2));
    pose.blade = {within(9000),
                  within(9000),
                  within(3),
                  within(sharpest),
                  within(sharpest / length),
                  within(sharpest / length),
                  length};
    pose.foam = {{length / 7, length / 3}};
    for (PoseRow* clamp : {&pose.a, &pose.b})
      *clamp = Pose{Eigen::Vector3d(within(1e4), within(1e4), within(1e4)), Eigen::Quaterniond::UnitRandom()};
    pose.margin = within(80);
    pose.margin_mm = 10 + within(10);
  }
  return poses;
}

TEST(RoundPoses, MovesNoPointOfABladeByMoreThanAHundredThousandthOfAMicrometre) {
  const std::vector<BladePose> exact = random_poses(2000);
  std::vector<BladePose> poses = exact;
  round_geometry(poses);
  double farthest = 0, clamps = 0, turned = 0;
  const auto point = [](const BladePose& pose, double share) {
    const elastica::CurvePoint at = elastica::point_at(pose.blade, share * pose.blade.length);
    return pose.frame.point(at.x, at.y);
  };
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (const double share : {0.0, 0.3, 0.7, 1.0})
      farthest = std::max(farthest, (point(poses[i], share) - point(exact[i], share)).norm());
    for (const auto clamp : {&BladePose::a, &BladePose::b}) {
      clamps = std::max(clamps, ((poses[i].*clamp).p - (exact[i].*clamp).p).norm());
      turned = std::max(turned, (poses[i].*clamp).q().angularDistance((exact[i].*clamp).q()));
    }
  }
  EXPECT_LT(farthest, 1e-7);
  EXPECT_GT(farthest, 1e-10);
  EXPECT_LT(clamps, 1e-8);
  EXPECT_LT(turned, 1e-7);  // what an arc cosine near 1 tells apart
}

TEST(RoundPoses, LeavesFewDigits) {
  std::vector<BladePose> poses = random_poses(500);
  round_geometry(poses);
  round_judgement(poses);
  for (const BladePose& pose : poses) {
    for (const double length : {pose.frame.origin.x(), pose.a.p.z(), pose.blade.x, (*pose.foam)[1]})
      ASSERT_LE(digits(length), 13U) << shortest(length);
    for (const double unit : {pose.frame.x().y(), pose.b.w, pose.blade.kappa, pose.blade.lambda2})
      ASSERT_LE(digits(unit), 12U) << shortest(unit);
    for (const double judged : {pose.margin, *pose.margin_mm})
      ASSERT_LE(digits(judged), 6U) << shortest(judged);
  }
}

TEST(RoundPoses, LoadsHaveSixDigitsAndAnEnd) {
  EXPECT_EQ(load_of(2.0 / 3), 0.666667F);
  EXPECT_EQ(load_of(-123456.7), -123457.0F);
  EXPECT_EQ(load_of(0), 0.0F);
  EXPECT_EQ(load_of(1e300), 1e38F);
  EXPECT_EQ(load_of(-std::numeric_limits<double>::infinity()), -1e38F);
  EXPECT_TRUE(std::isnan(load_of(std::numeric_limits<double>::quiet_NaN())));
}

TEST(RoundPoses, SharesAxesThatAreTheSameOnceRounded) {
  std::vector<BladePose> poses = random_poses(3);
  poses[1].frame = {poses[1].frame.origin, poses[0].frame.x() + Eigen::Vector3d(1e-14, 0, 0),
                    poses[0].frame.y()};
  round_geometry(poses);
  EXPECT_TRUE(poses[1].frame.shares_axes(poses[0].frame));
  EXPECT_FALSE(poses[2].frame.shares_axes(poses[1].frame));
}

TEST(RoundPoses, AgainChangesNothing) {
  std::vector<BladePose> poses = random_poses(300);
  const auto round_all = [&] {
    round_geometry(poses);
    round_judgement(poses);
  };
  round_all();
  const std::vector<BladePose> once = poses;
  round_all();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(poses[i].frame.origin, once[i].frame.origin);
    EXPECT_EQ(poses[i].a.q().coeffs(), once[i].a.q().coeffs());
    EXPECT_EQ(poses[i].blade.kappa, once[i].blade.kappa);
    EXPECT_EQ(poses[i].blade.lambda1, once[i].blade.lambda1);
    EXPECT_EQ(poses[i].margin_mm, once[i].margin_mm);
  }
}

TEST(RoundPoses, NeverRaisesTheClampsMargin) {
  std::vector<BladePose> poses = random_poses(2000);
  const std::vector<BladePose> exact = poses;
  round_judgement(poses);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_LE(*poses[i].margin_mm, *exact[i].margin_mm);
    EXPECT_GT(*poses[i].margin_mm, *exact[i].margin_mm * (1 - 1e-5));
  }
}

TEST(RoundPoses, TakesWhatIsNoNumberZeroAndTiny) {
  std::vector<BladePose> poses(1);
  poses[0].blade = {std::numeric_limits<double>::quiet_NaN(), 1e300, 0, 0, 3e-25, -0.0, 760};
  poses[0].margin_mm = std::numeric_limits<double>::infinity();
  round_geometry(poses);
  round_judgement(poses);
  EXPECT_TRUE(std::isnan(poses[0].blade.x));
  EXPECT_EQ(poses[0].blade.y, 1e300);
  EXPECT_EQ(poses[0].blade.kappa, 0);
  EXPECT_EQ(poses[0].blade.lambda1, 0);
  EXPECT_EQ(poses[0].blade.length, 760);
  EXPECT_TRUE(std::isinf(*poses[0].margin_mm));
}

}  // namespace
}  // namespace hotblade::pipeline

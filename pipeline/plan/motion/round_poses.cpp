#include "pipeline/plan/motion/round_poses.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace hotblade::pipeline {
namespace {

// Powers of ten that doubles hold exactly: a whole number divided by one is the double nearest to that
// decimal, whose shortest text has no more digits than the decimal.
constexpr std::array<double, 23> kTens{1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                       1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
constexpr std::size_t kLength = 8;  // decimals: 1e-8 mm, over 50 ms an acceleration of 2e-5 mm/s2
constexpr std::size_t kUnit = 12;   // decimals: 1e-8 mm at 10 m
constexpr std::size_t kJoint = 11;
constexpr int kCurvatureDigits = 12, kJudgementDigits = 6;

// Whole numbers from here on have steps of their own that are coarser than the grid.
constexpr double kExact = 9e15;

double on_grid(double value, std::size_t decimals) {
  const double scaled = value * kTens[decimals];
  return std::abs(scaled) < kExact ? std::nearbyint(scaled) / kTens[decimals] : value;
}

template <typename Values>
void put_on_grid(Values&& values, std::size_t decimals) {
  for (double& value : values) value = on_grid(value, decimals);
}

// The number of decimals that leaves a value so many digits; zero for what is less than 1e-22 of a unit.
std::size_t decimals_of(double value, int digits) {
  const double order = std::floor(std::log10(std::abs(value)));
  return static_cast<std::size_t>(std::clamp(digits - 1 - order, 0.0, double{kTens.size() - 1}));
}

double to_digits(double value, int digits) {
  return value == 0 || !std::isfinite(value) ? value : on_grid(value, decimals_of(value, digits));
}

double down_to_digits(double value, int digits) {
  const double nearest = to_digits(value, digits);
  if (!(nearest > value)) return nearest;
  const std::size_t decimals = decimals_of(value, digits);
  return std::floor(value * kTens[decimals]) / kTens[decimals];
}

void round_pose(PoseRow& pose) {
  put_on_grid(pose.p, kLength);
  pose.w = on_grid(pose.w, kUnit);
  put_on_grid(pose.v, kUnit);
}

}  // namespace

float load_of(double value) {
  return static_cast<float>(to_digits(std::clamp(value, -kLargestLoad, kLargestLoad), kJudgementDigits));
}

void round_geometry(std::span<BladePose> poses) {
  SharedFrame before;
  for (BladePose& pose : poses) {
    Frame frame = pose.frame;
    put_on_grid(frame.origin, kLength);
    put_on_grid(frame.x, kUnit);
    put_on_grid(frame.y, kUnit);
    before = pose.frame = {frame, before};
    elastica::Elastica& blade = pose.blade;
    for (double* length : {&blade.x, &blade.y, &blade.length}) *length = on_grid(*length, kLength);
    blade.theta = on_grid(blade.theta, kUnit);
    for (double* curvature : {&blade.kappa, &blade.lambda1, &blade.lambda2})
      *curvature = to_digits(*curvature, kCurvatureDigits);
    if (pose.foam) put_on_grid(*pose.foam, kLength);
    round_pose(pose.a);
    round_pose(pose.b);
  }
}

void round_judgement(std::span<BladePose> poses) {
  for (BladePose& pose : poses) {
    pose.margin = to_digits(pose.margin, kJudgementDigits);
    if (pose.margin_mm) pose.margin_mm = down_to_digits(*pose.margin_mm, kJudgementDigits);
  }
}

void round_joints(std::span<ClampJoints> joints) {
  for (ClampJoints& pose : joints) {
    put_on_grid(pose.a, kJoint);
    put_on_grid(pose.b, kJoint);
  }
}

}  // namespace hotblade::pipeline

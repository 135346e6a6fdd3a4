#include "pipeline/verify/width_heights.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/pipeline/plan_design.hpp"
#include "tests/pipeline/vault_program.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector3d;

constexpr double kRound_mm = 150, kAcross_mm = 20, kHalfRound_rad = 0.8;

// Part of a cylinder along y, its crest at the origin.
surface::DesignSurface round_design() {
  return grid_design("round", 400, 4, [](double u, double v) {
    const double angle = kHalfRound_rad * (2 * u - 1);
    return Vector3d(kRound_mm * std::sin(angle), 200 * v, kRound_mm * (std::cos(angle) - 1));
  });
}

DesignFaces faces_of(const surface::DesignSurface& design) {
  return {design.mesh, testing::vault_program(), gpu::Backend::kCpu};
}

// Of a blade along y whose middle is so high over the cylinder at an angle from its crest, above it or, in
// the hollow, below; its width leans against the surface.
WidthPlace place_at(double angle, double height_mm, double lean_rad, bool above) {
  const Vector3d up(std::sin(angle), 0, std::cos(angle));
  const double radius = kRound_mm + (above ? height_mm : -height_mm);
  return {radius * up + Vector3d(0, 100, -kRound_mm),
          Vector3d(std::cos(angle + lean_rad), 0, -std::sin(angle + lean_rad)), above ? up : Vector3d(-up)};
}

// By the cylinder itself.
double height_mm(const WidthPlace& at, bool above) {
  constexpr int kPlaces = 2000;
  double least = 1e300;
  for (int k = -kPlaces; k <= kPlaces; ++k) {
    const Vector3d p = at.point + 0.5 * kAcross_mm * k / kPlaces * at.across;
    const double off = std::hypot(p.x(), p.z() + kRound_mm) - kRound_mm;
    least = std::min(least, above ? off : -off);
  }
  return least;
}

TEST(WidthHeights, AreThoseOfThePlaceOfTheWidthThatIsNearest) {
  const surface::DesignSurface design = round_design();
  const DesignFaces faces = faces_of(design);
  double farthest_from_middle = 0;
  for (const bool above : {true, false}) {
    for (const double lean : {-0.3, -0.03, 0.0, 0.02, 0.2}) {
      for (const double angle : {-0.4, 0.0, 0.25}) {
        for (const double middle : {-1.0, 0.5, 3.0}) {
          const WidthPlace at = place_at(angle, middle, lean, above);
          const double height = width_heights(faces, {&at, 1}, kAcross_mm, PastBorder::kNothing,
                                              [](std::size_t) { return 0; })[0];
          // A crest's nearest place may lie between two of the nine.
          EXPECT_NEAR(height, height_mm(at, above), 0.006) << above << " " << lean << " " << angle;
          farthest_from_middle = std::max(farthest_from_middle, middle - height);
        }
      }
    }
  }
  EXPECT_GT(farthest_from_middle, 3);
}

TEST(WidthHeights, OfAPointPastTheBorderNothingIsSaidAndOfAWidthPastItAsAsked) {
  const surface::DesignSurface design = round_design();
  const DesignFaces faces = faces_of(design);
  const auto height = [&](double angle, double lean, PastBorder past) {
    const WidthPlace at = place_at(angle, 1, lean, true);
    return width_heights(faces, {&at, 1}, kAcross_mm, past, [](std::size_t) { return 0; })[0];
  };
  EXPECT_TRUE(std::isinf(height(kHalfRound_rad + 0.02, 0, PastBorder::kPlane)));
  // The half that leans down is past the border: without it the middle is the lowest.
  EXPECT_NEAR(height(kHalfRound_rad - 1e-3, 0.2, PastBorder::kPlane), 1 - 0.5 * kAcross_mm * std::sin(0.2),
              0.05);
  EXPECT_NEAR(height(kHalfRound_rad - 1e-3, 0.2, PastBorder::kNothing), 1, 0.01);
}

}  // namespace
}  // namespace hotblade::pipeline

// Extruded profiles whose rounds are sharper than any blade: blades lie along them.
#include "tests/pipeline/plan/extrusions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/plan/plan.hpp"

namespace hotblade::pipeline {
namespace {

void expect_cut(const surface::DesignSurface& design, std::size_t most_strips) {
  const PlanResult result = plan(design, back_kept(), {});
  EXPECT_THAT(result.refusals, ::testing::IsEmpty());
  EXPECT_GE(result.program.strips.size(), 1U);
  EXPECT_LE(result.program.strips.size(), most_strips);
}

// So sharp rounds as 25 mm take three families, more coefficients or not.
TEST(ExtrusionPlan, NosingsAreCutAsInPlanesGivenAlongTheirFold) {
  for (const double radius : {25.0, 50.0, 90.0}) {
    SCOPED_TRACE(radius);
    const surface::DesignSurface nosing = extruded({radius, M_PI_2, 300, 150, 1000});
    Settings given = back_kept();
    given.slice.direction = {{0, 1, 0}};
    const PlanResult along = plan(nosing, given, {});
    EXPECT_THAT(along.refusals, ::testing::IsEmpty());
    expect_cut(nosing, along.program.strips.size());
  }
}

TEST(ExtrusionPlan, NosingsOfOtherFoldsAndLegsAreCutInSpaceToo) {
  expect_cut(extruded({25, 1.9, 300, 150, 900}), 2);
  expect_cut(extruded({40, M_PI_2, 250, 120, 800, 0.4}, tilted_in_space()), 2);
  expect_cut(extruded({60, 1.3, 420, 90, 700, 0.35}, tilted_in_space()), 2);
}

TEST(ExtrusionPlan, RoundsAndGroovesAreCutAboutAnAxisBeyondTheirCentre) {
  expect_cut(extruded({50, 2.6, 0, 0, 700}), 3);
  expect_cut(extruded({60, 2.4, 0, 0, 700}), 3);
  expect_cut(extruded({35, 2.9, 0, 0, 600}, tilted_in_space()), 3);
  Fold groove{50, 2.6, 0, 0, 700};
  groove.hollow = true;
  expect_cut(extruded(groove), 3);
}

}  // namespace
}  // namespace hotblade::pipeline

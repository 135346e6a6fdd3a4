#include "pipeline/calibrate/estimate.hpp"

#include <gtest/gtest.h>

#include "pipeline/calibrate/simulated_scan.hpp"
#include "tests/pipeline/calibrate/hidden_cell.hpp"

namespace hotblade::pipeline {
namespace {

Eigen::Index at(CellError error, Eigen::Index k = 0) {
  return static_cast<Eigen::Index>(error) + k;
}

// What a scan in the design's frame says of a cell.
Estimate estimate_of(const ErrorVector& truth, ScanRehearsal how, bool fixed) {
  how.moved = false;
  const RehearsedScan scan = rehearsed_scan(testing::panel_program(), 0, truth, how);
  return estimate(
      {{thinned_to(testing::panel_program(), 0, kCutSampleMm), scan.points, Eigen::Isometry3d::Identity()}},
      {.fixed = fixed});
}

TEST(CutWith, PlannedErrorsIsThePlannedSurface) {
  const Program thinned = thinned_to(testing::panel_program(), 0, kCutSampleMm);
  const SweptSurface is = cut_with(thinned, planned_errors(thinned), kCutSampleMm);
  const CutMesh planned(swept_surface(testing::panel_program(), 2.5));
  const std::vector<Foot> feet = planned.feet(is.vertices);
  // Over the first and the last row, which lie past the design's ends, poses pass that the thinned program
  // lacks.
  const int last = is.pose_of_vertex.back();
  double worst = 0;
  for (std::size_t v = 0; v < feet.size(); ++v) {
    if (is.pose_of_vertex[v] > 0 && is.pose_of_vertex[v] < last)
      worst = std::max(worst, std::abs(feet[v].height_mm));
  }
  EXPECT_LT(worst, 0.02) << "facets of 10 mm, whose borders know their slope from one side only; a scan's "
                            "noise is ten times that";
}

TEST(CutWith, ABladeThatIsLongerBowsOutAndAWiderBandGoesDeeper) {
  const Program thinned = thinned_to(testing::panel_program(), 0, kCutSampleMm);
  const ErrorVector planned = planned_errors(thinned);
  ErrorVector longer = planned, wider = planned;
  longer[at(CellError::kLength)] += 1;
  wider[at(CellError::kBand)] += 0.4;
  const SweptSurface from = cut_with(thinned, planned, kCutSampleMm);
  const SweptSurface bowed = cut_with(thinned, longer, kCutSampleMm),
                     deep = cut_with(thinned, wider, kCutSampleMm);
  double out = 0;
  for (std::size_t v = 0; v < from.vertices.size(); ++v) {
    out = std::max(out, (bowed.vertices[v] - from.vertices[v]).norm());
    EXPECT_NEAR((deep.vertices[v] - from.vertices[v]).dot(from.normals[v]), -0.2, 1e-6);
  }
  EXPECT_GT(out, 1) << "a millimetre of length bows a shallow arc by several";
}

TEST(Estimate, OfAPerfectScanOfAFixedBlockIsTheTruth) {
  ErrorVector truth = planned_errors(testing::panel_program());
  truth[at(CellError::kShiftA, 1)] = 0.7;
  truth[at(CellError::kTurnB, 2)] = 0.003;
  truth[at(CellError::kBand)] += 0.2;
  ScanRehearsal how;
  how.noise_mm = how.outliers = 0;
  const Estimate e = estimate_of(truth, how, true);
  EXPECT_LT(e.after.rms_mm, 0.01);
  EXPECT_NEAR(e.value[at(CellError::kShiftA, 1)], 0.7, 0.1);
  EXPECT_NEAR(e.value[at(CellError::kTurnB, 2)], 0.003, 3e-4);
}

// A scanner of 5 micrometres sees less than the facets of the cut err by: what it cannot tell stays doubted.
TEST(Estimate, OfAFineScannerIsWithinItsOwnDoubt) {
  const ErrorVector truth = testing::hidden_errors(testing::panel_program(), 4);
  ScanRehearsal how;
  how.noise_mm = 0.005;
  const Estimate e = estimate_of(truth, how, true);
  EXPECT_LT(e.after.rms_mm, 0.02);
  for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(kCellErrors); ++i) {
    if (!(e.expected[i] > 0)) continue;
    EXPECT_LE(std::abs(e.value[i] - truth[i]), 3.5 * e.sd(static_cast<std::size_t>(i))) << i;
  }
}

TEST(Estimate, DownToTheNoiseAndSaysWhatItCannotTell) {
  const ErrorVector truth = testing::hidden_errors(testing::panel_program(), 7);
  ScanRehearsal how;
  how.outliers = 0.05;
  const Estimate e = estimate_of(truth, how, false);
  EXPECT_NEAR(e.noise_mm, 0.2, 0.02);
  EXPECT_LT(e.after.rms_mm, 0.22);
  EXPECT_GT(e.before.rms_mm, 1.2 * e.after.rms_mm);
  EXPECT_GE(e.told, 4U);
  EXPECT_FALSE(e.told_alone(static_cast<std::size_t>(CellError::kStiffness)));
  // A part that may lie anywhere does not tell where it was cut.
  bool both_aside = false;
  for (const Blend& blend : e.untold)
    both_aside |=
        blend.describe() == "clamp A out of the blade's plane with clamp B out of the blade's plane";
  EXPECT_TRUE(both_aside);
  for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(kCellErrors); ++i) {
    if (!(e.expected[i] > 0)) continue;
    EXPECT_LE(std::abs(e.value[i] - truth[i]), 3.5 * e.sd(static_cast<std::size_t>(i))) << i;
  }
}

TEST(Estimate, OfAScanInTheDesignsFrameTellsWhereTheCutStands) {
  ErrorVector truth = planned_errors(testing::panel_program());
  truth[at(CellError::kShiftA, 2)] = truth[at(CellError::kShiftB, 2)] = 0.8;
  truth[at(CellError::kShiftA, 1)] = truth[at(CellError::kShiftB, 1)] = -0.6;
  const Estimate placed = estimate_of(truth, {}, true), anywhere = estimate_of(truth, {}, false);
  EXPECT_GT(placed.told, anywhere.told);
  EXPECT_NEAR(placed.value[at(CellError::kShiftA, 1)], -0.6, 3 * placed.sd(1));
  EXPECT_LT(placed.sd(1), 0.7 * anywhere.sd(1));
}

TEST(Estimate, OfNoiseAloneTellsNothing) {
  ScanRehearsal how;
  how.noise_mm = 4;
  how.points = 400;
  how.seen = 0.05;
  const Estimate e = estimate_of(planned_errors(testing::panel_program()), how, false);
  EXPECT_TRUE(e.tells_nothing()) << e.told;
  for (std::size_t i = 0; i < kCellErrors; ++i) EXPECT_FALSE(e.told_alone(i));
}

}  // namespace
}  // namespace hotblade::pipeline

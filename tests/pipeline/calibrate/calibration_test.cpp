#include "pipeline/calibrate/calibration.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "pipeline/calibrate/simulated_scan.hpp"
#include "pipeline/settings/error.hpp"
#include "tests/pipeline/calibrate/hidden_cell.hpp"
#include "tests/pipeline/temporary_directory.hpp"

namespace hotblade::pipeline {
namespace {

MeasuredCut scan_of(const Program& program, const ErrorVector& errors, const ScanRehearsal& how = {}) {
  return {0, "scan.csv", rehearsed_scan(program, 0, errors, how).points};
}

std::string refusal(const Program& program, const MeasuredCut& scan,
                    ScanPlacement placement = ScanPlacement::kSearch) {
  try {
    (void)calibrate(program, {scan}, placement);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind, ErrorKind::kBadInput);
    EXPECT_TRUE(std::string(error.what()).starts_with("scan.csv: ")) << error.what();
    return error.what();
  }
  return "calibrated";
}

TEST(Calibration, ItsFileIsTheSettingsThatItFound) {
  const ErrorVector truth = testing::hidden_errors(testing::panel_program(), 5);
  const Calibration found =
      calibrate(testing::panel_program(), {scan_of(testing::panel_program(), truth)}, ScanPlacement::kSearch);
  EXPECT_LT(found.estimate.after.rms_mm, 0.25);
  const testing::TemporaryDirectory directory;
  std::ofstream(directory / "calibration.toml") << calibration_toml(testing::panel_program(), found);
  const Settings is = resolve({{directory / "calibration.toml"}, {}, {}}),
                 should = calibrated(testing::panel_program(), found);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(is.machine.clamps.a.shift_mm[k], should.machine.clamps.a.shift_mm[k], 1e-4);
    EXPECT_NEAR(is.machine.clamps.b.turn_rad[k], should.machine.clamps.b.turn_rad[k], 1e-6);
  }
  EXPECT_NEAR(is.blade.length_error_mm, should.blade.length_error_mm, 1e-4);
  EXPECT_NEAR(is.blade.band_mm(7), should.blade.band_mm(7), 1e-3);
  const auto json = nlohmann::json::parse(to_json(found, &truth));
  EXPECT_EQ(json["numbers"].size(), kCellErrors);
  EXPECT_EQ(json["told"], found.estimate.told);
  EXPECT_NE(describe(found).find("The stiffness E t^3 changes forces and sag only"), std::string::npos);
}

TEST(Calibration, AScanOfHalfTheCutDoesToo) {
  ScanRehearsal how;
  how.seen = 0.5;
  how.seed = 3;
  const Calibration found =
      calibrate(testing::panel_program(),
                {scan_of(testing::panel_program(), testing::hidden_errors(testing::panel_program(), 3), how)},
                ScanPlacement::kSearch);
  EXPECT_LT(found.estimate.after.rms_mm, 0.25);
  EXPECT_GE(found.estimate.told, 3U);
}

// Foam that melts wider where the blade is slower, cut at half the speed: by the executed times it melts as
// planned, by the planned ones it would be other foam.
TEST(Calibration, TheTimesThatWereExecutedTellTheBand) {
  Settings settings = testing::panel_settings();
  settings.blade.melt = {{}, 11.7, 4.7};
  const Program planned = plan(testing::crooked_panel(), settings, {}).program;
  Program executed = planned;
  for (BladePose& pose : executed.strips[0].poses) pose.t *= 2;
  ScanRehearsal how;
  how.moved = false;
  how.points = 8000;
  const MeasuredCut scan = scan_of(executed, planned_errors(executed), how);
  const Estimate by_executed = calibrate(executed, {scan}, ScanPlacement::kFixed).estimate,
                 by_planned = calibrate(planned, {scan}, ScanPlacement::kFixed).estimate;
  const auto band = static_cast<std::size_t>(CellError::kBand);
  const auto band_mm = [&](const Estimate& e) { return e.value[static_cast<Eigen::Index>(band)]; };
  // A wider band and clamps that stand higher are nearly the same cut: the number has its uncertainty.
  EXPECT_NEAR(band_mm(by_executed), 1, 2 * by_executed.sd(band)) << "the band at the feed, as planned";
  // What half the feed melts, 1.43 mm, taken for the feed's; the clamps take the rest of it.
  EXPECT_GT(band_mm(by_planned) - band_mm(by_executed), 0.25);
}

TEST(Calibration, AWrongUnitIsNamed) {
  MeasuredCut scan = scan_of(testing::panel_program(), planned_errors(testing::panel_program()));
  const auto scaled = [&](double by) {
    MeasuredCut wrong = scan;
    for (Eigen::Vector3d& p : wrong.points) p *= by;
    return refusal(testing::panel_program(), wrong);
  };
  EXPECT_NE(scaled(1e-3).find("say --units m"), std::string::npos);
  EXPECT_NE(scaled(1 / 25.4).find("say --units in"), std::string::npos);
  EXPECT_NE(scaled(25.4).find("read as inches"), std::string::npos);
  EXPECT_NE(scaled(1e3).find("read as metres"), std::string::npos);
}

TEST(Calibration, SomethingElseDoesNotFit) {
  MeasuredCut ball{0, "scan.csv", {}};
  for (int i = 0; i < 3000; ++i) {
    const double z = 2 * (i + 0.5) / 3000 - 1, turn = 2.399963 * i, r = std::sqrt(1 - z * z);
    ball.points.emplace_back(300 * r * std::cos(turn), 300 * r * std::sin(turn), 300 * z);
  }
  const std::string said = refusal(testing::panel_program(), ball);
  EXPECT_NE(said.find("fit"), std::string::npos) << said;
}

// Of a wavy panel: within reach of the cut, and no cell's.
TEST(Calibration, AScanThatNoCellExplainsIsRefused) {
  ScanRehearsal how;
  how.moved = false;
  MeasuredCut scan = scan_of(testing::panel_program(), planned_errors(testing::panel_program()), how);
  for (Eigen::Vector3d& p : scan.points) p.z() += 3 * std::sin(p.x() / 20);
  const std::string said = refusal(testing::panel_program(), scan, ScanPlacement::kFixed);
  EXPECT_NE(said.find("does not fit the cut"), std::string::npos) << said;
}

TEST(Calibration, ACutThatLooksTheSameFromTwoSidesIsRefusedWithTheTurn) {
  const Program cylinder = plan(cylinder_design(), along_x(), {}).program;
  const MeasuredCut scan = scan_of(cylinder, planned_errors(cylinder));
  const std::string said = refusal(cylinder, scan);
  EXPECT_NE(said.find("turned by 180 degrees"), std::string::npos) << said;
  EXPECT_NE(said.find("--placement near"), std::string::npos) << said;
  ScanRehearsal how;
  how.moved = false;
  EXPECT_NO_THROW(
      (void)calibrate(cylinder, {scan_of(cylinder, planned_errors(cylinder), how)}, ScanPlacement::kNear));
}

TEST(Calibration, AStraightBladeIsRefused) {
  const Program flat =
      plan(grid_design("flat", 10, 10,
                       [](double u, double v) { return Eigen::Vector3d(300 * u, 300 * v, 50); }),
           along_x(), {})
          .program;
  ASSERT_FALSE(flat.strips.empty());
  MeasuredCut scan = scan_of(testing::panel_program(), planned_errors(testing::panel_program()));
  EXPECT_NE(refusal(flat, scan).find("nearly straight"), std::string::npos);
}

TEST(Calibration, AScanThatTellsNothingWritesNothing) {
  ScanRehearsal how;
  how.noise_mm = 4;
  how.points = 400;
  how.seen = 0.05;
  how.moved = false;
  const MeasuredCut scan = scan_of(testing::panel_program(), planned_errors(testing::panel_program()), how);
  const std::string said = refusal(testing::panel_program(), scan, ScanPlacement::kNear);
  EXPECT_NE(said.find("tells nothing"), std::string::npos) << said;
}

}  // namespace
}  // namespace hotblade::pipeline

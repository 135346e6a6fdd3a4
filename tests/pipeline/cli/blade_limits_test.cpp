// Designs that no blade of the list can cut, refused from outside: which strip, rib, limit, and by how much.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <regex>
#include <sstream>

#include "elastica/curve/elastica.hpp"
#include "tests/pipeline/run_program.hpp"
#include "tests/pipeline/temporary_directory.hpp"

namespace hotblade::pipeline {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using testing::Ended;
using ::testing::HasSubstr;
using testing::hotblade;

class BladeLimits : public ::testing::Test {
 protected:
  // A profile in y and z, drawn along x over 200 mm.
  std::string extruded(const std::vector<Eigen::Vector2d>& profile) {
    const auto file = files_ / "design.obj";
    std::ofstream out(file);
    out.precision(17);
    constexpr int kRows = 4;
    for (int i = 0; i <= kRows; ++i) {
      for (const Eigen::Vector2d& q : profile)
        out << "v " << 200.0 * i / kRows << " " << q.x() << " " << q.y() << "\n";
    }
    const auto n = static_cast<int>(profile.size());
    for (int i = 0; i < kRows; ++i) {
      for (int j = 0; j + 1 < n; ++j) {
        const int a = i * n + j + 1, c = a + n;
        out << "f " << a << " " << c << " " << c + 1 << " " << a + 1 << "\n";
      }
    }
    return file.string();
  }

  std::string arc(double radius, double turn) {
    std::vector<Eigen::Vector2d> profile;
    for (int i = 0; i <= 80; ++i) {
      const double phi = turn * (i / 80.0 - 0.5);
      profile.emplace_back(radius * std::sin(phi), radius * std::cos(phi));
    }
    return extruded(profile);
  }

  Ended plan(const std::string& design, const std::vector<std::string>& settings) {
    std::vector<std::string> args{
        "plan", design, "--units", "mm", "--set", "slice.direction=[1,0,0]", "-o", (files_ / "cut").string()};
    for (const std::string& s : settings) {
      args.push_back("--set");
      args.push_back(s);
    }
    return hotblade(args);
  }

  [[nodiscard]] nlohmann::json refusal() const {
    return nlohmann::json::parse(testing::read_bytes(files_ / "cut" / "report.json"))["refusals"].at(0);
  }

  testing::TemporaryDirectory files_;
};

TEST_F(BladeLimits, ARibThatWouldYieldIsRefusedByStripRibRadiusAndAmount) {
  const Ended ended = plan(arc(50, 2.0), {});
  EXPECT_EQ(ended.code, 4);
  EXPECT_THAT(ended.err,
              ContainsRegex("S001 at \\(.*radius of a rib .*yield.* [45][0-9.]+ mm \\(limit 70\\.54 mm\\)"));
}

TEST_F(BladeLimits, AWavyRibThatWouldSnapThroughIsRefusedByItsMargin) {
  // More than two periods of an elastica: exactly what one blade could be bent to, if it stayed there.
  const double rate = 2 * 3.19 / 240;  // sqrt(lambda1) for a period of about 240 mm
  const elastica::Elastica wave{0, 0, 0.5, 0, rate * rate, 0, 530};
  std::vector<Eigen::Vector2d> profile;
  for (const auto& p : elastica::sample(wave, 400)) profile.push_back(p.position());
  const Ended ended = plan(extruded(profile), {"fit.max_splits=0"});
  EXPECT_EQ(ended.code, 4);
  EXPECT_THAT(ended.err, ContainsRegex("S001 at \\(.*deviation [0-9.]+ mm \\(limit 1 mm\\)"));
}

TEST_F(BladeLimits, AMarginThatNoBladeKeepsIsRefusedWithWhatStoppedEachLength) {
  const Ended ended = plan(arc(400, 0.6), {"blade.min_margin=1000", "fit.max_splits=0"});
  EXPECT_EQ(ended.code, 4);
  EXPECT_THAT(
      ended.err,
      ContainsRegex("S001.* about \\(.*stability margin \\(snap-through\\) [0-9.]+ \\(limit 1000\\)"));
  EXPECT_EQ(refusal()["details"].size(), 6u);
}

TEST_F(BladeLimits, AClampInsideTheStockIsRefusedByItsClearance) {
  const Ended ended = plan(arc(400, 0.6), {"blade.free_lengths_mm=[250]", "stock.clearance_mm=130",
                                           "motion.approach_mm=200", "fit.max_splits=0"});
  EXPECT_EQ(ended.code, 4);
  EXPECT_THAT(ended.err,
              ContainsRegex("S001 about \\(.*clamp clearance to the stock [0-9.]+ mm \\(limit 137.5 mm\\)"));
}

TEST_F(BladeLimits, VerifyRefusesAProgramWhoseBladeWouldYieldInItsSteel) {
  const std::string design = arc(400, 0.6);
  ASSERT_EQ(plan(design, {}).code, 0);
  const auto file = files_ / "cut" / "program.json";
  const auto verify = [&] { return hotblade({"verify", file.string(), "--design", design}); };
  const Ended sound = verify();
  EXPECT_EQ(sound.code, 0) << sound.out << sound.err;
  EXPECT_THAT(sound.out, HasSubstr("held on one branch"));
  auto program = nlohmann::ordered_json::parse(testing::read_bytes(file));
  program["blade"]["yield_strength_mpa"] = 100;
  program["blade"]["max_curvature_per_mm"] = 2 * 100 / (1.5 * 190000 * 0.5);  // 712.5 mm
  std::ofstream(file) << program.dump();
  const Ended weak = verify();
  EXPECT_EQ(weak.code, 4);
  EXPECT_THAT(weak.out, ContainsRegex("S001.*blade radius.* mm \\(limit 712.5 mm\\)"));
}

TEST_F(BladeLimits, VerifyRefusesAProgramThatSaysOtherThanItsRibsMeasure) {
  const std::string design = arc(400, 0.6);
  ASSERT_EQ(plan(design, {}).code, 0);
  const auto file = files_ / "cut" / "program.json";
  const auto verify = [&] { return hotblade({"verify", file.string(), "--design", design}); };
  EXPECT_THAT(verify().out, ContainsRegex("ribs [0-9]+: .* measured again, as the program says"));
  auto program = nlohmann::ordered_json::parse(testing::read_bytes(file));
  auto& hausdorff = program["strips"][0]["ribs"][1]["hausdorff_mm"];
  hausdorff = hausdorff.get<double>() + 0.01;
  std::ofstream(file) << program.dump();
  const Ended flattered = verify();
  EXPECT_EQ(flattered.code, 5);
  EXPECT_THAT(flattered.out, ContainsRegex("S001R002: hausdorff_mm is .* in the program, .* when measured"));
  EXPECT_THAT(flattered.out, ContainsRegex("ribs [0-9]+: 1 numbers are not what was measured"));
}

// The program says truly how far its Bezier lies, and that is too far.
TEST_F(BladeLimits, VerifyRefusesAProgramWhoseBezierDoesNotStandForItsElastica) {
  const std::string design = arc(400, 0.6);
  ASSERT_EQ(plan(design, {}).code, 0);
  const auto file = files_ / "cut" / "program.json";
  const auto verify = [&](const char* json = nullptr) {
    std::vector<std::string> words{"verify", file.string(), "--design", design};
    if (json) words.emplace_back(json);
    return hotblade(words);
  };
  EXPECT_THAT(verify().out,
              ContainsRegex("Beziers of [0-9]+ ribs off their elastica: max .*, 0 over 0.1 mm"));
  auto program = nlohmann::ordered_json::parse(testing::read_bytes(file));
  auto& rib = program["strips"][0]["ribs"][1];
  for (auto& point : rib["bezier"]) point[1] = point[1].get<double>() + 0.25;
  std::ofstream(file) << program.dump();
  std::istringstream said(verify().out);
  const std::regex measured("S001R002: ([a-z0-9_]+) is .* in the program, (.*) when measured.*");
  std::smatch match;
  for (std::string line; std::getline(said, line);) {
    if (std::regex_match(line, match, measured)) rib[match[1].str()] = std::stod(match[2]);
  }
  std::ofstream(file) << program.dump();
  const Ended moved = verify();
  EXPECT_EQ(moved.code, 5);
  EXPECT_THAT(moved.out, ContainsRegex("ribs [0-9]+: .* measured again, as the program says"));
  EXPECT_THAT(
      moved.out,
      ContainsRegex("strip S001, rib S001R002: Bezier 0.2[0-9]* mm off its elastica \\(limit 0.1 mm\\)"));
  const auto report = nlohmann::json::parse(verify("--json").out);
  EXPECT_EQ(report["rib_mismatches"], 0);
  ASSERT_EQ(report["far_beziers"].size(), 1u);
  EXPECT_EQ(report["far_beziers"][0]["strip"], "S001");
  EXPECT_EQ(report["far_beziers"][0]["rib"], "S001R002");
  EXPECT_NEAR(report["far_beziers"][0]["hausdorff_mm"], 0.25, 0.05);
  EXPECT_NEAR(report["bezier_limit_mm"], 0.1, 1e-12);
}

TEST_F(BladeLimits, PosesCarryMarginLoadsAndSag) {
  const std::string design = arc(400, 0.6);
  ASSERT_EQ(plan(design, {}).code, 0);
  const auto program = nlohmann::json::parse(testing::read_bytes(files_ / "cut" / "program.json"));
  for (const auto& pose : program["strips"][0]["poses"]) {
    EXPECT_GT(pose["margin"], 1);
    EXPECT_GT(pose["loads"]["stress_mpa"], 0);
    EXPECT_GT(pose["loads"]["droop_mm"], 0);
    EXPECT_EQ(pose["loads"]["in_plane_sag_mm"], 0);
  }
  EXPECT_GT(program["verification"]["budget_mm"]["clamp_error"], 0);
  EXPECT_GT(program["verification"]["budget_mm"]["gravity_droop"], 0);
}

}  // namespace
}  // namespace hotblade::pipeline

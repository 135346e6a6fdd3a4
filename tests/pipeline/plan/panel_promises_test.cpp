// What docs/promises.md says of plans, on panels that nobody tuned for, by other code than the planner's.
// HOTBLADE_PANEL_SEEDS=77,78 takes all panels of these seeds in place of six of one.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include "elastica/blade/stability.hpp"
#include "pipeline/plan/plan.hpp"
#include "pipeline/verify/as_cut.hpp"
#include "pipeline/verify/verify.hpp"
#include "robot/blade/blade_section.hpp"
#include "samples/panels.hpp"
#include "surface/read/design_surface.hpp"
#include "tests/pipeline/clamp_motion.hpp"
#include "tests/pipeline/executed.hpp"
#include "tests/pipeline/way_home.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector3d;
using samples::Panel;

struct Drawn {
  std::uint64_t seed = 0;
  std::size_t number = 0;
};

std::vector<Drawn> drawn() {
  std::vector<Drawn> list;
  const char* seeds = std::getenv("HOTBLADE_PANEL_SEEDS");
  if (!seeds) {
    // Two classic surfaces, patches of each kind, turned in space and not.
    constexpr std::uint64_t kSeed = 5;
    for (const std::size_t number : {3, 10, 12, 19, 23, 38}) list.push_back({kSeed, number});
    return list;
  }
  std::istringstream text(seeds);
  for (std::string seed; std::getline(text, seed, ',');) {
    for (std::size_t number = 0; number < samples::kPanels; ++number)
      list.push_back({std::stoull(seed), number});
  }
  return list;
}

surface::DesignSurface design_of(const Panel& panel) {
  const testing::TemporaryDirectory directory;
  const std::filesystem::path file = directory / "panel.obj";
  std::ofstream(file) << samples::obj_text(panel);
  return surface::read_obj(file, {"mm", 'z'});
}

Settings panel_settings() {
  Settings settings;
  settings.design.units = "mm";
  settings.design.keep = Keep::kBack;
  return settings;
}

class PanelPromises : public ::testing::TestWithParam<Drawn> {
 protected:
  static Panel panel() {
    static std::uint64_t held = 0;
    static std::vector<Panel> all;
    if (all.empty() || held != GetParam().seed) all = samples::panels(held = GetParam().seed);
    return all.at(GetParam().number);
  }
};

// The bend of a blade from the angles of its points, at the middle of each two.
double sharpest_per_mm(const elastica::Elastica& blade) {
  constexpr int kPoints = 400;
  const auto points = elastica::sample(blade, kPoints);
  const double step = blade.length / (kPoints - 1);
  double sharpest = 0;
  for (std::size_t i = 1; i < points.size(); ++i)
    sharpest = std::max(sharpest, std::abs(points[i].theta - points[i - 1].theta) / step);
  return sharpest;
}

void expect_blade_is_safe(const Strip& strip, const Settings& settings) {
  const double limit = robot::max_curvature_per_mm(settings.blade);
  Eigen::Matrix3d axes;
  const Frame& f = strip.block.frame;
  axes << f.x, f.y, f.normal();
  const Eigen::AlignedBox3d stock(Vector3d::Zero(), strip.block.size_mm);
  double sharpest = 0, nearest_mm = 1e9;
  constexpr std::size_t kEvery = 8;
  for (std::size_t i = 0; i < strip.poses.size(); ++i) {
    const BladePose& pose = strip.poses[i];
    for (const PoseRow& clamp : {pose.a, pose.b})
      nearest_mm = std::min(nearest_mm, stock.exteriorDistance(axes.transpose() * (clamp.p - f.origin)));
    if (i % kEvery != 0) continue;
    EXPECT_GT(elastica::stability_margin(pose.blade), 1) << strip.id << " pose " << i;
    sharpest = std::max(sharpest, sharpest_per_mm(pose.blade));
  }
  EXPECT_LE(sharpest, limit) << strip.id << " yields";
  EXPECT_GE(nearest_mm, settings.stock.clearance_mm) << strip.id << ": a clamp near the foam";
}

void expect_promises(const Panel& panel) {
  const Settings settings = panel_settings();
  const surface::DesignSurface design = design_of(panel);
  const PlanResult result = plan(design, settings, {});
  ASSERT_EQ(result.program.verification.status, VerificationStatus::kPassed)
      << (result.refusals.empty() ? "" : describe(result.refusals.front()));

  // By the text alone: what the clamps do.
  const testing::Most most = testing::measured(result);
  EXPECT_LE(most.speed, settings.motion.travel_mm_s);
  EXPECT_LE(most.turn, settings.motion.angular_rad_s);
  EXPECT_LE(most.accel, settings.motion.accel_mm_s2);
  EXPECT_LE(most.turn_accel, settings.motion.angular_accel_rad_s2);

  // The blade, its way home, its foam.
  for (const Strip& strip : result.program.strips) {
    expect_blade_is_safe(strip, settings);
    const testing::Travelled home = testing::measured_way_home(strip, settings.blade.width_mm);
    EXPECT_GE(home.clearance_mm, 40) << strip.id;
    EXPECT_LT(home.bent_mm, 1e-3 + home.chords_mm) << strip.id;
  }

  // Measured again from the program's text: deviation, branches from the clamps alone, Beziers.
  const testing::Executed executed(result.program);
  VerifyOptions options;
  options.tolerance_mm = settings.design.tolerance_mm;
  options.max_uncut_share = settings.design.max_uncut_share;
  options.min_margin = settings.blade.min_margin;
  const VerifyReport again = verify(executed.work.program, design, options);
  EXPECT_TRUE(again.within_tolerance) << again.deviation.max << " mm";
  EXPECT_TRUE(again.holds());

  // A dense grid finds no place of the design that the bound does not hold, and no larger deviation worth
  // naming. What of the cut goes on for up to a millimetre past the border is compared with the last facet's
  // plane, by samples only.
  VerifyOptions dense = options;
  dense.sample_mm = dense.widest = 1;
  const VerifyReport densely =
      measure(swept_surface(executed.work.program, dense.sample_mm), executed.work.program, design, dense);
  EXPECT_LE(densely.deviation.max, again.bound_mm + 0.015 * options.tolerance_mm);
  EXPECT_NEAR(densely.deviation.max, again.deviation.max, 0.02 * options.tolerance_mm);
  EXPECT_NEAR(densely.deviation.p99, again.deviation.p99, 0.03 * options.tolerance_mm);
  EXPECT_NEAR(densely.uncut_mm2, again.uncut_mm2, 1e-3 * again.area_mm2);
  EXPECT_TRUE(again.ribs.far.empty());
  EXPECT_TRUE(again.ribs.mismatches.empty());

  // As a controller executed it, from its log alone.
  const AsCutReport cut =
      as_cut(executed.work.program, read_executed(executed.work, executed.log), design, options);
  EXPECT_TRUE(cut.cut.within_tolerance) << cut.cut.deviation.max << " mm";
  EXPECT_GE(cut.budget_sum_mm(), cut.cut.deviation.max);
}

TEST_P(PanelPromises, Hold) {
  expect_promises(panel());
}

// A dome with a dent and a window: followed as closely as its samples ask for, its blades would snap.
TEST(DentedPanelPromises, Hold) {
  expect_promises(samples::dented_panels(1)[30]);
}

// A tube of 206 degrees cut to a hexagon: its strips have axes of their own.
TEST(ShellPanelPromises, Hold) {
  const samples::Panel tube = samples::shell_panels(1)[8];
  ASSERT_EQ(tube.name, "s08_tube");
  expect_promises(tube);
}

struct Passed {
  std::size_t strips = 0;
  double deviation_mm = 0;
  double used_share =
      0;  // of the tolerance, by what the plan may not exceed: deviation and the blade's weight
};

Passed passed(const Panel& panel) {
  const PlanResult result = plan(design_of(panel), panel_settings(), {});
  EXPECT_EQ(result.program.verification.status, VerificationStatus::kPassed)
      << panel.name << ": " << (result.refusals.empty() ? "" : describe(result.refusals.front()));
  const double deviation_mm = result.verification.deviation.max;
  double sag_mm = 0;
  for (const auto& [line, mm] : result.program.verification.budget_mm)
    if (line.starts_with("gravity")) sag_mm += mm;
  return {result.strips.size(), deviation_mm, (deviation_mm + sag_mm) / panel_settings().design.tolerance_mm};
}

// A trimmed tube of 236 degrees, longer than two blocks: planes square to it need three parts along it before
// any strip is as long as a block, and are split on from there.
TEST(ShellPanels, LongTubesAreCutIntoRingsOfArcs) {
  const samples::Panel tube = samples::shell_panels(640317)[8];
  ASSERT_EQ(tube.name, "s08_tube");
  EXPECT_LE(passed(tube).strips, 8U);
}

// 246 degrees: three arcs alike, each seam square to the tube. By their widths, the outer two of three parts
// would be arcs of 103 degrees.
TEST(ShellPanels, TubesOfMoreThanHalfATurnAreCutIntoArcsAlike) {
  const samples::Panel tube = samples::shell_panels(90011)[16];
  ASSERT_EQ(tube.name, "s16_tube");
  EXPECT_LE(passed(tube).strips, 3U);
}

TEST_P(PanelPromises, TakeAsManyStripsWhereverThePanelLiesAndHoweverItsQuadrilateralsAreCut) {
  const Panel is = panel();
  const Passed here = passed(is);
  Panel moved = is;
  const Eigen::AngleAxisd turn(0.7 + 0.1 * static_cast<double>(GetParam().number), Vector3d::UnitZ());
  for (Vector3d& p : moved.points) p = turn * p + Vector3d(12345.6, -7654.3, 987.6);
  // About the vertical, so that its weight pulls as it did: the same plan, turned.
  const Passed there = passed(moved);
  EXPECT_EQ(there.strips, here.strips) << "turned and moved";
  // A fit goes on until a step gains nothing; rounding of the coordinates may end it a step earlier.
  constexpr double kStepMm = 0.01;
  EXPECT_NEAR(there.deviation_mm, here.deviation_mm, kStepMm) << "turned and moved";
  // Two triangles of a cell follow each other and share the diagonal between their first and third, and first
  // and second corners.
  Panel other = is;
  for (std::size_t i = 0; i + 1 < other.triangles.size(); ++i) {
    auto &s = other.triangles[i], &t = other.triangles[i + 1];
    if (s[0] != t[0] || s[2] != t[1]) continue;
    const std::array<int, 4> cell{s[0], s[1], s[2], t[2]};
    s = {cell[0], cell[1], cell[3]};
    t = {cell[1], cell[2], cell[3]};
    ++i;
  }
  EXPECT_NE(other.triangles, is.triangles);
  const Passed cut_otherwise = passed(other);
  // Another surface: cells that are twisted lie elsewhere by up to a quarter of their twist. Where less than
  // that is left of the tolerance, it may take a strip more or less.
  constexpr double kNearlyUsed = 0.95;
  if (std::max(here.used_share, cut_otherwise.used_share) < kNearlyUsed) {
    EXPECT_EQ(cut_otherwise.strips, here.strips) << "other diagonals";
  } else {
    EXPECT_LE(std::max(cut_otherwise.strips, here.strips) - std::min(cut_otherwise.strips, here.strips), 1)
        << "other diagonals";
  }
}

INSTANTIATE_TEST_SUITE_P(Drawn, PanelPromises, ::testing::ValuesIn(drawn()),
                         [](const ::testing::TestParamInfo<Drawn>& panel) {
                           return "seed" + std::to_string(panel.param.seed) + "_panel" +
                                  std::to_string(panel.param.number);
                         });

}  // namespace
}  // namespace hotblade::pipeline

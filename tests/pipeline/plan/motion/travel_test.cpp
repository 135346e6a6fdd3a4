#include "pipeline/plan/motion/travel.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <numbers>

#include "pipeline/plan/motion/motion.hpp"
#include "pipeline/plan/plan.hpp"
#include "pipeline/program/read_design.hpp"
#include "tests/paths.hpp"
#include "tests/pipeline/plan_design.hpp"
#include "tests/pipeline/way_home.hpp"

namespace hotblade::pipeline {
namespace {

using testing::Travelled;

const std::filesystem::path kSamples = std::filesystem::path(hotblade::testing::source_dir()) / "samples";

Program planned(const surface::DesignSurface& design, const Settings& settings) {
  return plan(design, settings, {}).program;
}

Program planned_sample(const std::string& name) {
  SettingsSources sources;
  sources.files.emplace_back(kSamples / (name + ".toml"));
  const Settings settings = resolve(sources);
  return planned(read_design(kSamples / (name + ".obj"), settings.design), settings);
}

// `around_mm`: how far from the stock the way may keep; of a fan more, whose planes see it tilted.
void expect_clear_way_home(const Program& program, double around_mm = 70) {
  for (const Strip& strip : program.strips) {
    const Travelled found = testing::measured_way_home(strip, program.blade.width_mm);
    EXPECT_GT(found.seconds, 1) << strip.id;
    EXPECT_GE(found.clearance_mm, 40) << strip.id;
    EXPECT_LT(found.clearance_mm, 40 + around_mm) << strip.id;  // around the stock, not around the table
    EXPECT_LT(found.bent_mm, 0.01) << strip.id;                 // a rigid motion, but for chords of it
    const BladePose &first = strip.poses.front(), &last = strip.poses.back();
    EXPECT_EQ(last.phase, StripPhase::kTravel);
    const auto middle = [&](const BladePose& pose) {
      const auto m = elastica::point_at(pose.blade, pose.blade.length / 2);
      return std::pair{pose.frame.point(m.x, m.y), Eigen::Vector3d(std::cos(m.theta) * pose.frame.x() +
                                                                   std::sin(m.theta) * pose.frame.y())};
    };
    EXPECT_LT((middle(first).first - middle(last).first).norm(), 1e-6) << strip.id;
    EXPECT_LT((middle(first).second - middle(last).second).norm(), 1e-9) << strip.id;
  }
}

TEST(Travel, KeepsTheWholeBladeClearOfTheStockOnACylinder) {
  expect_clear_way_home(planned(cylinder_design(), along_x()));
}

TEST(Travel, KeepsTheWholeBladeClearOfTheStockOnAHypar) {
  expect_clear_way_home(planned_sample("hypar"));
}

TEST(Travel, KeepsTheWholeBladeClearOfTheStockOnAnSWall) {
  expect_clear_way_home(planned_sample("s_wall"));
}

TEST(Travel, KeepsTheWholeBladeClearOfTheStockInAFan) {
  expect_clear_way_home(planned_sample("corner"), 150);
}

// A barrel of meridian arcs, all the way round: four blocks of a quarter each.
TEST(Travel, KeepsTheWholeBladeClearOfTheStockInTheSectorsOfARing) {
  surface::DesignSurface barrel = grid_design("barrel", 144, 24, [](double u, double v) {
    const double a = 2 * std::numbers::pi * u, out = 250 + 20 * (1 - (2 * v - 1) * (2 * v - 1));
    return Eigen::Vector3d(out * std::cos(a), out * std::sin(a), 200 * v);
  });
  Settings settings;
  settings.design.units = "mm";
  settings.design.keep = Keep::kBack;
  settings.machine.plinth_mm = 400;
  settings.slice.fan_axis = {{0, 0, 0, 0, 0, 1}};
  const PlanResult ring = plan(barrel, settings, {});
  EXPECT_EQ(ring.program.verification.status, VerificationStatus::kPassed);
  EXPECT_GE(ring.strips.size(), 2u);
  EXPECT_LT(ring.verification.uncut_share(), 1e-3);
  expect_clear_way_home(ring.program, 150);
}

TEST(IsClear, SaysSoOnlyOfABladeThatIs) {
  Block stock;
  stock.frame = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  stock.size_mm = {500, 300, 200};
  const Frame plane{{0, 150, 300}, {1, 0, 0}, {0, 0, 1}};
  // A straight blade 100 mm above the block.
  const auto above = [&](double clearance_mm) {
    return is_clear({-100, 0, 0, 0, 0, 0, 700}, plane, stock, 8, clearance_mm);
  };
  EXPECT_TRUE(above(98.9));
  EXPECT_FALSE(above(100.001));
  EXPECT_TRUE(is_clear({-100, 1e5, 0, 0, 0, 0, 700}, plane, stock, 8, 100));
  EXPECT_FALSE(is_clear({-100, -150, 0, 0, 0, 0, 700}, plane, stock, 8, 0)) << "through the block";
  // One that comes near only with a few millimetres of its length: a slender bow, down to 20 mm above.
  const elastica::Elastica bow{-100, 100, -0.5, 1 / 700., 0, 0, 700};
  double least = 1e9;
  for (double s = 0; s <= 700; s += 0.01) {
    const elastica::CurvePoint p = elastica::point_at(bow, s);
    for (const double side : {-4.0, 4.0})
      least = std::min(least, stock.distance_mm(plane.point(p.x, p.y) + side * plane.normal()));
  }
  EXPECT_GT(least, 20);
  EXPECT_TRUE(is_clear(bow, plane, stock, 8, least - 1.1));
  EXPECT_FALSE(is_clear(bow, plane, stock, 8, least + 0.01));
}

}  // namespace
}  // namespace hotblade::pipeline

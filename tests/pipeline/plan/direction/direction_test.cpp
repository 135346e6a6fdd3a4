// The search of directions and fans: which one wins, and that the search's short cuts do not decide it.
#include "pipeline/plan/direction/direction.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "pipeline/plan/direction/body_axes.hpp"
#include "pipeline/plan/plan.hpp"
#include "pipeline/program/read_design.hpp"
#include "tests/paths.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector3d;

Eigen::Isometry3d placement() {
  Eigen::Isometry3d t = Eigen::Isometry3d::Identity();
  t.rotate(Eigen::AngleAxisd(0.9, Vector3d(0.7, 1, -0.6).normalized()));
  t.translation() = Vector3d(2500, -700, 130);
  return t;
}

Settings search_settings() {
  Settings settings;
  settings.design.units = "mm";
  settings.design.keep = Keep::kBack;
  settings.machine.plinth_mm = 400;  // blades of a fan lean
  return settings;
}

struct Sample {
  surface::DesignSurface design;
  Settings settings;
};

// A sample with its direction and axis left out, moved by `placed`.
Sample sample(const std::string& name, const Eigen::Isometry3d& placed = Eigen::Isometry3d::Identity()) {
  const auto base = std::filesystem::path(hotblade::testing::source_dir()) / "samples" / name;
  SettingsSources sources;
  sources.files.emplace_back(base.string() + ".toml");
  Sample s{{}, resolve(sources)};
  s.settings.slice.direction.reset();
  s.settings.slice.fan_axis.reset();
  s.design = read_design(base.string() + ".obj", s.settings.design);
  surface::TriangleSoup soup = s.design.mesh.soup();
  for (Vector3d& p : soup.vertices) p = placed * p;
  s.design.mesh = surface::TriangleMesh(std::move(soup));
  return s;
}

// An axis' angle to `d` and distance of `p` from it.
void expect_axis(const DirectionScore& score, const Vector3d& p, const Vector3d& d, double rad, double mm) {
  ASSERT_TRUE(score.fan);
  const Vector3d u = score.fan->direction.normalized();
  EXPECT_LT(u.cross(d).norm(), rad);
  EXPECT_LT(u.cross(p - score.fan->point).norm(), mm);
}

TEST(FanSearch, FindsTheAxisOfTheCornerAndPlansAsWellAsWithIt) {
  Sample s = sample("corner");
  s.settings.slice.gaps = Gaps::kApart;  // ribs one by one, as fans have them
  const PlanResult found = plan(s.design, s.settings, {});
  // The file's coordinates are rounded to 5e-7 mm. An end's plane is seen over 80 mm of rise and 400 mm of
  // width, and is met 700 mm away.
  const double rad = 4 * 5e-7 / 80;
  expect_axis(found.ranking.front(), Vector3d::Zero(), Vector3d::UnitZ(), rad, 700 * rad);
  EXPECT_EQ(found.program.verification.status, VerificationStatus::kPassed);
  s.settings.slice.fan_axis = {{0, 0, 0, 0, 0, 1}};
  const PlanResult given = plan(s.design, s.settings, {});
  EXPECT_EQ(found.strips.size(), given.strips.size());
  // The sweep runs the other way, so ribs come to stand on other sections: as well but for a twentieth of the
  // tolerance.
  EXPECT_NEAR(found.verification.deviation.max, given.verification.deviation.max, 0.05);
}

TEST(FanSearch, FindsTheSameAxisInATurnedDesign) {
  Sample here = sample("corner"), there = sample("corner", placement());
  here.settings.design.keep = there.settings.design.keep = Keep::kBack;
  const auto a = rank_directions(here.design, here.settings),
             b = rank_directions(there.design, there.settings);
  ASSERT_TRUE(a.front().fan);
  expect_axis(b.front(), placement() * a.front().fan->point, placement().linear() * a.front().fan->direction,
              1e-7, 1e-4);
  EXPECT_EQ(a.front().strips, b.front().strips);
  EXPECT_NEAR(a.front().score, b.front().score, 0.05);  // the sweep may run the other way
}

TEST(FanSearch, TurnsAboutTheAxisOfAConePanel) {
  const auto cone = grid_design("cone", 60, 16, [](double u, double v) -> Vector3d {
    const double a = 1.2 * (u - 0.5), out = 500 + 200 * v;
    return placement() * Vector3d(out * std::cos(a), out * std::sin(a), 120 * v);
  });
  const auto ranking = rank_directions(cone, search_settings());
  // Its circular borders say it to rounding.
  expect_axis(ranking.front(), placement() * Vector3d::Zero(), placement().linear() * Vector3d::UnitZ(), 1e-8,
              1e-5);
}

TEST(FanSearch, TurnsAboutTheAxisOfABend) {
  const auto bend = grid_design("bend", 60, 40, [](double u, double v) -> Vector3d {
    const double a = 1.1 * u, out = 320 + 380 * v, across = 2 * v - 1;
    return placement() * Vector3d(out * std::cos(a), out * std::sin(a), 80 * (1 - across * across));
  });
  const auto ranking = rank_directions(bend, search_settings());
  expect_axis(ranking.front(), placement() * Vector3d::Zero(), placement().linear() * Vector3d::UnitZ(), 1e-8,
              1e-5);
}

TEST(FanSearch, LeavesDesignsWithParallelRibsAlone) {
  const auto cylinder = cylinder_design();
  Settings settings = search_settings();
  const auto ranking = rank_directions(cylinder, settings);
  EXPECT_FALSE(ranking.front().fan);
  EXPECT_GT(std::abs(ranking.front().normal.x()), 1 - 1e-9);
}

TEST(DirectionSearch, NoPlanIsBetterThanItsBound) {
  const Sample s = sample("saddle");
  const BodyAxes body = body_axes(s.design.mesh);
  for (const Vector3d& n : hemisphere(body)) {
    const DirectionTrial trial = try_direction(s.design, n, s.settings);
    EXPECT_GE(plan_coarsely(trial, s.settings).score, trial.score.score - 1e-9) << n.transpose();
  }
}

TEST(DirectionSearch, ShortCutsDoNotDecideTheWinner) {
  for (const char* name : {"saddle", "barrel_vault"}) {
    const Sample s = sample(name);
    const auto bounded = rank_directions(s.design, s.settings),
               all = rank_directions(s.design, s.settings, DirectionSearch::kAll);
    EXPECT_EQ(bounded.front().score, all.front().score) << name;
    EXPECT_EQ(bounded.front().normal, all.front().normal) << name;
    const auto planned = [](const std::vector<DirectionScore>& ranking) {
      return std::count_if(ranking.begin(), ranking.end(), [](const auto& d) { return !d.estimated; });
    };
    EXPECT_LT(planned(bounded), planned(all)) << name;
  }
}

TEST(DirectionScore, WhatIsServedWholeIsCoveredWhole) {
  const Sample s = sample("ragged");
  const DirectionScore score =
      plan_coarsely(try_direction(s.design, Vector3d::UnitX(), s.settings), s.settings);
  EXPECT_GT(score.covered_share, 0.999);
}

TEST(LeastSteep, IsTheRulingOfACylinderHoweverItLies) {
  const auto cylinder = grid_design("cylinder", 4, 60, [](double u, double v) -> Vector3d {
    const double phi = 0.9 * (v - 0.5);
    return placement() * Vector3d(300 * u, 400 * std::sin(phi), 400 * std::cos(phi));
  });
  const auto n = least_steep(cylinder.mesh);
  ASSERT_TRUE(n);
  EXPECT_LT(n->cross(placement().linear() * Vector3d::UnitX()).norm(), 1e-9);
}

}  // namespace
}  // namespace hotblade::pipeline

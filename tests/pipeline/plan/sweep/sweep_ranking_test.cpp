// Which ways to split a design are fitted before any is attempted.
#include "pipeline/plan/sweep/sweep_ranking.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "pipeline/plan/sweep/sweep_directions.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector3d;

constexpr double kTolerance_mm = 1;

// A swell that leans, with hollows across.
surface::DesignSurface leaning_swell(double rise_mm) {
  return grid_design("leaning swell", 40, 30, [=](double u, double v) -> Vector3d {
    return {700 * u, 500 * v, rise_mm * (std::sin(3 * u + v) + 0.3 * std::cos(4 * v - u))};
  });
}

class SweepRankingTest : public ::testing::Test {
 protected:
  explicit SweepRankingTest(double rise_mm = 50)
      : design_(leaning_swell(rise_mm)),
        fitter_(settings_, watch_),
        layouts_(design_.mesh, waste_surface(design_.mesh, 1), sweep_planes(design_.mesh, {}), settings_,
                 fitter_),
        ranking_(layouts_, 1, kTolerance_mm, tried_) {}

  [[nodiscard]] std::size_t fitted() const {
    return static_cast<std::size_t>(std::count_if(tried_.begin(), tried_.end(),
                                                  [](const PlanesTried& t) { return t.fit_mm.has_value(); }));
  }
  [[nodiscard]] double best_mm() const { return ranking_.layouts().front().cost_mm; }

  surface::DesignSurface design_;
  Settings settings_;
  WatchSweeps watch_ = [] {};
  PartFitter fitter_;
  SweepLayouts layouts_;
  std::vector<PlanesTried> tried_;
  SweepRanking ranking_;
};

class SweepRankingOfABump : public SweepRankingTest {
 protected:
  SweepRankingOfABump() : SweepRankingTest(400) {}
};

TEST_F(SweepRankingTest, ToldOfAllWaysBeforeAnyIsFitted) {
  EXPECT_GT(tried_.size(), 8U);
  EXPECT_EQ(fitted(), 0U);
  EXPECT_TRUE(ranking_.layouts().empty());
}

TEST_F(SweepRankingTest, FitsNoWayThatPromisesLessThanOneThatServes) {
  ranking_.fit_best();
  ASSERT_FALSE(ranking_.layouts().empty());
  EXPECT_FALSE(ranking_.all_fitted());
  EXPECT_LT(fitted(), tried_.size());
  EXPECT_LE(best_mm(), kTolerance_mm);
  double least_mm = tried_.back().missed_mm;
  for (auto way = tried_.rbegin(); way != tried_.rend() && !way->fit_mm; ++way) least_mm = way->missed_mm;
  EXPECT_GE(least_mm, best_mm());
}

TEST_F(SweepRankingTest, FitsTheRestWhenItIsAskedFor) {
  ranking_.fit_best();
  const std::size_t before = fitted();
  ranking_.fit_all();
  EXPECT_TRUE(ranking_.all_fitted());
  EXPECT_GT(fitted(), before);
  EXPECT_TRUE(std::is_sorted(ranking_.layouts().begin(), ranking_.layouts().end(), layout_before));
}

TEST_F(SweepRankingOfABump, FitsAllWhereNoneServes) {
  ranking_.fit_best();
  EXPECT_TRUE(ranking_.all_fitted());
  for (const Layout& layout : ranking_.layouts()) EXPECT_GT(layout.cost_mm, kTolerance_mm);
}

}  // namespace
}  // namespace hotblade::pipeline

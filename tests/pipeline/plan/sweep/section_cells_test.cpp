#include "pipeline/plan/sweep/section_cells.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace hotblade::pipeline {
namespace {

// The grid as the header tells it, sample by sample.
struct Cell {
  double x = 0, y = 0, away = 0;
};
Cell cell_of(const Eigen::Vector2d& q, double cell_mm) {
  constexpr double kShift = 0.3719;
  const double x = q.x() / cell_mm + kShift, y = q.y() / cell_mm + kShift;
  return {std::floor(x), std::floor(y), std::hypot(x - std::floor(x) - 0.5, y - std::floor(y) - 0.5)};
}

TEST(SectionCells, KeepsTheSampleNearestToEachCellsMiddleAndAllOfTheBorder) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> across(-300, 300), up(-40, 40);
  constexpr double kCellMm = 10;
  SectionCells cells(kCellMm);
  std::vector<SweepSample> all, border;
  for (int i = 0; i < 4000; ++i) {
    const SweepSample sample{{across(random), up(random)}, 1, false};
    // Some of it as a mesh gives it: one after the other in the same cell.
    for (const double on : {0.0, 0.1}) {
      all.push_back(sample);
      all.back().q.x() += on;
      cells.add(all.back());
    }
    if (i % 100 != 0) continue;
    border.push_back({{across(random), up(random)}, 0.5, true});
    cells.add_border(border.back());
  }
  const std::vector<SweepSample> kept = cells.samples();
  EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end(),
                             [](const SweepSample& a, const SweepSample& b) { return a.q.x() < b.q.x(); }));
  std::size_t of_border = 0, of_cells = 0;
  for (const SweepSample& sample : kept) {
    if (sample.at_seam) {
      ++of_border;
      continue;
    }
    ++of_cells;
    const Cell cell = cell_of(sample.q, kCellMm);
    for (const SweepSample& other : all) {
      const Cell beside = cell_of(other.q, kCellMm);
      if (beside.x != cell.x || beside.y != cell.y) continue;
      EXPECT_GE(beside.away, cell.away - 1e-12);
    }
  }
  EXPECT_EQ(of_border, border.size());
  std::vector<std::pair<double, double>> filled;
  for (const SweepSample& sample : all)
    filled.emplace_back(cell_of(sample.q, kCellMm).x, cell_of(sample.q, kCellMm).y);
  std::sort(filled.begin(), filled.end());
  filled.erase(std::unique(filled.begin(), filled.end()), filled.end());
  EXPECT_EQ(of_cells, filled.size());
}

}  // namespace
}  // namespace hotblade::pipeline

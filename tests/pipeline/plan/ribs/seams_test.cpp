#include "pipeline/plan/ribs/seams.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace hotblade::pipeline {
namespace {

// Ribs that no single elastica follows: a wave with a growing second one on top.
std::vector<RibTarget> wavy_ribs() {
  std::vector<RibTarget> ribs;
  for (int r = 0; r < 4; ++r) {
    RibTarget rib;
    rib.offset_mm = 20 * r;
    for (int i = 0; i <= 400; ++i) {
      const double x = 2.0 * i;
      rib.points.emplace_back(x, 40 * std::sin(x / 130) + (3 + 0.3 * r) * std::sin(x / 60));
      rib.s.push_back(i == 0 ? 0
                             : rib.s.back() + (rib.points.back() - rib.points[rib.points.size() - 2]).norm());
    }
    ribs.push_back(rib);
  }
  return ribs;
}

std::vector<std::vector<RibFit>> free_pieces(int n) {
  const std::vector<RibTarget> ribs = wavy_ribs();
  std::vector<std::vector<RibFit>> pieces;
  for (int i = 0; i < n; ++i) {
    pieces.push_back(fit_ribs(ribs, static_cast<double>(i) / n, (i + 1.0) / n, FitSettings{}));
  }
  return pieces;
}

double worst(const std::vector<std::vector<RibFit>>& pieces) {
  double d = 0;
  for (const auto& ribs : pieces) {
    for (const RibFit& rib : ribs) d = std::max(d, rib.deviation_mm);
  }
  return d;
}

TEST(JoinPieces, LeavesNeitherGapNorKinkWhereTheDeviationAllowsIt) {
  for (const int n : {2, 3, 4}) {
    auto pieces = free_pieces(n);
    const SeamFacts before = measure_seam(pieces[0], pieces[1]);
    EXPECT_GT(before.gap_mm, 1e-3) << n;
    EXPECT_GT(before.kink_deg, 1e-2) << n;
    constexpr double kAllowedMm = 8;
    join_pieces(pieces, kAllowedMm);
    EXPECT_LE(worst(pieces), kAllowedMm) << n;
    for (std::size_t i = 1; i < pieces.size(); ++i) {
      const SeamFacts after = measure_seam(pieces[i - 1], pieces[i]);
      EXPECT_LT(after.gap_mm, 1e-6) << n;
      EXPECT_LT(after.kink_deg, 1e-6) << n;
    }
  }
}

TEST(JoinPieces, GivesUpSeamsThatCostTooMuch) {
  const auto free = free_pieces(3);
  auto pieces = free;
  join_pieces(pieces, worst(free) * (1 + 1e-9));
  EXPECT_LE(worst(pieces), worst(free) * (1 + 1e-9));
  EXPECT_FALSE(pieces[1].front().clamp_start && pieces[1].front().clamp_end);
}

TEST(JoinPieces, KeepsClampedEndsThroughCalmingAndSmoothing) {
  auto pieces = free_pieces(2);
  join_pieces(pieces, 8);
  for (auto& ribs : pieces) {
    ribs = calmed(ribs, 3e-5);
    smooth_ribs(ribs, 3e-5, 0.5, 8);
  }
  const SeamFacts after = measure_seam(pieces[0], pieces[1]);
  EXPECT_LT(after.gap_mm, 1e-6);
  EXPECT_LT(after.kink_deg, 1e-6);
}

TEST(JoinPieces, LeavesASinglePieceAlone) {
  auto pieces = free_pieces(1);
  const elastica::Elastica was = pieces[0][0].elastica;
  join_pieces(pieces, 1);
  EXPECT_EQ(pieces[0][0].elastica.kappa, was.kappa);
  EXPECT_FALSE(pieces[0][0].clamp_start || pieces[0][0].clamp_end);
}

}  // namespace
}  // namespace hotblade::pipeline

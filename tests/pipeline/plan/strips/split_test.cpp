#include "pipeline/plan/strips/split.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace hotblade::pipeline {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

// Shares whose deviation grows with the integral of a positive density: a share of a serving share serves.
class Density {
 public:
  explicit Density(unsigned seed) {
    std::mt19937 random(seed);
    for (double& d : cell_) d = std::uniform_real_distribution(0.1, 1.0)(random);
  }
  [[nodiscard]] double deviation(int i, int j) const {
    double sum = 0;
    for (int k = i; k < j; ++k) sum += cell_[static_cast<std::size_t>(k)];
    return sum * sum;
  }
  [[nodiscard]] ShareTest test(double allowed, int* asked = nullptr) const {
    return [this, allowed, asked](double u0, double u1) -> std::optional<double> {
      if (asked != nullptr) ++*asked;
      const double d =
          deviation(static_cast<int>(std::lround(u0 * 24)), static_cast<int>(std::lround(u1 * 24)));
      return d <= allowed ? std::optional(d) : std::nullopt;
    };
  }

 private:
  std::array<double, 24> cell_{};
};

// Smallest largest deviation with exactly n pieces, over all lines.
double brute_force(const Density& density, double allowed, int n) {
  std::vector<double> best(25, kInf);
  best[0] = 0;
  for (int piece = 0; piece < n; ++piece) {
    std::vector<double> next(25, kInf);
    for (int i = 0; i < 24; ++i) {
      for (int j = i + 1; j <= 24; ++j) {
        const double d = density.deviation(i, j);
        if (d > allowed) continue;
        double& at = next[static_cast<std::size_t>(j)];
        at = std::min(at, std::max(best[static_cast<std::size_t>(i)], d));
      }
    }
    best = next;
  }
  return best.back();
}

TEST(SplitRibs, FindsTheFewestPiecesAndTheirSmallestDeviation) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    const Density density(seed);
    for (const double allowed : {4.0, 9.0, 16.0, 36.0}) {
      const Split split = split_ribs(density.test(allowed), {24, 24});
      ASSERT_GE(split.lines.size(), 2u);
      const int pieces = static_cast<int>(split.lines.size()) - 1;
      EXPECT_EQ(split.farthest.size(), split.lines.size());
      EXPECT_EQ(brute_force(density, allowed, pieces - 1), kInf) << seed;
      const double best = brute_force(density, allowed, pieces);
      EXPECT_LE(split.deviation_mm, allowed);
      EXPECT_GE(split.deviation_mm, best - 1e-12);
      // Few lines are tried at every second place or so: a step more or less of a share.
      EXPECT_LE(std::sqrt(split.deviation_mm), std::sqrt(best) + 2.1) << seed << " " << allowed;
      EXPECT_TRUE(std::is_sorted(split.lines.begin(), split.lines.end()));
      EXPECT_EQ(split.lines.front(), 0);
      EXPECT_EQ(split.lines.back(), 1);
    }
  }
}

TEST(SplitRibs, IsAsGoodAsAllLinesWhereTheWindowsAreNarrow) {
  int narrow = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    const Density density(seed);
    const Split split = split_ribs(density.test(30), {24, 24});
    const int pieces = static_cast<int>(split.lines.size()) - 1;
    if (pieces != 3) continue;
    const double best = brute_force(density, 30, pieces);
    if (split.deviation_mm <= best * (1 + 1e-12)) ++narrow;
  }
  EXPECT_GT(narrow, 20);
}

TEST(SplitRibs, TestsOneShareWhenTheWholeServes) {
  int asked = 0;
  const Split split = split_ribs(Density(1).test(1e9, &asked), {});
  EXPECT_EQ(asked, 1);
  EXPECT_EQ(split.lines, (std::vector<double>{0, 1}));
}

TEST(SplitRibs, AsksFarLessThanAllShares) {
  int asked = 0;
  (void)split_ribs(Density(2).test(16, &asked), {24, 24});
  EXPECT_LT(asked, 120);  // of 300
}

TEST(SplitRibs, GivesNoLinesWhereNothingServesOrTooManyPiecesWould) {
  EXPECT_TRUE(split_ribs([](double, double) { return std::nullopt; }, {}).lines.empty());
  EXPECT_TRUE(split_ribs(Density(3).test(4), {24, 2}).lines.empty());
  EXPECT_THROW((void)split_ribs(Density(3).test(4), {0, 2}), std::logic_error);
}

TEST(SplitRibs, GoesAsFarAsPossibleWhereSharesOfServingOnesFail) {
  // Only shares of exactly a half or a quarter from 0 serve.
  const ShareTest test = [](double u0, double u1) -> std::optional<double> {
    return u1 - u0 == 0.5 || (u0 == 0 && u1 == 0.25) ? std::optional(1.0) : std::nullopt;
  };
  const Split split = split_ribs(test, {4, 4});
  for (std::size_t i = 0; i + 1 < split.lines.size(); ++i) {
    EXPECT_TRUE(test(split.lines[i], split.lines[i + 1]).has_value());
  }
}

}  // namespace
}  // namespace hotblade::pipeline

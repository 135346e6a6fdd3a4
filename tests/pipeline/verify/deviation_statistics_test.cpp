#include "pipeline/verify/deviation_statistics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <stdexcept>

namespace hotblade::pipeline {
namespace {

TEST(DeviationStatistics, AgreesWithTheSortedSamples) {
  std::mt19937_64 random(8);
  std::exponential_distribution<double> e;
  for (const std::size_t count : {std::size_t{1}, std::size_t{2}, std::size_t{10}, std::size_t{12345}}) {
    DeviationStatistics statistics;
    std::vector<double> sorted;
    double squares = 0, sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
      sorted.push_back(e(random));
      sum += sorted.back();
      squares += sorted.back() * sorted.back();
      statistics.add(sorted.back(), {static_cast<double>(i), 0, 0}, 1);
    }
    const auto worst = std::max_element(sorted.begin(), sorted.end()) - sorted.begin();
    const Deviation d = statistics.result();
    EXPECT_EQ(d.at.x(), static_cast<double>(worst));
    EXPECT_DOUBLE_EQ(d.mean, sum / static_cast<double>(count));
    EXPECT_DOUBLE_EQ(d.rms, std::sqrt(squares / static_cast<double>(count)));
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(d.max, sorted.back());
    constexpr std::array kPercents{0.0, 50.0, 50.0, 90.0, 99.0, 99.9, 99.99, 100.0};
    const std::vector<double> values = statistics.percentiles(kPercents);
    for (std::size_t i = 0; i < values.size(); ++i) {
      // The smallest value that so many of the samples stay within.
      const auto within =
          static_cast<double>(std::upper_bound(sorted.begin(), sorted.end(), values[i]) - sorted.begin());
      const auto below =
          static_cast<double>(std::lower_bound(sorted.begin(), sorted.end(), values[i]) - sorted.begin());
      const double wanted = kPercents[i] / 100 * static_cast<double>(count);
      EXPECT_GE(within, wanted);
      EXPECT_LT(below, std::max(1.0, wanted));
    }
  }
}

TEST(DeviationStatistics, WithoutSamplesIsNothing) {
  DeviationStatistics statistics;
  EXPECT_EQ(statistics.result().max, 0);
  EXPECT_EQ(statistics.percentiles(std::array{50.0, 100.0}), (std::vector<double>{0, 0}));
}

TEST(DeviationStatistics, RefusesPercentagesThatFall) {
  DeviationStatistics statistics;
  statistics.add(1, {0, 0, 0}, 1);
  EXPECT_THROW((void)statistics.percentiles(std::array{90.0, 50.0}), std::logic_error);
  EXPECT_THROW((void)statistics.percentiles(std::array{101.0}), std::logic_error);
}

}  // namespace
}  // namespace hotblade::pipeline

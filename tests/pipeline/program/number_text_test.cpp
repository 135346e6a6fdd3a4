#include "pipeline/program/number_text.hpp"

#include <gtest/gtest.h>

#include <charconv>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace hotblade::pipeline {
namespace {

template <typename Number>
void expect_as_to_chars(Number value) {
  char ours[kNumberText], theirs[kNumberText];
  const std::string is(ours, write_number(ours, value));
  const std::string should(theirs, std::to_chars(theirs, theirs + kNumberText, value).ptr);
  ASSERT_EQ(is, should);
}

TEST(WriteNumber, WritesDecimalsOfEverySizeAsToCharsDoes) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> order(-8, 12);
  std::uniform_int_distribution<int> decimals(0, 14);
  for (int i = 0; i < 300000; ++i) {
    const double size = std::pow(10.0, order(random)), tens = std::pow(10.0, decimals(random));
    const double value = std::round(size * tens) / tens;
    for (const double near : {value, -value, std::nextafter(value, 1e300), std::nextafter(value, 0.0), size})
      expect_as_to_chars(near);
  }
}

TEST(WriteNumber, WritesSinglePrecisionAsToCharsDoes) {
  std::mt19937_64 random(12);
  std::uniform_real_distribution<double> order(-12, 12);
  std::uniform_int_distribution<int> decimals(0, 14);
  for (int i = 0; i < 300000; ++i) {
    const double size = std::pow(10.0, order(random)), tens = std::pow(10.0, decimals(random));
    const auto value = static_cast<float>(std::round(size * tens) / tens);
    for (const float near : {value, -value, std::nextafter(value, 1e30F), static_cast<float>(size)})
      expect_as_to_chars(near);
  }
  for (int k = -12; k <= 17; ++k) {
    for (const double edge : {1.0, 9.99999, 1.2, 5.0}) {
      const auto ten = static_cast<float>(edge * std::pow(10.0, k));
      for (const float value : {ten, -ten, std::nextafter(ten, 0.0F), std::nextafter(ten, 1e30F)})
        expect_as_to_chars(value);
    }
  }
}

TEST(WriteNumber, WritesTheEdgesOfItsRangesAsToCharsDoes) {
  for (int k = -12; k <= 17; ++k) {
    const double ten = std::pow(10.0, k);
    for (const double edge : {ten, 9.99999999 * ten, 1.2 * ten, 5 * ten}) {
      for (const double value : {edge, std::nextafter(edge, 0.0), std::nextafter(edge, 1e300)}) {
        expect_as_to_chars(value);
        expect_as_to_chars(-value);
      }
    }
  }
  for (const double value : {0.0, -0.0, 0.1 + 0.2, 59.244505999999994, 999.9999999999995, 9999999.99999999,
                             std::numeric_limits<double>::max(), std::numeric_limits<double>::denorm_min()})
    expect_as_to_chars(value);
}

}  // namespace
}  // namespace hotblade::pipeline

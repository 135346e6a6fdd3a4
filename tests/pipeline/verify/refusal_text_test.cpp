// What a refusal says of its amounts.
#include <gtest/gtest.h>

#include <limits>

#include "pipeline/verify/refusal.hpp"

namespace hotblade::pipeline {
namespace {

std::string amounts(double value, double bound) {
  const AmountText text = amount_text({"S001", "", Limit::kSlowestFeed, value, bound});
  return text.value + " " + text.bound;
}

TEST(RefusalText, HasFourDigitsOrAsManyAsTellAmountsApart) {
  EXPECT_EQ(amounts(55.2371, 70.538), "55.24 70.54");
  EXPECT_EQ(amounts(6.99992, 7), "6.9999 7");
  EXPECT_EQ(amounts(70.538123, 70.538119), "70.538123 70.538119");
  EXPECT_EQ(amounts(70.538119, 70.538119), "70.54 70.54");
  EXPECT_EQ(amounts(std::numeric_limits<double>::quiet_NaN(), 1), "nan 1");
}

TEST(RefusalText, OfAZeroThatWasComputedIsZero) {
  EXPECT_EQ(amounts(-2.456e-10, 1), "0 1");
  EXPECT_EQ(describe_amount({"S001", "", Limit::kSlowestFeed, 6.99992, 7}),
            "feed of the slowest blade point 6.9999 mm/s (limit 7 mm/s)");
}

}  // namespace
}  // namespace hotblade::pipeline

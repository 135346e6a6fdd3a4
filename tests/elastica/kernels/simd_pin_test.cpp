// The instruction set that a name pins.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "elastica/kernels/simd_pin.hpp"

namespace hotblade::elastica {
namespace {

TEST(SimdPin, EverySupportedNameIsTakenAndNoOther) {
  EXPECT_EQ(simd_named("baseline"), Simd::kBaseline);
  for (const Simd simd : {Simd::kBaseline, Simd::kAvx2, Simd::kAvx512}) {
    if (supported(simd)) {
      EXPECT_EQ(simd_named(name(simd)), simd);
    } else {
      EXPECT_THROW((void)simd_named(name(simd)), std::runtime_error);
    }
  }
  EXPECT_TRUE(supported(simd_named("")));
  for (const char* wrong : {"AVX2", "avx", "sse", " baseline"})
    EXPECT_THROW((void)simd_named(wrong), std::runtime_error) << wrong;
}

}  // namespace
}  // namespace hotblade::elastica

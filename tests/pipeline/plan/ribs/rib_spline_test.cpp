#include "pipeline/plan/ribs/rib_spline.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "pipeline/plan/ribs/fade.hpp"

namespace hotblade::pipeline {
namespace {

// Ribs that turn, bend and get shorter towards the first one, as under a round border.
RibSpline round_end(double on_mm = 0) {
  std::vector<RibFit> ribs;
  for (int i = 0; i < 8; ++i) {
    const double mm = 20.0 * i;
    RibFit& rib = ribs.emplace_back();
    rib.offset_mm = mm;
    rib.elastica = elastica::from_mid_state({0.1 * mm, 5 * std::sin(0.01 * mm), 0.3 + 0.004 * mm,
                                             0.002 + 1e-5 * mm, 0, 0, 6 + 4 * mm - 0.01 * mm * mm});
  }
  return RibSpline(ribs, on_mm);
}

std::array<double, 5> state(const RibSpline& spline, double offset_mm) {
  const elastica::MidState m = spline.mid_at(offset_mm);
  return {m.x, m.y, m.theta, m.kappa, m.length};
}

TEST(RibSpline, GoesOnPastItsEndsWithoutASuddenChange) {
  const RibSpline spline = round_end();
  for (const double end : {0.0, 140.0}) {
    const double h = 1e-3;
    const auto a = state(spline, end - h), b = state(spline, end), c = state(spline, end + h);
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double before = (b[i] - a[i]) / h, behind = (c[i] - b[i]) / h;
      // Slopes agree at the end; they would differ by all of one, did the shape stand still outside.
      EXPECT_NEAR(before, behind, 1e-3 * std::max(1e-3, std::abs(before))) << end << " " << i;
    }
  }
}

TEST(RibSpline, StandsStillFromAShortWayPastItsEnds) {
  const RibSpline spline = round_end();
  EXPECT_EQ(state(spline, -kFadeMm), state(spline, -5 * kFadeMm));
  EXPECT_EQ(state(spline, 140 + kFadeMm), state(spline, 140 + 5 * kFadeMm));
  // Half as far as the slope leads over that way, up to its own change.
  const double first = state(spline, 0)[2], slope = 0.004;
  EXPECT_NEAR(state(spline, -kFadeMm)[2], first - 0.5 * kFadeMm * slope, 1e-6);
}

TEST(RibSpline, GoesOnAsItCameForAsLongAsItIsAskedTo) {
  const RibSpline on = round_end(7), at_once = round_end();
  // A quadratic goes on: third differences vanish up to 7 mm, and no more where it fades at once.
  const auto third = [](const RibSpline& s) {
    return state(s, -6)[2] - 3 * state(s, -4)[2] + 3 * state(s, -2)[2] - state(s, 0)[2];
  };
  EXPECT_NEAR(third(on), 0, 1e-12);
  EXPECT_GT(std::abs(third(at_once)), 1e-4);
  EXPECT_EQ(state(on, -7 - kFadeMm), state(on, -7 - 5 * kFadeMm));
}

TEST(RibSpline, KeepsSomeLengthOfARibThatGetsShorter) {
  const RibSpline spline = round_end();
  for (double past = 0; past <= 20; past += 0.5) EXPECT_GT(state(spline, -past)[4], 0) << past;
}

}  // namespace
}  // namespace hotblade::pipeline

// The share that a plan tells moves with its work.
#include "pipeline/plan/plan_progress.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

namespace hotblade::pipeline {
namespace {

// What a console shows is moved by half a hundredth at a time.
constexpr double kShown = 0.005;

// Told by every step of a plan, all steps taking as long.
std::vector<double> told(int fits, int strips, int tries, double expected) {
  std::vector<double> all;
  PlanProgress progress([&](const std::string&, double share) { all.push_back(share); }, expected);
  for (int k = 0; k < tries; ++k) {
    for (int i = 0; i < fits; ++i) progress.fitted();
    for (int i = 1; i <= strips; ++i) progress.looked_at("pose", 0.6 * i / strips);
    for (int i = 0; i < strips / 2; ++i) progress.looked_at("verify", 0.6);
    progress.next_try();
  }
  return all;
}

// Most of the steps that pass while one number is shown, of all.
double longest_stand(const std::vector<double>& all) {
  double shown = -1, most = 0, since = 0;
  for (const double share : all) {
    if (share >= shown + kShown) {
      shown = share;
      since = 0;
    }
    most = std::max(most, ++since);
  }
  return most / static_cast<double>(all.size());
}

TEST(PlanProgress, NeverGoesBackNorEnds) {
  for (const int tries : {1, 2, 5, 12}) {
    const std::vector<double> all = told(300, 10, tries, 100);
    EXPECT_TRUE(std::is_sorted(all.begin(), all.end()));
    EXPECT_GT(all.front(), 0);
    EXPECT_LT(all.back(), 1);
  }
}

// A third of the fits that are expected to ten times as many; strips that take most of the time; many tries.
TEST(PlanProgress, StandsAtNoNumberForAThirdOfTheWork) {
  struct Work {
    int fits, strips, tries;
    double expected;
  };
  for (const Work& w :
       {Work{35, 2, 1, 100}, Work{300, 2, 1, 100}, Work{1000, 2, 1, 100}, Work{400, 269, 1, 800},
        Work{8000, 269, 1, 800}, Work{400, 4, 6, 100}, Work{2000, 40, 16, 300}}) {
    EXPECT_LT(longest_stand(told(w.fits, w.strips, w.tries, w.expected)), 1.0 / 3)
        << w.fits << " fits of " << w.expected << ", " << w.strips << " strips, " << w.tries << " tries";
  }
}

}  // namespace
}  // namespace hotblade::pipeline

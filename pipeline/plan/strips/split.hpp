// Where the ribs of a chain are split: the fewest shares that each serve, and of those the split lines with
// the smallest deviation.
#pragma once

#include <functional>
#include <optional>
#include <vector>

namespace hotblade::pipeline {

// Returns the deviation in mm with which one strip cuts the share [u0, u1] of all ribs, 0 <= u0 < u1 <= 1;
// nothing when no strip serves.
using ShareTest = std::function<std::optional<double>(double u0, double u1)>;

struct SplitOptions {
  int steps = 24;  // split lines lie on multiples of 1/steps
  int most_pieces = 13;
};

struct Split {
  std::vector<double> lines;     // 0, .., 1; empty: no split within the options serves
  std::vector<double> farthest;  // as many lines, each share going as far as it serves
  double deviation_mm = 0;       // the largest of the shares between `lines`
};

// Returns the split lines. A share of a serving share is taken to serve. Then going as far as possible from
// either end gives the fewest pieces and, for every line, the window that it must lie in; dynamic programming
// over a few places in each window finds the lines whose largest deviation is smallest. Each share is tested
// at most once and in the order of its place, so the result depends on the test alone. O(pieces (log steps +
// 25)) tests.
[[nodiscard]] Split split_ribs(const ShareTest& test, const SplitOptions& options);

}  // namespace hotblade::pipeline

#include "pipeline/plan/ribs/adaptive_ribs.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "pipeline/plan/ribs/rib_spline.hpp"

namespace hotblade::pipeline {

namespace {

// A cubic needs four ribs, and one more tells whether it holds.
constexpr std::size_t kFirstRibs = 5;
// Of the mean distance of all sections: even ones are one apart, those next to an opening or a tip far less.
constexpr double kLeastGap = 0.4;

std::size_t nearest_section(std::span<const RibTarget> sections, double offset_mm) {
  const auto away = [&](const RibTarget& s) { return std::abs(s.offset_mm - offset_mm); };
  return static_cast<std::size_t>(
      std::min_element(sections.begin(), sections.end(),
                       [&](const RibTarget& a, const RibTarget& b) { return away(a) < away(b); }) -
      sections.begin());
}

double largest_deviation(std::span<const RibFit> fits) {
  double largest = 0;
  for (const RibFit& fit : fits) largest = std::max(largest, fit.deviation_mm);
  return largest;
}

}  // namespace

double least_rib_gap_mm(std::span<const RibTarget> sections) {
  return kLeastGap * (sections.back().offset_mm - sections.front().offset_mm) /
         static_cast<double>(sections.size() - 1);
}

std::vector<std::size_t> first_ribs(std::span<const RibTarget> sections) {
  if (sections.size() < 2 || !(sections.back().offset_mm > sections.front().offset_mm)) {
    throw std::logic_error("first_ribs: at least two sections with ascending offsets are needed");
  }
  const double first = sections.front().offset_mm, last = sections.back().offset_mm;
  const double least = least_rib_gap_mm(sections);
  std::vector<std::size_t> ribs{0};
  for (std::size_t i = 1; i + 1 < kFirstRibs; ++i) {
    const std::size_t k =
        nearest_section(sections, first + (last - first) * static_cast<double>(i) / (kFirstRibs - 1));
    const double offset = sections[k].offset_mm;
    if (offset - sections[ribs.back()].offset_mm >= least && last - offset >= least) ribs.push_back(k);
  }
  ribs.push_back(sections.size() - 1);
  return ribs;
}

std::vector<std::size_t> ribs_to_add(std::span<const RibTarget> sections, std::span<const std::size_t> ribs,
                                     std::span<const FittedShare> strips, double limit_mm) {
  std::vector<RibSpline> splines;
  std::vector<double> own;
  for (const FittedShare& strip : strips) {
    splines.emplace_back(strip.fits);
    own.push_back(largest_deviation(strip.fits));
  }
  const double least = least_rib_gap_mm(sections);
  std::vector<char> off(sections.size(), 0);
  tbb::parallel_for(std::size_t{0}, sections.size(), [&](std::size_t k) {
    const auto next = std::lower_bound(ribs.begin(), ribs.end(), k);
    if (*next == k) return;
    const double offset = sections[k].offset_mm;
    if (offset - sections[*(next - 1)].offset_mm < least || sections[*next].offset_mm - offset < least)
      return;
    for (std::size_t i = 0; i < strips.size() && off[k] == 0; ++i) {
      const double u0 = strips[i].u0, width = strips[i].u1 - u0;
      const DesignPart part = sections[k].own_of(u0, strips[i].u1);
      if (!(part.last > part.first)) continue;
      const std::vector<Eigen::Vector2d> target =
          resample(sections[k], u0 + part.first * width, u0 + part.last * width, kRibSamples);
      const double distance = elastica::max_distance(target, splines[i].at(offset));
      off[k] = distance > limit_mm + own[i] ? 1 : 0;
    }
  });
  std::vector<std::size_t> add;
  for (std::size_t g = 0; g + 1 < ribs.size(); ++g) {
    const double middle = 0.5 * (sections[ribs[g]].offset_mm + sections[ribs[g + 1]].offset_mm);
    std::size_t best = ribs[g];
    for (std::size_t k = ribs[g] + 1; k < ribs[g + 1]; ++k) {
      const bool nearer = best == ribs[g] || std::abs(sections[k].offset_mm - middle) <
                                                 std::abs(sections[best].offset_mm - middle);
      if (off[k] != 0 && nearer) best = k;
    }
    if (best != ribs[g]) add.push_back(best);
  }
  return add;
}

}  // namespace hotblade::pipeline

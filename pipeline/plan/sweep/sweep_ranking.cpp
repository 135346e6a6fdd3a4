#include "pipeline/plan/sweep/sweep_ranking.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <map>
#include <utility>

#include "gpu/backend/stop.hpp"

namespace hotblade::pipeline {

SweepRanking::SweepRanking(const SweepLayouts& layouts, std::size_t parts, double tolerance_mm,
                           std::vector<PlanesTried>& tried)
    : layouts_(layouts), tolerance_mm_(tolerance_mm), tried_(tried) {
  // As many of each way to split: splits along the sweep make no section easier to follow. 320 panels and
  // parts of buildings take 563 strips with ten, 557 with fourteen in less time, and 555 with twenty in more.
  constexpr std::size_t kFitted = 14;
  std::map<std::size_t, std::size_t> taken;  // by parts along the sweep
  for (const EvenSplit& split : layouts.even_splits(parts)) {
    if (taken[split.grid.along_sweep]++ < kFitted) ways_.push_back({split, tried_.size()});
    tried_.push_back({split.planes, split.grid.along_sweep, split.grid.along_ribs, split.missed_mm});
  }
}

void SweepRanking::fit_best() {
  constexpr std::size_t kAtOnce = 4;  // more than one, for threads; no more than mostly do
  while (!all_fitted() && !found()) fit_next(kAtOnce);
}

void SweepRanking::fit_all() {
  fit_next(ways_.size() - next_);
}

// What Beziers say that a way misses is about what its fit comes to, seldom more than twice that.
bool SweepRanking::found() const {
  constexpr double kSurely = 1;
  if (layouts_fitted_.empty()) return false;
  const double best = layouts_fitted_.front().cost_mm;
  return best <= tolerance_mm_ && best <= kSurely * ways_[next_].split.missed_mm;
}

void SweepRanking::fit_next(std::size_t count) {
  count = std::min(count, ways_.size() - next_);
  std::vector<Layout> fitted(count);
  tbb::parallel_for(std::size_t{0}, count,
                    [&](std::size_t i) { fitted[i] = layouts_.fitted(ways_[next_ + i].split); });
  gpu::stop_point();
  for (std::size_t i = 0; i < count; ++i) {
    double largest = 0;
    for (const PartFit& fit : fitted[i].fits)
      largest = std::max(largest, fit.holds() ? fit.max_mm : kHopeless_mm);
    if (largest < kHopeless_mm) tried_[ways_[next_ + i].told].fit_mm = largest;
    if (!fitted[i].parts.empty()) layouts_fitted_.push_back(std::move(fitted[i]));
  }
  next_ += count;
  std::sort(layouts_fitted_.begin(), layouts_fitted_.end(), layout_before);
}

}  // namespace hotblade::pipeline

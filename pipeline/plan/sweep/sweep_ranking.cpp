// How planes are ranked: by what their sections' Beziers miss, then by cheap fits of the first.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <map>
#include <utility>

#include "gpu/backend/stop.hpp"
#include "pipeline/plan/sweep/section_beziers.hpp"
#include "pipeline/plan/sweep/sweep_layout.hpp"

namespace hotblade::pipeline {

std::vector<Layout> Ranking::fitted() const {
  std::vector<Layout> all;
  for (const Entry& entry : entries)
    if (!entry.layout.parts.empty()) all.push_back(entry.layout);
  std::sort(all.begin(), all.end(), layout_before);
  return all;
}

Ranking SweepLayouts::ranking(std::size_t parts) const {
  // Splits beyond those that the length asks for are the user's to allow.
  const auto may = [&](const SweepGrid& least, const SweepGrid& grid) {
    return grid.along_sweep >= least.along_sweep && grid.along_ribs >= least.along_ribs &&
           grid.along_ribs <= least.along_ribs + static_cast<std::size_t>(settings_.fit.max_splits);
  };
  Ranking ranking;
  std::vector<SectionQuestion> questions;
  std::size_t named = 0;
  for (std::size_t n = 0; n < planes_.size(); ++n) {
    for (std::size_t s = 1; s <= parts; ++s) {
      if (parts % s != 0) continue;
      const SweepGrid grid{s, parts / s};
      if (may(whole_[n].least, grid)) {
        ranking.entries.push_back({{planes_[n], grid.along_sweep, grid.along_ribs}, n, named});
        questions.push_back({n, grid.along_ribs});
      }
      ++named;
    }
  }
  const std::vector<double> misses = elastica_misses_mm(mesh_, planes_, questions);
  for (std::size_t i = 0; i < misses.size(); ++i) ranking.entries[i].tried.missed_mm = misses[i];
  std::stable_sort(ranking.entries.begin(), ranking.entries.end(),
                   [](const auto& a, const auto& b) { return a.tried.missed_mm < b.tried.missed_mm; });
  return ranking;
}

void SweepLayouts::fit(Ranking& ranking, std::size_t most) const {
  std::map<std::size_t, std::size_t> taken;  // by parts along the sweep
  std::vector<Ranking::Entry*> open;
  for (Ranking::Entry& entry : ranking.entries) {
    if (taken[entry.tried.along_sweep]++ < most && entry.layout.parts.empty()) open.push_back(&entry);
  }
  tbb::parallel_for(std::size_t{0}, open.size(), [&](std::size_t i) {
    Ranking::Entry& entry = *open[i];
    const SweepGrid grid{entry.tried.along_sweep, entry.tried.along_ribs};
    entry.layout = fitted(whole_[entry.whole], entry.named, grid, cheap_effort(), nullptr);
    double largest = 0;
    for (const PartFit& fit : entry.layout.fits)
      largest = std::max(largest, fit.holds() ? fit.max_mm : kHopeless_mm);
    if (largest < kHopeless_mm) entry.tried.fit_mm = largest;
  });
  gpu::stop_point();
}

}  // namespace hotblade::pipeline

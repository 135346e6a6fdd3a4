#include "pipeline/plan/strips/strips.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "pipeline/plan/strips/run_layout.hpp"

namespace hotblade::pipeline {

namespace {

// Runs of ribs along the sweep that fit the stock's longest edge, `least` of them or more; neighbouring runs
// share a rib.
std::vector<std::pair<std::size_t, std::size_t>> sweep_runs(const ChainTarget& chain,
                                                            const Settings& settings, std::size_t least = 1) {
  const double most =
      *std::max_element(settings.stock.max_size_mm.begin(), settings.stock.max_size_mm.end()) -
      2 * settings.stock.border_mm;
  if (!(most > 0)) return {{0, chain.ribs.size() - 1}};  // refused later, by its block's size
  const double extent = chain.ribs.back().offset_mm - chain.ribs.front().offset_mm;
  const auto count =
      std::min(chain.ribs.size() - 1,
               std::max(least, static_cast<std::size_t>(std::max(1.0, std::ceil(extent / most)))));
  std::vector<std::pair<std::size_t, std::size_t>> runs;
  for (std::size_t i = 0; i < count; ++i) {
    runs.emplace_back((chain.ribs.size() - 1) * i / count, (chain.ribs.size() - 1) * (i + 1) / count);
  }
  return runs;
}

// Numbers a run's strips from `next` on. A run that is refused takes one number, which its refusal names and
// no program has.
void name_strips(StripLayout& run, int& next) {
  const auto name = [&next] { return fmt::format("S{:03}", next++); };
  for (StripPlan& strip : run.strips) strip.id = name();
  for (Refusal& refusal : run.refusals) {
    refusal.strip = name();
    refusal.rib = refusal.strip + refusal.rib;
  }
}

// A run of a chain's sections, to be laid out on its own.
struct Run {
  const ChainTarget* chain;
  LaidOutRun place;
  [[nodiscard]] std::span<const RibTarget> sections() const {
    return std::span(chain->ribs).subspan(place.first, place.last - place.first + 1);
  }
};

struct Part {
  LaidOutRun place;
  StripLayout layout;
};

// Refusals, then strips: fewer are better.
std::pair<std::size_t, std::size_t> cost(const std::vector<Part>& parts) {
  std::pair<std::size_t, std::size_t> cost{0, 0};
  for (const Part& part : parts) {
    cost.first += part.layout.refusals.size();
    cost.second += part.layout.strips.size();
  }
  return cost;
}

void add_runs(const TargetReport& targets, std::size_t chain, const Settings& settings, std::size_t least,
              std::vector<Run>& runs) {
  for (const auto& [first, last] : sweep_runs(targets.chains[chain], settings, least)) {
    runs.push_back({&targets.chains[chain], {chain, first, last, 0}});
  }
}

std::vector<Part> lay_out_runs(const std::vector<Run>& runs, const Settings& settings, std::size_t most_more,
                               const WatchTries& watch) {
  std::vector<Part> parts(runs.size());
  tbb::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t i) {
    parts[i] = {runs[i].place, lay_out_run(*runs[i].chain, runs[i].sections(), settings, most_more, watch)};
    parts[i].place.strips = parts[i].layout.strips.size();
  });
  return parts;
}

double turn_of(const ChainTarget& chain) {
  return chain.planes.angle(chain.ribs.back().offset_mm) - chain.planes.angle(chain.ribs.front().offset_mm);
}

// Runs that a fan's chain is cut into at the least.
std::size_t least_fan_runs(const ChainTarget& chain) {
  constexpr double kMostTurnRad = 1.6;  // a quarter turn: the box about a wider piece is nearly all waste
  return static_cast<std::size_t>(std::max(1.0, std::ceil(turn_of(chain) / kMostTurnRad)));
}

// A fan's blocks lie with their middle planes level: more runs tilt the other planes less, so that the blade
// sags less in them, and fewer splits along the ribs may do. A few numbers of runs are tried, and while all
// are refused twice as many again; those without a refusal and then with the fewest strips are taken, more
// runs among equals.
std::vector<Part> lay_out_fan(const TargetReport& targets, std::size_t chain, const Settings& settings,
                              std::size_t most_more, const WatchTries& watch) {
  constexpr std::size_t kTries = 5;
  std::vector<Part> best;
  std::pair<std::size_t, std::size_t> fewest;  // refusals, strips
  const std::size_t least = least_fan_runs(targets.chains[chain]);
  std::size_t count = least;
  for (std::size_t i = 0; (i < kTries || fewest.first > 0) && count <= least + most_more; ++i) {
    std::vector<Run> runs;
    add_runs(targets, chain, settings, count, runs);
    if (i > 0 && runs.size() < count) break;  // no more sections to split at
    count = std::max(count, runs.size());
    std::vector<Part> parts = lay_out_runs(runs, settings, most_more, watch);
    const auto is = cost(parts);
    if (best.empty() || is <= fewest) {
      best = std::move(parts);
      fewest = is;
    }
    if (fewest.first == 0 && fewest.second <= runs.size()) break;  // more runs are more strips
    count = i + 1 < kTries ? count + 1 : 2 * count;
  }
  return best;
}

// Every chain on its own, in the order of `chains`.
std::vector<std::vector<Part>> lay_out_chains(const TargetReport& targets,
                                              const std::vector<std::size_t>& chains,
                                              const Settings& settings, std::size_t most_more,
                                              const WatchTries& watch) {
  std::vector<std::vector<Part>> by_chain(chains.size());
  std::vector<Run> runs;
  std::vector<std::size_t> chain_of;
  for (std::size_t i = 0; i < chains.size(); ++i) {
    if (targets.chains[chains[i]].planes.turns()) {
      by_chain[i] = lay_out_fan(targets, chains[i], settings, most_more, watch);
    } else {
      add_runs(targets, chains[i], settings, 1, runs);
    }
    chain_of.resize(runs.size(), i);
  }
  std::vector<Part> parts = lay_out_runs(runs, settings, most_more, watch);
  for (std::size_t i = 0; i < parts.size(); ++i) by_chain[chain_of[i]].push_back(std::move(parts[i]));
  return by_chain;
}

// Chains of the targets, laid out across gaps where that takes fewer strips than the chains beside the gaps
// on their own. Those are laid out only where they may be as few.
class ChainLayout {
 public:
  ChainLayout(const TargetReport& targets, const Settings& settings, std::size_t most_more,
              const WatchTries& watch)
      : targets_(targets),
        settings_(settings),
        most_more_(most_more),
        watch_(watch),
        by_chain_(targets.chains.size()) {}

  std::vector<std::vector<Part>> run() {
    std::vector<std::vector<Part>> bridged = lay_out_bridges();
    std::vector<char> bridged_over(by_chain_.size(), 0);
    for (std::size_t b = 0; b < bridged.size(); ++b) {
      const std::vector<std::size_t>& chains = targets_.bridges[b].chains;
      const auto [refused, strips] = cost(bridged[b]);
      const bool fewest = refused == 0 && strips < chains.size();  // each chain takes one at least
      for (const std::size_t c : chains) bridged_over[c] = fewest ? 1 : 0;
    }
    lay_out_apart(bridged_over);
    for (std::size_t b = 0; b < bridged.size(); ++b) {
      const std::vector<std::size_t>& chains = targets_.bridges[b].chains;
      if (bridged_over[chains.front()] == 0 && cost(bridged[b]) >= cost_of(chains)) continue;
      for (const std::size_t c : chains) by_chain_[c].clear();
      by_chain_[chains.front()] = std::move(bridged[b]);
    }
    return std::move(by_chain_);
  }

 private:
  [[nodiscard]] std::vector<std::vector<Part>> lay_out_bridges() const {
    TargetReport whole;
    std::vector<std::size_t> all;
    for (const BridgeTarget& bridge : targets_.bridges) {
      all.push_back(whole.chains.size());
      whole.chains.push_back(bridge.target);
    }
    return lay_out_chains(whole, all, settings_, most_more_, watch_);
  }

  void lay_out_apart(const std::vector<char>& bridged_over) {
    std::vector<std::size_t> chains;
    for (std::size_t c = 0; c < by_chain_.size(); ++c) {
      if (bridged_over[c] == 0) chains.push_back(c);
    }
    std::vector<std::vector<Part>> laid = lay_out_chains(targets_, chains, settings_, most_more_, watch_);
    for (std::size_t i = 0; i < laid.size(); ++i) by_chain_[chains[i]] = std::move(laid[i]);
  }

  [[nodiscard]] std::pair<std::size_t, std::size_t> cost_of(const std::vector<std::size_t>& chains) const {
    std::pair<std::size_t, std::size_t> sum{0, 0};
    for (const std::size_t c : chains) {
      const auto [refused, strips] = cost(by_chain_[c]);
      sum.first += refused;
      sum.second += strips;
    }
    return sum;
  }

  const TargetReport& targets_;
  const Settings& settings_;
  std::size_t most_more_;
  const WatchTries& watch_;
  std::vector<std::vector<Part>> by_chain_;
};

}  // namespace

StripLayout lay_out_strips(const TargetReport& targets, const Settings& settings, std::size_t most_more,
                           const WatchTries& watch) {
  StripLayout layout;
  layout.refusals = targets.refusals;
  layout.warnings = targets.warnings;
  int number = 1;
  for (std::vector<Part>& parts : ChainLayout(targets, settings, most_more, watch).run()) {
    for (Part& part : parts) {
      name_strips(part.layout, number);
      layout.runs.push_back(part.place);
      std::move(part.layout.strips.begin(), part.layout.strips.end(), std::back_inserter(layout.strips));
      std::move(part.layout.refusals.begin(), part.layout.refusals.end(),
                std::back_inserter(layout.refusals));
    }
  }
  return layout;
}

std::vector<LaidOutRun> least_runs(const TargetReport& targets, const Settings& settings) {
  std::vector<Run> runs;
  for (std::size_t chain = 0; chain < targets.chains.size(); ++chain)
    add_runs(targets, chain, settings, least_fan_runs(targets.chains[chain]), runs);
  std::vector<LaidOutRun> places;
  for (const Run& run : runs) places.push_back(run.place);
  return places;
}

std::size_t least_strips(const ChainTarget& chain, const LaidOutRun& run, const Settings& settings) {
  // The clamps stand clear of the block, which stands around the rib.
  const double most =
      settings.blade.free_lengths_mm.back() - 2 * (settings.stock.clearance_mm + settings.stock.border_mm);
  double longest = 0;
  for (std::size_t i = run.first; i <= run.last; ++i) longest = std::max(longest, chain.ribs[i].s.back());
  return most > 0 ? static_cast<std::size_t>(std::max(1.0, std::ceil(longest / most))) : 1;
}

}  // namespace hotblade::pipeline

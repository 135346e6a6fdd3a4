#include "pipeline/plan/strips.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "pipeline/plan/adaptive_ribs.hpp"
#include "pipeline/plan/blade.hpp"
#include "pipeline/plan/split.hpp"

namespace hotblade::pipeline {

namespace {

// An edge of a block that is longer than the stock's edge of the same rank; a block may be turned any way.
struct EdgeOver {
  double edge_mm = 0, stock_mm = 0;
};

std::optional<EdgeOver> edge_over_stock(Eigen::Vector3d size, const StockSettings& stock) {
  Eigen::Vector3d most(stock.max_size_mm[0], stock.max_size_mm[1], stock.max_size_mm[2]);
  std::sort(size.begin(), size.end());
  std::sort(most.begin(), most.end());
  for (int i = 0; i < 3; ++i) {
    if (size[i] > most[i]) return EdgeOver{size[i], most[i]};
  }
  return std::nullopt;
}

// One share [u0, u1] of some ribs as a strip, or why not.
struct Attempt {
  std::optional<StripPlan> strip;
  Refusal refusal;        // without the strip's and the rib's id
  std::size_t rib = 0;    // that it is about
  bool fitted = false;    // an elastica serves every rib; what failed is the blade or the block
  bool hopeless = false;  // the design itself is far too sharp: shorter pieces are no flatter
};

// The search for split lines asks only whether a share serves; a strip's ribs are smoothed as well.
enum class Purpose { kSearch, kStrip };

std::size_t worst_rib(const std::vector<RibFit>& ribs) {
  return static_cast<std::size_t>(
      std::max_element(ribs.begin(), ribs.end(),
                       [](const RibFit& a, const RibFit& b) { return a.deviation_mm < b.deviation_mm; }) -
      ribs.begin());
}

std::string rib_place(const ChainTarget& chain, const std::vector<RibFit>& ribs, std::size_t i) {
  const Eigen::Vector2d q = ribs[i].target[ribs[i].target.size() / 2];
  const Eigen::Vector3d p = chain.plane(ribs[i].offset_mm).point(q.x(), q.y());
  return fmt::format("at ({:.1f}, {:.1f}, {:.1f})", p.x(), p.y(), p.z());
}

// The block on the table: the middle plane level, sweep downwards, x kept, bottom on the plinth, centred.
void place_stock(StripPlan& strip, const Block& block, const Settings& settings) {
  const Eigen::Vector3d &low = block.low, &high = block.high;
  const bool along = strip.x.cross(strip.y).dot(strip.sweep) > 0;
  strip.stock.frame = block.layer(along ? low.z() : high.z());
  strip.stock.frame.origin = strip.stock.frame.point(low.x(), low.y());
  strip.stock.size_mm = high - low;
  const Eigen::Vector3d &x = block.x, &sweep = block.sweep;
  Eigen::Matrix3d r;
  r.row(0) = x;
  r.row(1) = -sweep.cross(x);
  r.row(2) = -sweep;
  const Eigen::Vector2d middle = 0.5 * (low.head<2>() + high.head<2>());
  const Eigen::Vector3d foot = block.centre + middle.x() * x + middle.y() * block.y + high.z() * sweep;
  strip.design_to_cell.q = robot::canonical(Eigen::Quaterniond(r));
  strip.design_to_cell.p =
      Eigen::Vector3d(0, 0, settings.machine.plinth_mm) - strip.design_to_cell.q.toRotationMatrix() * foot;
}

// The calmest fit within `allowed` that a blade can be extended from; else the refusal of the closest fit.
struct Served {
  std::vector<RibFit> ribs;
  BladeReport blade;
};

Served serve(const RibAxes& axes, const std::vector<RibFit>& closest, double allowed, Purpose purpose,
             const Settings& settings) {
  // From nearly circular arcs down to what the points alone say.
  constexpr std::array<double, 4> kTensionWeights{3e-3, 3e-4, 3e-5, kLeastTensionWeight};
  Served served;
  for (const double weight : kTensionWeights) {
    std::vector<RibFit> ribs = weight > kLeastTensionWeight ? calmed(closest, weight) : closest;
    if (ribs[worst_rib(ribs)].deviation_mm > allowed) continue;
    const Block block = block_around(ribs, axes, settings.stock);
    served.blade = choose_blade(ribs, axes, block, settings);
    if (served.blade.choice && purpose == Purpose::kStrip) {
      smooth_ribs(ribs, weight, 0.1 * allowed, allowed);
      served.blade = choose_blade(ribs, axes, block, settings);
    }
    served.ribs = std::move(ribs);
    if (served.blade.choice) break;
  }
  return served;
}

StripPlan make_strip_plan(const RibAxes& chain, const Served& served, const Settings& settings) {
  StripPlan strip;
  static_cast<RibAxes&>(strip) = chain;
  strip.ribs = served.ribs;
  const BladeChoice& blade = *served.blade.choice;
  strip.blade_length_mm = blade.length_mm;
  strip.share_a = blade.share_a;
  strip.smallest_margin = blade.smallest_margin;
  strip.largest_curvature_per_mm = blade.largest_curvature_per_mm;
  strip.smallest_clearance_mm = blade.smallest_clearance_mm;
  place_stock(strip, block_around(strip.ribs, strip, settings.stock), settings);
  return strip;
}

double allowed_mm(const Settings& settings) {
  return settings.fit.deviation_share * settings.design.tolerance_mm;
}

// The strip of a share's fits, or what stands against it.
Attempt try_share(const ChainTarget& chain, const std::vector<RibFit>& closest, Purpose purpose,
                  const Settings& settings) {
  Attempt attempt;
  const double allowed = allowed_mm(settings);
  const std::size_t worst = worst_rib(closest);
  if (!(closest[worst].deviation_mm <= allowed)) {
    attempt.rib = worst;
    attempt.refusal = {"",
                       "",
                       "deviation of an elastica",
                       closest[worst].deviation_mm,
                       allowed,
                       "mm",
                       "allow more splits (fit.max_splits) or a larger tolerance",
                       rib_place(chain, closest, worst)};
    return attempt;
  }
  attempt.fitted = true;
  const Served served = serve(chain, closest, allowed, purpose, settings);
  if (!served.blade.choice) {
    attempt.refusal = served.blade.refusal;
    // A shorter piece follows the design more closely, so its radius only shrinks; half leaves room for the
    // slack that the tolerance gives.
    attempt.hopeless = served.blade.rib_too_sharp && attempt.refusal.value < 0.5 * attempt.refusal.bound;
    attempt.rib = static_cast<std::size_t>(std::max(0, served.blade.rib));
    attempt.refusal.place = rib_place(chain, served.ribs, attempt.rib);
    return attempt;
  }
  StripPlan strip = make_strip_plan(chain, served, settings);
  if (const auto over = edge_over_stock(strip.stock.size_mm, settings.stock)) {
    attempt.refusal = {"",
                       "",
                       "block edge",
                       over->edge_mm,
                       over->stock_mm,
                       "mm",
                       "allow more splits or larger stock.max_size_mm",
                       rib_place(chain, strip.ribs, 0)};
    return attempt;
  }
  attempt.strip = std::move(strip);
  return attempt;
}

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

// A run of sections on its way to strips: ribs on some of the sections, split lines common to all of them.
class RunLayout {
 public:
  RunLayout(const ChainTarget& chain, std::span<const RibTarget> sections, const Settings& settings,
            std::size_t most_more)
      : chain_(chain),
        sections_(sections),
        settings_(settings),
        most_more_(static_cast<int>(most_more)),
        ribs_(first_ribs(sections)) {}

  StripLayout run() {
    for (bool settled = false; !settled;) {
      gather();
      if (!(lines_.empty() ? false : cut(lines_)) && !split()) {
        layout_.strips.clear();
        layout_.refusals.push_back(said_);
        return std::move(layout_);
      }
      settled = !refine();
    }
    for (StripPlan& strip : layout_.strips) smooth(strip);
    measure_seams();
    return std::move(layout_);
  }

 private:
  void gather() {
    targets_.clear();
    for (const std::size_t k : ribs_) targets_.push_back(sections_[k]);
  }

  // The refusal that is told in the end. The first one of pieces that an elastica serves says most; before
  // that, how far the last one was off.
  void listen(const Attempt& attempt) {
    if (!fitted_) {
      said_ = attempt.refusal;
      said_.rib = rib_id("", attempt.rib);
    }
    fitted_ = fitted_ || attempt.fitted;
    hopeless_ = hopeless_ || attempt.hopeless;
  }

  // All strips between these lines, or none.
  bool cut(const std::vector<double>& lines) {
    layout_.strips.clear();
    std::vector<std::vector<RibFit>> free;
    for (std::size_t i = 0; i + 1 < lines.size(); ++i) {
      free.push_back(fit_ribs(targets_, lines[i], lines[i + 1], settings_.fit));
    }
    std::vector<std::vector<RibFit>> joined = free;
    join_pieces(joined, allowed_mm(settings_));
    for (std::size_t i = 0; i < free.size(); ++i) {
      Attempt attempt = try_share(chain_, joined[i], Purpose::kStrip, settings_);
      const bool clamped = joined[i].front().clamp_start || joined[i].front().clamp_end;
      if (!attempt.strip && clamped) attempt = try_share(chain_, free[i], Purpose::kStrip, settings_);
      if (!attempt.strip) {
        listen(attempt);
        return false;
      }
      layout_.strips.push_back(std::move(*attempt.strip));
    }
    lines_ = lines;
    return true;
  }

  void measure_seams() {
    for (std::size_t i = 1; i < layout_.strips.size(); ++i) {
      layout_.strips[i].seam_before = measure_seam(layout_.strips[i - 1].ribs, layout_.strips[i].ribs);
    }
  }

  // Solves the strip's ribs together; a result that its blade cannot serve is given up.
  void smooth(StripPlan& strip) const {
    std::vector<RibFit> ribs = strip.ribs;
    const double allowed = allowed_mm(settings_);
    const JointFitReport joint = joint_fit(
        ribs, {strip.blade_length_mm, strip.share_a, settings_.motion.feed_mm_s, 0.1 * allowed, allowed});
    const BladeReport blade =
        choose_blade(ribs, strip, block_around(ribs, strip, settings_.stock), settings_);
    strip.joint = {joint.acceleration_before_mm_s2, joint.acceleration_before_mm_s2, 0};
    if (joint.weight == 0 || !blade.choice || blade.choice->length_mm > strip.blade_length_mm) return;
    StripPlan next = make_strip_plan(chain_, {ribs, blade}, settings_);
    if (edge_over_stock(next.stock.size_mm, settings_.stock)) return;
    next.joint = joint;
    next.separate = std::make_shared<const StripPlan>(strip);
    strip = std::move(next);
  }

  // Longer ribs than any blade or block need no fit to be told.
  [[nodiscard]] bool may_serve(double u0, double u1) const {
    return (u1 - u0) * longest_rib_mm() < settings_.blade.free_lengths_mm.back();
  }

  bool split() {
    const ShareTest test = [&](double u0, double u1) -> std::optional<double> {
      if (hopeless_ || (u1 - u0 < 1 && !may_serve(u0, u1))) return std::nullopt;
      const Attempt attempt =
          try_share(chain_, fit_ribs(targets_, u0, u1, settings_.fit), Purpose::kSearch, settings_);
      if (attempt.strip) return attempt.strip->ribs[worst_rib(attempt.strip->ribs)].deviation_mm;
      listen(attempt);
      return std::nullopt;
    };
    const Split found =
        split_ribs(test, {steps(), least_pieces() + std::min(settings_.fit.max_splits, most_more_)});
    return !found.lines.empty() && (cut(found.lines) || cut(found.farthest));
  }

  // Pieces that the longest rib needs for its length alone: no strip is longer than a blade or a block.
  [[nodiscard]] int least_pieces() const {
    const auto& stock = settings_.stock.max_size_mm;
    const double most =
        std::min(settings_.blade.free_lengths_mm.back(), *std::max_element(stock.begin(), stock.end()));
    return static_cast<int>(std::ceil(longest_rib_mm() / most));
  }

  [[nodiscard]] double longest_rib_mm() const {
    double longest = 0;
    for (const RibTarget& rib : targets_) longest = std::max(longest, rib.s.back());
    return longest;
  }

  // Lines about 20 mm apart are finer than a seam needs to be placed; 24 steps do for short ribs.
  [[nodiscard]] int steps() const {
    constexpr double kStepMm = 20;
    return std::clamp(static_cast<int>(longest_rib_mm() / kStepMm), 24, 2400);
  }

  // Adds ribs where the surface between them is off; false when it is near enough everywhere.
  bool refine() {
    std::vector<FittedShare> strips;
    for (std::size_t i = 0; i < layout_.strips.size(); ++i) {
      strips.push_back({lines_[i], lines_[i + 1], layout_.strips[i].ribs});
    }
    const double limit = settings_.fit.between_share * settings_.design.tolerance_mm;
    const std::vector<std::size_t> more = ribs_to_add(sections_, ribs_, strips, limit);
    ribs_.insert(ribs_.end(), more.begin(), more.end());
    std::sort(ribs_.begin(), ribs_.end());
    return !more.empty();
  }

  const ChainTarget& chain_;
  std::span<const RibTarget> sections_;
  const Settings& settings_;
  int most_more_;
  std::vector<std::size_t> ribs_;   // sections that have a rib
  std::vector<RibTarget> targets_;  // of them
  std::vector<double> lines_;
  StripLayout layout_;
  Refusal said_;
  bool fitted_ = false, hopeless_ = false;
};

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

std::vector<Part> lay_out_runs(const std::vector<Run>& runs, const Settings& settings,
                               std::size_t most_more) {
  std::vector<Part> parts(runs.size());
  tbb::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t i) {
    parts[i] = {runs[i].place, RunLayout(*runs[i].chain, runs[i].sections(), settings, most_more).run()};
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
                              std::size_t most_more) {
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
    std::vector<Part> parts = lay_out_runs(runs, settings, most_more);
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
                                              const Settings& settings, std::size_t most_more) {
  std::vector<std::vector<Part>> by_chain(chains.size());
  std::vector<Run> runs;
  std::vector<std::size_t> chain_of;
  for (std::size_t i = 0; i < chains.size(); ++i) {
    if (targets.chains[chains[i]].planes.turns()) {
      by_chain[i] = lay_out_fan(targets, chains[i], settings, most_more);
    } else {
      add_runs(targets, chains[i], settings, 1, runs);
    }
    chain_of.resize(runs.size(), i);
  }
  std::vector<Part> parts = lay_out_runs(runs, settings, most_more);
  for (std::size_t i = 0; i < parts.size(); ++i) by_chain[chain_of[i]].push_back(std::move(parts[i]));
  return by_chain;
}

// Chains of the targets, laid out across gaps where that takes fewer strips than the chains beside the gaps
// on their own. Those are laid out only where they may be as few.
class ChainLayout {
 public:
  ChainLayout(const TargetReport& targets, const Settings& settings, std::size_t most_more)
      : targets_(targets), settings_(settings), most_more_(most_more), by_chain_(targets.chains.size()) {}

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
    return lay_out_chains(whole, all, settings_, most_more_);
  }

  void lay_out_apart(const std::vector<char>& bridged_over) {
    std::vector<std::size_t> chains;
    for (std::size_t c = 0; c < by_chain_.size(); ++c) {
      if (bridged_over[c] == 0) chains.push_back(c);
    }
    std::vector<std::vector<Part>> laid = lay_out_chains(targets_, chains, settings_, most_more_);
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
  std::vector<std::vector<Part>> by_chain_;
};

}  // namespace

Frame StripPlan::swept_plane(double offset_mm) const {
  if (!planes.turns()) return plane(offset_mm);
  const double first = ribs.front().offset_mm, last = ribs.back().offset_mm;
  const double inside = std::clamp(offset_mm, first, last), outside = offset_mm - inside;
  // Turning fades out over this way: half of it is turned, the rest goes straight on.
  constexpr double kFadeMm = 10;
  const double u = std::min(1.0, std::abs(outside) / kFadeMm);
  const double turned = std::copysign(kFadeMm * (u - u * u * u + 0.5 * u * u * u * u), outside);
  Frame frame = plane(inside + turned);
  frame.origin += (outside - turned) * planes.normal(inside);
  return frame;
}

std::optional<StripPlan> with_shorter_blade(const StripPlan& strip, const Settings& settings) {
  Settings shorter = settings;
  std::erase_if(shorter.blade.free_lengths_mm, [&](double mm) { return mm >= strip.blade_length_mm; });
  if (shorter.blade.free_lengths_mm.empty()) return std::nullopt;
  const Served served =
      serve(strip, calmed(strip.ribs, kLeastTensionWeight), allowed_mm(settings), Purpose::kStrip, shorter);
  if (!served.blade.choice) return std::nullopt;
  StripPlan next = make_strip_plan(strip, served, settings);
  if (edge_over_stock(next.stock.size_mm, settings.stock)) return std::nullopt;
  next.id = strip.id;
  next.seam_before = strip.seam_before;
  return next;
}

elastica::Elastica extended(const elastica::Elastica& rib, double blade_length_mm, double share_a) {
  const double before = share_a * (blade_length_mm - rib.length);
  return segment(rib, -before, blade_length_mm - before);
}

StripLayout lay_out_strips(const TargetReport& targets, const Settings& settings, std::size_t most_more) {
  StripLayout layout;
  layout.refusals = targets.refusals;
  layout.warnings = targets.warnings;
  int number = 1;
  for (std::vector<Part>& parts : ChainLayout(targets, settings, most_more).run()) {
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

#include "pipeline/plan/sweep/sweep_search.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "gpu/backend/stop.hpp"
#include "pipeline/plan/sweep/sweep_directions.hpp"
#include "pipeline/plan/sweep/sweep_layout.hpp"
#include "pipeline/plan/sweep/sweep_ranking.hpp"
#include "pipeline/plan/sweep/sweep_tried.hpp"
#include "pipeline/plan/sweep/sweep_turning.hpp"
#include "pipeline/sayings/saying.hpp"

namespace hotblade::pipeline {

namespace {

class Search {
 public:
  Search(const surface::DesignSurface& design, double waste_side, const Settings& settings,
         const SweepJudges& judges, const WatchSweeps& watch, const BandsOfSweep& bands,
         std::size_t most_parts)
      : settings_(settings),
        judges_(judges),
        bands_(bands),
        most_parts_(most_parts),
        fitter_(settings, watch),
        layouts_(design.mesh, waste_surface(design.mesh, waste_side),
                 sweep_planes(design.mesh, settings.slice), settings, fitter_),
        turning_(layouts_, settings) {}

  [[nodiscard]] const std::vector<PlanesTried>& tried_planes() const { return tried_planes_; }

  // Layouts in the order of their parts and costs, each attempted until one is taken.
  void run() {
    const std::size_t fewest = layouts_.fewest_parts();
    if (fewest > kMostStrips) return refuse_so_many(first_try({}, SweepWay::kEven), fewest);
    if (fewest <= most_parts_) fewest > kMostEven ? run_rows() : run_even(fewest);
  }

 private:
  // Beyond so many parts in all, even ones are no longer tried: what fails of them is split where it fails.
  static constexpr std::size_t kMostEven = 4;
  // Planes that are split before any strip is looked at, and the most parts that come of it.
  static constexpr std::size_t kPartedPlanes = 6, kMostParted = 12;
  static constexpr int kPartedTries = 3, kPartedRounds = 5;
  static constexpr double kNear = 4;  // tolerances that a cheap fit comes down by at most

  // A design of many parts, in rows of blocks.
  void run_rows() {
    // A round that ends at strips by themselves takes a tenth of the time of one that fits and measures all.
    constexpr int kMostRounds = 16;
    Tried laid = first_try(layouts_.in_rows(tried_planes_), SweepWay::kRows);
    if (laid.layout.parts.empty()) return refuse_so_many(laid, laid.layout.grid.count());
    auto [tried, coarse] = coarsest_first(std::move(laid));
    if (coarse) return refuse(tried, *coarse);
    tried.many = true;
    tried = attempt(std::move(tried));
    if (!tried.taken) tried = settled(std::move(tried), kMostRounds);
    if (!tried.taken && tried.lone) judges_.given_up(plan_of(tried, tried.joined));
  }

  // A design of few: the best layouts of even parts, fewer parts first; then the one that came nearest is
  // split where it fails.
  void run_even(std::size_t fewest) {
    constexpr std::size_t kMostTries = 3;
    constexpr int kMostRounds = 8;
    const double tolerance = settings_.design.tolerance_mm;
    std::size_t tries = 0;
    Tried nearest, first;
    std::vector<Tried> open;  // what parted() has not split yet
    // In planes of their own each; those that blocks allow so few parts in come first.
    std::vector<surface::PlaneFamily> opened;
    const std::size_t most_even = std::min(kMostEven, most_parts_);
    for (std::size_t parts = fewest; parts <= most_even && tries < kMostTries; ++parts) {
      // One failing strip split costs no more strips than even parts do.
      if (nearest.layout.parts.size() + 1 == parts && nearest.failing() == 1)
        nearest = settled(std::move(nearest), 1);
      if (nearest.taken) return;
      if (parts >= fewest + 2) {
        Tried tried = parted(open, parts - 1);
        if (tried.taken) return;
        if (!tried.layout.parts.empty() && better(tried, nearest)) nearest = std::move(tried);
      }
      SweepRanking ranking(layouts_, parts, tolerance, tried_planes_);
      std::vector<Tried> failed = attempted_best(ranking);
      if (!failed.empty() && failed.back().taken) return;
      const std::vector<Layout>& ranked = ranking.layouts();
      if (failed.empty() && nearest.layout.parts.empty())
        nearest = hanging_too_far(ranked, kNear * tolerance, tolerance);
      if (first.layout.parts.empty() && !ranked.empty()) first = first_try(ranked.front(), SweepWay::kEven);
      for (const Layout& layout : ranked) {
        if (opened.size() < kPartedPlanes && opens(layout, opened))
          open.push_back(first_try(layout, SweepWay::kParted));
      }
      tries += failed.empty() ? 0 : 1;
      for (Tried& tried : failed) {
        tried = attempted_further(std::move(tried));
        if (tried.taken) return;
        if (better(tried, nearest)) nearest = std::move(tried);
      }
    }
    // Of two layouts that mirror each other one may fail at a corner where the other does not.
    for (int i = 0; i <= kPartedTries; ++i) {
      if (i > 0) nearest = parted(open, kMostParted);
      if (nearest.taken) return;
      if (nearest.layout.parts.empty()) continue;
      first = {};
      nearest = settled(std::move(nearest), i > 0 ? kPartedRounds : kMostRounds);
      if (nearest.taken) return;
    }
    if (!first.layout.parts.empty()) (void)settled(std::move(first), kMostRounds);
  }

  // Attempts the best of the ways that promise the most, and where none is taken the best of all. Returns the
  // best as attempted, up to one that is taken.
  [[nodiscard]] std::vector<Tried> attempted_best(SweepRanking& ranking) const {
    ranking.fit_best();
    std::vector<Tried> before = attempted(ranking, {});
    if (ranking.all_fitted() || (!before.empty() && before.back().taken)) return before;
    ranking.fit_all();
    return attempted(ranking, std::move(before));
  }

  // Attempts the best of what is fitted, but those that failed `before`.
  [[nodiscard]] std::vector<Tried> attempted(const SweepRanking& ranking, std::vector<Tried> before) const {
    std::vector<Tried> failed;
    for (Layout& layout : refined(ranking.layouts(), before)) {
      const auto known = find(before, layout);
      failed.push_back(known != before.end() ? std::move(*known)
                                             : attempt(first_try(std::move(layout), SweepWay::kEven)));
      if (failed.back().taken) break;
    }
    return failed;
  }

  // What was attempted of a layout, however its planes were turned since.
  [[nodiscard]] static std::vector<Tried>::iterator find(std::vector<Tried>& before, const Layout& layout) {
    return std::find_if(before.begin(), before.end(),
                        [&](const Tried& tried) { return tried.layout.named == layout.named; });
  }

  // Tells whether a layout is the first in its planes, which are added then.
  [[nodiscard]] static bool opens(const Layout& layout, std::vector<surface::PlaneFamily>& opened) {
    const auto same = [&](const surface::PlaneFamily& planes) {
      return planes.normal(0) == layout.planes.normal(0) && planes.axis() == layout.planes.axis() &&
             planes.centre() == layout.planes.centre();
    };
    if (std::any_of(opened.begin(), opened.end(), same)) return false;
    opened.push_back(layout.planes);
    return true;
  }

  // The best planes split where no strip serves, before any is looked at: the layout of the fewest parts that
  // all have a strip, attempted; an empty one where there is none of so many.
  [[nodiscard]] Tried parted(std::vector<Tried>& open, std::size_t most) const {
    // Tolerances that a cheap fit may be off by to be planned at all; with four, parts are split that more
    // coefficients would have served.
    constexpr double kPlanned = 10;
    // Splits in a row of which no half has a strip: more of them end as often as not in slivers.
    constexpr int kVain = 2;
    while (!open.empty()) {
      const auto next = std::min_element(open.begin(), open.end(), smaller);
      if (next->layout.parts.size() > most) break;
      Tried tried = std::move(*next);
      open.erase(next);
      tried.failed.clear();
      for (const PartFit& fit : tried.layout.fits)
        tried.failed.push_back(!(fit.cost_mm <= kPlanned * settings_.design.tolerance_mm));
      if (tried.failing() == 0) {
        plan_parts(tried);
        if (all_made(tried.plans)) return attempt(std::move(tried));
        for (std::size_t i = 0; i < tried.plans.size(); ++i) tried.failed[i] = !tried.plans[i].strip;
      }
      const int vain = !tried.halves.empty() && tried.fruitless() ? tried.vain + 1 : 0;
      if (vain >= kVain) continue;
      if (std::optional<Tried> more = split(tried, std::min(kMostParted, most_parts_))) {
        more->way = SweepWay::kParted;
        more->vain = vain;
        open.push_back(std::move(*more));
      }
    }
    return {};
  }

  // Hands a layout over that no attempt is worth.
  void refuse(const Tried& tried, const Refusal& refusal) const {
    SweptPlan none;
    none.way = tried.way;
    none.planes = tried.layout.planes;
    none.parts = tried.layout.parts.size();
    none.refusals = {refusal};
    (void)judges_.together(none);
  }

  void refuse_so_many(const Tried& tried, std::size_t parts) const {
    refuse(tried, {"design", "", Limit::kStrips, static_cast<double>(parts), kMostStrips,
                   say(Saying::kUnitOrParts, {settings_.design.units})});
  }

  // Of many parts, those whose facets leave the most to a smooth cut are planned first: where they leave more
  // than the tolerance and no family comes nearer, no split into parts larger than facets does. Returns the
  // layout with these plans, and why that is the end.
  [[nodiscard]] std::pair<Tried, std::optional<Refusal>> coarsest_first(Tried tried) const {
    constexpr std::size_t kFirst = 3;
    tried.plans.resize(tried.layout.parts.size());
    for (const auto& [i, rise] : coarsest(tried.layout, settings_.design.tolerance_mm, kFirst)) {
      PartPlan& plan = tried.plans[i];
      plan = fitter_.plan(tried.layout.parts[i], tried.layout.fits[i]);
      if (plan.strip || !plan.refusal || plan.refusal->limit != Limit::kDeviation) continue;
      Refusal coarse = *plan.refusal;
      coarse.strip = fmt::format("S{:03}", i + 1);
      coarse.value = rise.off_mm;
      coarse.note = say(Saying::kOverFacets, {rise.facet_mm});
      set_place(tried.layout.parts[i], plan.fit, coarse);
      return {std::move(tried), coarse};
    }
    return {std::move(tried), std::nullopt};
  }

  // Plans the parts that have none yet.
  void plan_parts(Tried& tried) const {
    const std::size_t count = tried.layout.parts.size();
    tried.plans.resize(count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
      PartPlan& plan = tried.plans[i];
      if (!plan.strip) plan = fitter_.plan(tried.layout.parts[i], tried.layout.fits[i]);
    });
    gpu::stop_point();
    if (all_made(tried.plans)) {
      tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
        PartPlan& plan = tried.plans[i];
        if (!plan.held) plan = fitter_.steadied(tried.layout.parts[i], std::move(plan));
      });
      gpu::stop_point();
    }
  }

  // Parts that are not settled meet the others as they are by themselves.
  static void unjoin(Tried& tried) {
    tried.settled.resize(tried.plans.size());
    tried.joined.resize(tried.plans.size());
    for (std::size_t i = 0; i < tried.plans.size(); ++i) {
      if (!tried.settled[i]) tried.joined[i] = tried.plans[i];
    }
  }

  // Fits planned parts together; whether all have a strip.
  bool join_parts(Tried& tried) const {
    unjoin(tried);
    if (!all_made(tried.plans)) return false;
    tried.joined = fitter_.join(tried.layout.parts, tried.plans, std::move(tried.joined), tried.settled);
    tried.settled.assign(tried.plans.size(), true);
    return all_made(tried.joined);
  }

  // What a blade melts depends on its speed, and its speed on the path that it is offset to: planned again
  // with the bands of the plan before, until these stay.
  void settle_bands(Tried& tried) const {
    constexpr int kLooks = 4;
    // A tenth of what the budget calls exact; a look takes off nine tenths of what the one before was off by.
    constexpr double kSameMm = 0.005;
    for (int look = 0; look < kLooks; ++look) {
      Tried before = tried;
      const auto bands = bands_(plan_of(tried, tried.joined));
      double change = 0;
      for (std::size_t i = 0; i < bands.size(); ++i) {
        if (!bands[i]) continue;
        SweepPart& part = tried.layout.parts[i];
        change = std::max(change, bands[i]->farthest_mm(part.bands.get(), nominal_band_mm()));
        part.bands = bands[i];
      }
      if (change <= kSameMm) return;
      tbb::parallel_for(std::size_t{0}, tried.plans.size(), [&](std::size_t i) {
        tried.plans[i] = fitter_.again(tried.layout.parts[i], tried.plans[i]);
      });
      gpu::stop_point();
      tried.settled.clear();
      if (join_parts(tried)) continue;
      tried = std::move(before);  // whose cut the verification says
      return;
    }
  }

  [[nodiscard]] double nominal_band_mm() const { return settings_.blade.band_mm(settings_.motion.feed_mm_s); }

  // Plans the parts and has the whole judged, what fails of it once more as it was before its blades were
  // made steadier.
  [[nodiscard]] Tried attempt(Tried tried) const {
    tried.taken = look_at(tried);
    if (tried.taken) return tried;
    bool any = false;
    for (std::size_t i = 0; i < tried.plans.size(); ++i) {
      PartPlan& plan = tried.plans[i];
      if (!tried.failed[i] || !plan.unsteady) continue;
      const std::shared_ptr<const PartPlan> before = plan.unsteady;
      plan = *before;
      changed(tried, i);
      any = true;
    }
    if (!any) return tried;
    tried.way = SweepWay::kUnsteady;
    tried.taken = look_at(tried);
    return tried;
  }

  // A part has another plan.
  static void changed(Tried& tried, std::size_t i) {
    if (i < tried.served.size()) tried.served[i] = false;
    if (i < tried.settled.size()) tried.settled[i] = false;
  }

  // The steps of an attempt change what it was given; whether the plan is taken.
  bool look_at(Tried& tried) const {
    plan_parts(tried);
    return (!tried.many || serve_alone(tried)) && look_together(tried);
  }

  // Has the parts looked at by themselves that were not so before; whether all of them serve.
  bool serve_alone(Tried& tried) const {
    const std::size_t count = tried.layout.parts.size();
    tried.served.resize(count);
    unjoin(tried);
    tried.lone = true;
    tried.forget();
    std::vector<std::size_t> looked;
    for (std::size_t i = 0; i < count; ++i) {
      const PartPlan& plan = tried.plans[i];
      if (plan.strip) {
        if (!tried.served[i]) looked.push_back(i);
        continue;
      }
      tried.failed[i] = true;
      tried.too_far[i] = plan.refusal && plan.refusal->limit == Limit::kDeviation;
    }
    if (looked.empty() && tried.failing() == 0) return true;
    const SweepVerdict verdict = judges_.alone(plan_of(
        tried, tried.plans, [&](std::size_t i) { return !tried.plans[i].strip || !tried.served[i]; }));
    note(tried, tried.plans, looked, verdict);
    for (const std::size_t i : looked) tried.served[i] = !tried.failed[i];
    return tried.failing() == 0;
  }

  // What a look found of some parts, each as it is in these plans.
  static void note(Tried& tried, const std::vector<PartPlan>& plans, const std::vector<std::size_t>& looked,
                   const SweepVerdict& verdict) {
    for (std::size_t k = 0; k < looked.size(); ++k) {
      const std::size_t i = looked[k];
      tried.failed[i] = !verdict.failed.empty() && verdict.failed[k];
      tried.too_far[i] = !verdict.too_far.empty() && verdict.too_far[k];
      tried.misshapen[i] = !verdict.misshapen.empty() && verdict.misshapen[k];
      if (!verdict.deviation_mm.empty())
        tried.plans[i].beyond_fit_mm = verdict.deviation_mm[k] - plans[i].fit.max_mm;
    }
  }

  // Fits the parts together and has the whole judged, as long as what is found of them may let a next fit
  // meet better; whether it is taken. Where others have to be split, those that may are left to the fit after
  // that.
  bool look_together(Tried& tried) const {
    constexpr int kMeetings = 2;
    for (int meeting = 0; meeting < kMeetings; ++meeting) {
      if (meet(tried)) return true;
      std::vector<std::size_t> may;
      for (std::size_t i = 0; i < tried.failed.size(); ++i)
        if (tried.failed[i] && may_meet(tried, i)) may.push_back(i);
      if (may.empty()) return false;
      const bool all = may.size() == tried.failing();
      for (const std::size_t i : may) {
        tried.settled[i] = false;
        tried.failed[i] = all;
      }
      if (!all) return false;
      tried.way = SweepWay::kMet;
    }
    return meet(tried);
  }

  // Whether a strip that failed would serve by its own fit, and left the design too far as it met others.
  [[nodiscard]] bool may_meet(const Tried& tried, std::size_t i) const {
    const PartPlan& plan = tried.plans[i];
    return tried.joined[i].strip && tried.too_far[i] && plan.beyond_fit_mm &&
           plan.fit.max_mm <= fitter_.most_mm(plan);
  }

  bool meet(Tried& tried) const {
    if (join_parts(tried) && bands_) settle_bands(tried);
    const SweptPlan plan = plan_of(tried, tried.joined);
    tried.lone = tried.many && plan.refusals.empty() && !meets_coarsely(tried);
    if (tried.lone) return false;
    const SweepVerdict verdict = judges_.together(plan);
    if (verdict.taken) return true;
    note_met(tried, plan, verdict);
    return false;
  }

  // Of many parts, has those looked at as coarsely as before that meeting the others may have led too far
  // off, by what was found of them; whether they still serve.
  bool meets_coarsely(Tried& tried) const {
    constexpr double kSure = 0.9;  // of the tolerance: the look before told of another fit
    const double sure_mm = kSure * settings_.design.tolerance_mm;
    std::vector<std::size_t> doubtful;
    for (std::size_t i = 0; i < tried.plans.size(); ++i) {
      const std::optional<double>& beyond = tried.plans[i].beyond_fit_mm;
      if (!beyond || !(tried.joined[i].fit.max_mm + *beyond <= sure_mm)) doubtful.push_back(i);
    }
    tried.forget();
    if (doubtful.empty()) return true;
    const auto is_doubtful = [&](std::size_t i) {
      return std::binary_search(doubtful.begin(), doubtful.end(), i);
    };
    note(tried, tried.joined, doubtful, judges_.alone(plan_of(tried, tried.joined, is_doubtful)));
    return tried.failing() == 0;
  }

  // Planes that served their samples and failed when all of the cut was looked at are turned on, as those are
  // that do not serve: before a panel takes a strip more, its planes come as near as they can. Returns the
  // better of both.
  [[nodiscard]] Tried attempted_further(Tried tried) const {
    if (tried.layout.turned) return tried;
    Layout nearer = turning_.turned_on(tried.layout);
    if (!(nearer.cost_mm < tried.layout.cost_mm)) return tried;
    Tried other = attempt(first_try(std::move(nearer), SweepWay::kTurned));
    if (other.taken || better(other, tried)) return other;
    return tried;
  }

  // Splits what fails until nothing does, or it is no use.
  [[nodiscard]] Tried settled(Tried tried, int rounds) const {
    // Rounds in a row in which every half failed again. Parts that are too large or face away may need a few
    // of them; where blades were tried, as many say enough.
    constexpr int kTooLarge = 3, kTooHard = 3;
    // A design that takes more than twice the parts that its size asks for is no design for a blade.
    const std::size_t most = std::min(4 * tried.layout.parts.size() + 16, most_parts_);
    int too_large = 0, too_hard = 0;
    for (int round = 0; round < rounds;) {
      const bool planned = tried.any_planned();
      // One that is calm may pass its neighbour's place at the seam on, which then has to be calm as well.
      std::optional<Tried> next = planned ? calmed(tried) : std::nullopt;
      const bool is_calmed = next.has_value();
      if (next) tried = std::move(*next);
      // What left the design too far may do so for a neighbour that is calmer now.
      const bool splits = tried.many ? tried.failing() > 0 : !is_calmed || tried.fails_by_itself();
      if (!is_calmed && !splits) return tried;
      if (splits) {
        next = split(tried, most);
        if (!next) return tried;
        tried = std::move(*next);
      }
      tried = attempt(std::move(tried));
      if (tried.taken) return tried;
      if (!splits) continue;
      ++round;
      const bool fruitless = tried.fruitless();
      too_large = fruitless && !tried.any_planned() ? too_large + 1 : 0;
      too_hard = fruitless && planned ? too_hard + 1 : 0;
      if (too_large >= kTooLarge || too_hard >= kTooHard) return tried;
    }
    return tried;
  }

  // With calmer fits of the failing strips, which lead the blade past a snap, but no nearer to the design;
  // these are no longer taken for failing. None where there are no such fits.
  [[nodiscard]] std::optional<Tried> calmed(Tried tried) const {
    bool any = false;
    for (std::size_t i = 0; i < tried.failed.size(); ++i) {
      const PartPlan& plan = tried.plans[i];
      // A calmer blade comes no nearer, hangs as far and moves as fast.
      if (!tried.failed[i] || !tried.misshapen[i] || tried.too_far[i] || !plan.strip) continue;
      PartPlan calmer = fitter_.plan(tried.layout.parts[i], tried.layout.fits[i], plan.calm);
      if (!calmer.strip) continue;
      tried.plans[i] = std::move(calmer);
      changed(tried, i);
      tried.failed[i] = false;
      tried.way = SweepWay::kCalmer;
      any = true;
    }
    if (!any) return std::nullopt;
    return tried;
  }

  // With the failing parts as two each; none where one cannot be split, or all would be too many.
  [[nodiscard]] std::optional<Tried> split(const Tried& tried, std::size_t most) const {
    const std::size_t count = tried.layout.parts.size();
    std::vector<std::vector<FittedPart>> pieces(count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
      if (tried.failed.empty() ? !tried.layout.fits[i].holds() : tried.failed[i])
        pieces[i] =
            layouts_.halves(tried.layout.parts[i], tried.layout.fits[i],
                            tried.plans.empty() ? tried.layout.fits[i].refusal : tried.plans[i].refusal);
    });
    gpu::stop_point();
    Tried next;
    next.way = SweepWay::kSplit;
    next.many = tried.many;
    next.layout.planes = tried.layout.planes;
    next.layout.named = tried.layout.named;
    for (std::size_t i = 0; i < count; ++i) {
      const bool fails = tried.failed.empty() ? !tried.layout.fits[i].holds() : tried.failed[i];
      if (fails && pieces[i].empty()) return std::nullopt;
      if (!fails) {
        next.layout.add({tried.layout.parts[i], tried.layout.fits[i]});
        next.plans.push_back(tried.plans.empty() ? PartPlan{} : tried.plans[i]);
        next.joined.push_back(tried.joined.empty() ? PartPlan{} : tried.joined[i]);
        next.settled.push_back(!tried.settled.empty() && tried.settled[i]);
        next.halves.push_back(false);
        next.served.push_back(!tried.served.empty() && tried.served[i]);
      }
      for (FittedPart& piece : pieces[i]) {
        next.layout.add(std::move(piece));
        next.plans.emplace_back();
        next.joined.emplace_back();
        next.settled.push_back(false);
        next.halves.push_back(true);
        next.served.push_back(false);
      }
    }
    if (next.layout.parts.size() > most) return std::nullopt;
    return next;
  }

  // The best few with more coefficients, turned where need be, those attempted `before` as they were; none
  // where cheap fits are hopelessly far off.
  [[nodiscard]] std::vector<Layout> refined(const std::vector<Layout>& ranked,
                                            std::vector<Tried>& before) const {
    constexpr std::size_t kBest = 3;
    const double tolerance = settings_.design.tolerance_mm;
    std::vector<Layout> best;
    for (const Layout& layout : ranked) {
      if (best.size() < kBest && layout.cost_mm <= kNear * tolerance) best.push_back(layout);
    }
    tbb::parallel_for(std::size_t{0}, best.size(), [&](std::size_t i) {
      const auto known = find(before, best[i]);
      best[i] = known != before.end() ? known->layout : turning_.turned(best[i]);
    });
    gpu::stop_point();
    constexpr double kHopeful = 1.5;  // tolerances
    std::erase_if(best, [&](const Layout& layout) { return !(layout.cost_mm <= kHopeful * tolerance); });
    std::sort(best.begin(), best.end(), layout_before);
    return best;
  }

  const Settings& settings_;
  const SweepJudges& judges_;
  const BandsOfSweep& bands_;
  std::size_t most_parts_;
  std::vector<PlanesTried> tried_planes_;
  PartFitter fitter_;
  SweepLayouts layouts_;
  PlaneTurning turning_;
};

}  // namespace

const char* name(SweepWay way) {
  switch (way) {
    case SweepWay::kEven:
      return "even";
    case SweepWay::kRows:
      return "rows";
    case SweepWay::kSplit:
      return "split";
    case SweepWay::kCalmer:
      return "calmer";
    case SweepWay::kTurned:
      return "turned";
    case SweepWay::kMet:
      return "met";
    case SweepWay::kUnsteady:
      return "unsteady";
    case SweepWay::kFaces:
      return "faces";
    case SweepWay::kParted:
      return "parted";
  }
  return "";
}

std::vector<PlanesTried> search_sweeps(const surface::DesignSurface& design, const Settings& settings,
                                       const SweepJudges& judges, const WatchSweeps& watch,
                                       const BandsOfSweep& bands, std::size_t most_parts) {
  const double side = waste_side(design.mesh, settings.design.keep);
  if (side == 0) return {};
  Search search(design, side, settings, judges, watch, bands, most_parts);
  search.run();
  return search.tried_planes();
}

}  // namespace hotblade::pipeline

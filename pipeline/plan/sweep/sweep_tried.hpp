// A layout that the search attempts, by value.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

#include "pipeline/plan/sweep/sweep_layout.hpp"
#include "pipeline/plan/sweep/sweep_search.hpp"

namespace hotblade::pipeline {

// A layout with the plans of its parts, and what of it failed. Attempts take and return it by value: what
// comes of one depends on it and on what the judges find.
struct Tried {
  Layout layout;
  SweepWay way = SweepWay::kEven;
  std::vector<PartPlan> plans;                   // each of its own
  std::vector<PartPlan> joined;                  // fitted together at their seams
  std::vector<bool> settled;                     // those that were, and have the same plan since
  std::vector<bool> failed, too_far, misshapen;  // what was found of the parts
  std::vector<bool> halves;                      // parts that came of the last split
  int vain = 0;                                  // splits in a row of which no half had a strip
  bool many = false;                             // parts: each is looked at by itself first
  std::vector<bool> served;                      // those that were, and did not fail
  bool lone = false;                             // the last look was at parts by themselves
  bool taken = false;
  // Whether all of these fail again.
  [[nodiscard]] bool fruitless() const {
    for (std::size_t i = 0; i < halves.size(); ++i) {
      if (halves[i] && !failed[i]) return false;
    }
    return true;
  }
  // Nothing is found of any part.
  void forget() {
    for (std::vector<bool>* found : {&failed, &too_far, &misshapen})
      found->assign(layout.parts.size(), false);
  }
  [[nodiscard]] std::size_t failing() const {
    return static_cast<std::size_t>(std::count(failed.begin(), failed.end(), true));
  }
  // Whether parts fail, each for a reason of its own.
  [[nodiscard]] bool fails_by_itself() const {
    for (std::size_t i = 0; i < failed.size(); ++i) {
      if (failed[i] && too_far[i]) return false;
    }
    return failing() > 0;
  }
  // Whether what failed was more than parts that no fit is tried for.
  [[nodiscard]] bool any_planned() const {
    for (std::size_t i = 0; i < failed.size(); ++i) {
      if (failed[i] && layout.fits[i].holds()) return true;
    }
    return false;
  }
};

// Returns a layout that nothing is planned of yet.
[[nodiscard]] Tried first_try(Layout layout, SweepWay way);

// Returns the first of these layouts that costs no more than `most_mm`, whose one part comes within the
// tolerance but for what weight moves: as failed, since a narrower fan hangs less. An empty one where there
// is none.
[[nodiscard]] Tried hanging_too_far(const std::vector<Layout>& layouts, double most_mm, double tolerance_mm);

// Notes what a look found of all parts as they meet.
void note_met(Tried& tried, const SweptPlan& plan, const SweepVerdict& verdict);

// Tells whether every part has a strip.
[[nodiscard]] bool all_made(const std::vector<PartPlan>& plans);

// Tells whether `a` has fewer parts, or as many and costs less.
[[nodiscard]] bool smaller(const Tried& a, const Tried& b);

// Tells whether `a` is the one to go on with: fewer strips when what failed is split, then a smaller cost.
[[nodiscard]] bool better(const Tried& a, const Tried& b);

// Returns what is handed over of the parts that are asked for, with plans of their own or joined ones.
[[nodiscard]] SweptPlan plan_of(
    const Tried& tried, const std::vector<PartPlan>& plans,
    const std::function<bool(std::size_t)>& asked = [](std::size_t) { return true; });

// Sets the place of a refusal: where the fit is farthest from the design, if that is the reason; the middle
// of the part otherwise.
void set_place(const SweepPart& part, const PartFit& fit, Refusal& refusal);

}  // namespace hotblade::pipeline

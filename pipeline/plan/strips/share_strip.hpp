// One share of some ribs as a strip: the calmest fits that a blade serves, that blade, and the block.
#pragma once

#include <optional>
#include <vector>

#include "pipeline/plan/motion/blade.hpp"
#include "pipeline/plan/strips/strips.hpp"

namespace hotblade::pipeline {

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

// Returns the strip of a share's fits, or what stands against it.
[[nodiscard]] Attempt try_share(const ChainTarget& chain, const std::vector<RibFit>& closest, Purpose purpose,
                                const Settings& settings);

// Returns the strip of these ribs and the blade chosen for them, without a name.
[[nodiscard]] StripPlan make_strip_plan(const RibAxes& axes, const std::vector<RibFit>& ribs,
                                        const BladeChoice& blade, const Settings& settings);

// Returns whether the strip's block fits the stock, turned any way.
[[nodiscard]] bool fits_stock(const StripPlan& strip, const Settings& settings);

// Returns how far a rib's elastica may be off its target, mm.
[[nodiscard]] double allowed_mm(const Settings& settings);

// Returns the index of the rib with the largest deviation.
[[nodiscard]] std::size_t worst_rib(const std::vector<RibFit>& ribs);

}  // namespace hotblade::pipeline

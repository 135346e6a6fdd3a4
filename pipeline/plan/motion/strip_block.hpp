// The block around a strip's ribs, and how it stands on the table.
#pragma once

#include <vector>

#include "pipeline/plan/motion/blade.hpp"
#include "pipeline/plan/ribs/strip_plan.hpp"

namespace hotblade::pipeline {

// The block's height above the table where machine.plinth_mm leaves it open: what a blade's way out below the
// block mostly needs.
inline constexpr double kUsualPlinthMm = 150;

// Returns the block around the ribs, stock.border_mm and stock.base_mm of foam included, along the axes of
// their middle plane: its frame's x and y are that plane's, so x runs along the ribs and y to the waste.
[[nodiscard]] Block block_around(const std::vector<RibFit>& ribs, const RibAxes& axes,
                                 const StockSettings& settings);

// Returns the design's place in the cell: the ribs' middle plane level, the sweep downwards, the ribs' x
// kept, the block's bottom on the plinth and its middle above the table's.
[[nodiscard]] Pose on_table(const std::vector<RibFit>& ribs, const RibAxes& axes, const Settings& settings);

// Returns the strip of some ribs and the blade chosen for them, in its block on the table; without a name.
[[nodiscard]] StripPlan make_strip_plan(const RibAxes& axes, const std::vector<RibFit>& ribs,
                                        const BladeChoice& blade, const Settings& settings);

// Tells whether the strip's block is within stock.max_size_mm, turned any way.
[[nodiscard]] bool fits_stock(const StripPlan& strip, const Settings& settings);

}  // namespace hotblade::pipeline

// The foam that a program's blocks are sawn out of.
#pragma once

#include <functional>
#include <optional>

#include "pipeline/program/program.hpp"
#include "pipeline/stock/nest.hpp"

namespace hotblade::pipeline {

// Returns how the blocks of a program's strips, in their order, lie in stock of `stock.sizes_mm`; nothing
// where no sizes are set, there are no strips, or a block is empty or within none of them.
// `watch` as for nest().
[[nodiscard]] std::optional<Nesting> foam_to_buy(const Program& program,
                                                 const std::function<void()>& watch = {});

}  // namespace hotblade::pipeline

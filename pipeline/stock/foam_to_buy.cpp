#include "pipeline/stock/foam_to_buy.hpp"

#include <algorithm>

namespace hotblade::pipeline {

std::optional<Nesting> foam_to_buy(const Program& program, const std::function<void()>& watch) {
  const StockSettings& stock = program.settings.stock;
  if (stock.sizes_mm.empty() || program.strips.empty()) return std::nullopt;
  std::vector<BoxSize> pieces;
  for (const Strip& strip : program.strips) {
    const Eigen::Vector3d& size = strip.block.size_mm;
    pieces.push_back({size.x(), size.y(), size.z()});
    if (!(size.minCoeff() > 0) || !size.allFinite()) return std::nullopt;
    if (std::none_of(stock.sizes_mm.begin(), stock.sizes_mm.end(),
                     [&](const BoxSize& sold) { return holds(sold, pieces.back()); }))
      return std::nullopt;
  }
  return nest(pieces, stock.sizes_mm, stock.saw_mm, watch);
}

}  // namespace hotblade::pipeline

// The foam that is bought for a whole batch: the blocks of all its panels, nested together.
#pragma once

#include <compare>
#include <cstddef>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "pipeline/batch/cut_list.hpp"
#include "pipeline/stock/nest.hpp"

namespace hotblade::pipeline::batch {

// What foam is sold in, and what a saw takes of it, as the settings of a job have it (stock.sizes_mm,
// saw_mm).
struct SoldFoam {
  std::vector<BoxSize> sizes_mm;  // none: the job says nothing of it
  double saw_mm = 0;
  auto operator<=>(const SoldFoam&) const = default;
};

// One block that is bought. Its pieces are numbered as the blocks of the cut list.
struct BoughtFoam {
  BoughtBlock block;
  double saw_mm = 0;
};

struct FoamList {
  std::vector<BoughtFoam> bought;          // in the order in which their first pieces are cut
  std::map<BlockSize, std::size_t> sizes;  // how many of each, the longest side first
  double bought_m3 = 0, pieces_m3 = 0;
  double each_m3 = 0;                  // what would be bought with a block of its own for every piece,
  double by_panel_m3 = 0;              // and with each panel nested alone
  std::vector<std::size_t> too_large;  // blocks of the cut list that no size holds
  std::vector<std::size_t> unsaid;     // and those whose settings name no size
  [[nodiscard]] bool empty() const { return bought.empty() && too_large.empty(); }
};

// Blocks are nested in lots of at most this many, in the order of cutting: what is sawn together is cut
// together, and the search takes seconds for ten thousand.
inline constexpr std::size_t kLotBlocks = 200;

// Returns the foam for the blocks of a cut list. `sold_for` says what the job of this number is cut from;
// blocks of jobs that say the same share foam. `watch` is called often; what it throws ends the search.
[[nodiscard]] FoamList foam_list(const CutList& list,
                                 const std::function<SoldFoam(std::size_t job)>& sold_for,
                                 const std::function<void()>& watch = {});

// Returns foam.csv: a line a piece.
[[nodiscard]] std::string foam_table(const FoamList& foam, const CutList& list);

// Returns foam.html: what to buy, and for each bought block the cuts and what comes free by them. `name` is
// the batch's.
[[nodiscard]] std::string foam_page(const std::string& name, const FoamList& foam, const CutList& list);

}  // namespace hotblade::pipeline::batch

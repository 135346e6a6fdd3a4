// Which foam to buy for a job's blocks, and where to saw: boxes packed into stock of a few sizes so that
// every piece comes free by cuts from face to face (guillotine cuts).
//
// Foam is the same along each axis: a piece may be turned any way. Sizes in mm.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace hotblade::pipeline {

using BoxSize = std::array<double, 3>;

// A box, and its corner with the smallest coordinates in the stock it comes from.
struct StockBox {
  BoxSize at{0, 0, 0}, size{0, 0, 0};
};

// One cut square to an axis of the stock, from face to face of the part that is left there. Parts are
// numbered as they come: 0 is the stock; the near side of a cut keeps the number, what is left beyond has the
// next one.
struct SawCut {
  std::size_t part = 0;  // that is cut
  StockBox of;           // the part before the cut
  int axis = 0;          // 0 to 2
  double at = 0;         // where the saw's near side is, from the part's own corner along the axis
  StockBox off;          // what is left beyond; without size where the saw takes it all
  [[nodiscard]] bool leaves() const { return off.size[0] > 0; }
};

// A piece as it lies in its stock, its size in the stock's axes.
struct NestedPiece {
  std::size_t piece = 0;
  std::size_t part = 0;  // SawCut, once all cuts are made
  StockBox box;
};

// One block that is bought, its pieces in the order in which they come free, and all cuts in order.
struct BoughtBlock {
  BoxSize size{0, 0, 0};
  std::vector<NestedPiece> pieces;
  std::vector<SawCut> cuts;
};

struct Nesting {
  std::vector<BoughtBlock> blocks;
  double bought_mm3 = 0;
  double pieces_mm3 = 0;
  double apart_mm3 = 0;  // what would be bought with a block of its own for every piece
};

// Returns how a part is called on the sheets to saw by: A, B, ... Z, AA, AB, ...
[[nodiscard]] std::string part_name(std::size_t part);

// Returns whether the size holds the piece, turned any way.
[[nodiscard]] bool holds(const BoxSize& size, const BoxSize& piece);

// Returns stock that holds all pieces, of the sizes that are sold, and how they lie in it: the least volume
// that some hundred orders of filling it find, not a proven least. A cut takes `saw_mm` of foam. The same
// input gives the same nesting, whatever the order of the sizes. No size or piece may be empty, not finite or
// not positive, and each piece needs a size that holds it (std::logic_error). `watch` is called every
// few milliseconds; what it throws ends the search.
[[nodiscard]] Nesting nest(std::span<const BoxSize> pieces, std::span<const BoxSize> sizes, double saw_mm,
                           const std::function<void()>& watch = {});

}  // namespace hotblade::pipeline

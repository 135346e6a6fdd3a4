// The folds of all blades of length 1 at once (fold.hpp), found when the program is built
// (generate_folds.cpp): a process would spend 15 ms on them.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "elastica/blade/fold.hpp"

namespace hotblade::elastica {

// Folds by rows of one size and columns of one phase, from 0 to pi.
class FoldTable {
 public:
  // Sizes up to 2, one fold in each cell.
  [[nodiscard]] static const FoldTable& shallow();
  // Sizes from 2.06 to 2.62, where forces of some shapes are stable again beyond those that are not; forces
  // from 41 to 161.
  [[nodiscard]] static const FoldTable& deep();
  static constexpr double kLongestDeepChord = 0.65;  // of those

  // `first` of each cell in `folds`, row by row, and the end; the edges' of each size, or none.
  FoldTable(int phases, std::span<const TabledFold> folds, std::span<const std::uint16_t> first,
            const std::array<std::span<const TabledFold>, 2>& edges)
      : phases_(phases), folds_(folds), first_(first), edges_(edges) {}

  [[nodiscard]] int sizes() const { return static_cast<int>(first_.size() - 1) / phases_; }
  [[nodiscard]] int phases() const { return phases_; }
  [[nodiscard]] std::span<const TabledFold> at(int size, int phase) const {
    const std::uint16_t* cell = first_.data() + size * phases_ + phase;
    return folds_.subspan(cell[0], static_cast<std::size_t>(cell[1] - cell[0]));
  }
  // Of each size, of the shallow ones.
  [[nodiscard]] std::span<const TabledFold> edge(FoldEdge edge) const {
    return edges_[static_cast<std::size_t>(edge)];
  }

 private:
  int phases_ = 0;
  std::span<const TabledFold> folds_;
  std::span<const std::uint16_t> first_;
  std::array<std::span<const TabledFold>, 2> edges_;
};

}  // namespace hotblade::elastica

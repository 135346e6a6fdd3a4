#include "pipeline/stock/nest.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <random>
#include <stdexcept>
#include <tuple>

namespace hotblade::pipeline {

namespace {

constexpr std::array<std::array<std::size_t, 3>, 6> kTurns{
    {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
// Sizes come from computations: what is smaller is rounding, and neither sawn off nor in the way.
constexpr double kSame_mm = 1e-6;

double volume(const BoxSize& size) {
  return size[0] * size[1] * size[2];
}

BoxSize sorted(BoxSize size) {
  std::sort(size.begin(), size.end(), std::greater<>());
  return size;
}

BoxSize turned(const BoxSize& size, const std::array<std::size_t, 3>& turn) {
  return {size[turn[0]], size[turn[1]], size[turn[2]]};
}

bool fits(const BoxSize& size, const BoxSize& room) {
  return size[0] <= room[0] + kSame_mm && size[1] <= room[1] + kSame_mm && size[2] <= room[2] + kSame_mm;
}

// The cuts that free a piece from the corner of a part, square to three axes one after the other: each takes
// off all beyond it.
using Split = std::vector<SawCut>;

Split split(const StockBox& part, const BoxSize& piece, const std::array<std::size_t, 3>& axes,
            double saw_mm) {
  Split cuts;
  StockBox rest = part;
  for (const std::size_t axis : axes) {
    const double beyond = rest.size[axis] - piece[axis];
    if (beyond <= kSame_mm) continue;
    SawCut cut{0, rest, static_cast<int>(axis), piece[axis], {}};
    if (beyond - saw_mm > kSame_mm) {
      cut.off = rest;
      cut.off.at[axis] += piece[axis] + saw_mm;
      cut.off.size[axis] = beyond - saw_mm;
    }
    cuts.push_back(cut);
    rest.size[axis] = piece[axis];
  }
  return cuts;
}

// Large offcuts are worth more than small ones of the same sum.
double worth(const Split& cuts) {
  double sum = 0;
  for (const SawCut& cut : cuts) sum += volume(cut.off.size) * volume(cut.off.size);
  return sum;
}

Split best_split(const StockBox& part, const BoxSize& piece, double saw_mm) {
  Split best = split(part, piece, kTurns[0], saw_mm);
  for (std::size_t i = 1; i < kTurns.size(); ++i) {
    Split other = split(part, piece, kTurns[i], saw_mm);
    if (worth(other) > worth(best)) best = std::move(other);
  }
  return best;
}

// Stock on the way to be filled.
struct Filling {
  struct Part {
    std::size_t number = 0;
    StockBox box;
  };
  BoughtBlock block;
  std::vector<Part> left;
  std::size_t parts = 1;  // that have a number

  explicit Filling(const BoxSize& size) : block{size, {}, {}}, left{{0, {{0, 0, 0}, size}}} {}
};

class Packer {
 public:
  Packer(std::span<const BoxSize> pieces, std::span<const BoxSize> sizes, double saw_mm,
         const std::function<void()>& watch)
      : pieces_(pieces), sizes_(sizes), saw_mm_(saw_mm), watch_(watch) {}

  // All pieces in this order. New stock is of the preferred size where that holds the piece, else of the
  // smallest that does.
  [[nodiscard]] std::vector<Filling> pack(const std::vector<std::size_t>& order, std::size_t preferred,
                                          bool flush) const {
    std::vector<Filling> filled;
    constexpr std::size_t kOften = 64;  // pieces: some milliseconds
    for (std::size_t i = 0; i < order.size(); ++i) {
      const std::size_t piece = order[i];
      if (watch_ && i % kOften == 0) watch_();
      if (!place(filled, piece, flush)) {
        filled.emplace_back(size_for(piece, preferred));
        (void)place(filled, piece, flush);
      }
    }
    for (Filling& filling : filled) shrink(filling, flush);
    return filled;
  }

  [[nodiscard]] const BoxSize& smallest_for(std::size_t piece) const {
    const BoxSize* best = nullptr;
    for (const BoxSize& size : sizes_) {
      if (holds(size, pieces_[piece]) && (!best || volume(size) < volume(*best))) best = &size;
    }
    if (!best) throw std::logic_error("no stock holds the piece");
    return *best;
  }

 private:
  [[nodiscard]] const BoxSize& size_for(std::size_t piece, std::size_t preferred) const {
    if (preferred < sizes_.size() && holds(sizes_[preferred], pieces_[piece])) return sizes_[preferred];
    return smallest_for(piece);
  }

  // Into the part that it leaves least of; or, where it shall lie flush, that it leaves least of along an
  // edge.
  bool place(std::vector<Filling>& filled, std::size_t piece, bool flush) const {
    using Fit = std::tuple<double, double, std::size_t, std::size_t, std::size_t>;
    std::optional<Fit> best;
    for (std::size_t f = 0; f < filled.size(); ++f) {
      for (std::size_t l = 0; l < filled[f].left.size(); ++l) {
        const BoxSize& room = filled[f].left[l].box.size;
        for (std::size_t t = 0; t < kTurns.size(); ++t) {
          const BoxSize size = turned(pieces_[piece], kTurns[t]);
          if (!fits(size, room)) continue;
          const double narrowest = std::min({room[0] - size[0], room[1] - size[1], room[2] - size[2]});
          const double unused = volume(room) - volume(size);
          const Fit fit{flush ? narrowest : unused, flush ? unused : narrowest, f, l, t};
          if (!best || fit < *best) best = fit;
        }
      }
    }
    if (!best) return false;
    const auto& [first, second, f, l, t] = *best;
    Filling& filling = filled[f];
    const Filling::Part part = filling.left[l];
    const BoxSize size = turned(pieces_[piece], kTurns[t]);
    filling.left.erase(filling.left.begin() + static_cast<std::ptrdiff_t>(l));
    for (SawCut& cut : best_split(part.box, size, saw_mm_)) {
      cut.part = part.number;
      if (cut.leaves()) filling.left.push_back({filling.parts++, cut.off});
      filling.block.cuts.push_back(cut);
    }
    filling.block.pieces.push_back({piece, part.number, {part.box.at, size}});
    return true;
  }

  // Its pieces in smaller stock, where that holds them in the same order.
  void shrink(Filling& filling, bool flush) const {
    for (const BoxSize& size : sizes_) {
      if (!(volume(size) < volume(filling.block.size))) continue;
      std::vector<Filling> other{Filling(size)};
      const bool all = std::all_of(filling.block.pieces.begin(), filling.block.pieces.end(),
                                   [&](const NestedPiece& p) { return place(other, p.piece, flush); });
      if (all) filling = std::move(other.front());
    }
  }

  std::span<const BoxSize> pieces_;
  std::span<const BoxSize> sizes_;
  double saw_mm_;
  const std::function<void()>& watch_;
};

// Orders to fill stock in: by volume, longest edge and base, the largest first; then these with neighbours
// exchanged at random.
std::vector<std::vector<std::size_t>> orders(std::span<const BoxSize> pieces, std::size_t ways) {
  const auto by = [&](auto key) {
    std::vector<std::size_t> order(pieces.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return key(sorted(pieces[a])) > key(sorted(pieces[b]));
    });
    return order;
  };
  std::vector<std::vector<std::size_t>> all{
      by([](const BoxSize& s) { return std::tuple(volume(s), s[0], s[1]); }),
      by([](const BoxSize& s) { return std::tuple(s[0], s[1], s[2]); }),
      by([](const BoxSize& s) { return std::tuple(s[0] * s[1], s[2], s[0]); })};
  // Some hundred for a few pieces, fewer for many: a roof's are packed within some seconds.
  constexpr std::size_t kWork = 48000, kMost = 120;
  const std::size_t more = std::min(kMost, kWork / std::max<std::size_t>(1, pieces.size() * ways));
  // Its numbers are the same everywhere, those of the library's distributions are not.
  std::mt19937_64 random(1);
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  for (std::size_t i = 0; i < more && pieces.size() > 1; ++i) {
    std::vector<std::size_t> order = all[i % 3];
    const std::size_t swaps = 1 + below(pieces.size());
    for (std::size_t k = 0; k < swaps; ++k) {
      const std::size_t at = below(pieces.size()), reach = 1 + below(4);
      std::swap(order[at], order[std::min(order.size() - 1, at + reach)]);
    }
    all.push_back(std::move(order));
  }
  return all;
}

void check(std::span<const BoxSize> boxes) {
  for (const BoxSize& box : boxes) {
    for (const double edge : box) {
      if (!(edge > 0) || !std::isfinite(edge)) throw std::logic_error("edges must be positive");
    }
  }
}

}  // namespace

std::string part_name(std::size_t part) {
  constexpr std::size_t kLetters = 26;
  std::string name(1, static_cast<char>('A' + part % kLetters));
  return part < kLetters ? name : part_name(part / kLetters - 1) + name;
}

bool holds(const BoxSize& size, const BoxSize& piece) {
  return fits(sorted(piece), sorted(size));
}

Nesting nest(std::span<const BoxSize> pieces, std::span<const BoxSize> sizes, double saw_mm,
             const std::function<void()>& watch) {
  check(pieces);
  check(sizes);
  if (!(saw_mm >= 0) || !std::isfinite(saw_mm)) throw std::logic_error("a saw takes no less than nothing");
  // The longest edge first, so that neither the order nor the turn of the sizes matters.
  std::vector<BoxSize> sold;
  for (const BoxSize& size : sizes) sold.push_back(sorted(size));
  std::sort(sold.begin(), sold.end());
  sold.erase(std::unique(sold.begin(), sold.end()), sold.end());
  const Packer packer(pieces, sold, saw_mm, watch);
  Nesting best;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    best.pieces_mm3 += volume(pieces[i]);
    best.apart_mm3 += volume(packer.smallest_for(i));
  }
  best.bought_mm3 = std::numeric_limits<double>::infinity();
  const std::size_t ways = 2 * (sold.size() + 1);  // to fill stock in one order
  for (const std::vector<std::size_t>& order : orders(pieces, ways)) {
    for (std::size_t way = 0; way < ways; ++way) {
      const std::vector<Filling> filled = packer.pack(order, way / 2, way % 2 == 1);
      double bought = 0;
      for (const Filling& filling : filled) bought += volume(filling.block.size);
      const bool as_much = bought <= best.bought_mm3 * (1 + 1e-12);
      const bool better =
          bought < best.bought_mm3 * (1 - 1e-12) || (as_much && filled.size() < best.blocks.size());
      if (!better) continue;
      best.bought_mm3 = bought;
      best.blocks.clear();
      for (const Filling& filling : filled) best.blocks.push_back(filling.block);
    }
  }
  if (pieces.empty()) best.bought_mm3 = 0;
  return best;
}

}  // namespace hotblade::pipeline

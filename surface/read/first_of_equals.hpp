// Finds equal items of a long list without sorting it.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "surface/read/blocks.hpp"

namespace hotblade::surface {

// Returns the hash with 64 bits stirred in; every bit of both reaches the low bits of the result.
[[nodiscard]] constexpr std::uint64_t stir(std::uint64_t hash, std::uint64_t bits) {
  hash = (hash ^ bits) * 0x9e3779b97f4a7c15ULL;  // 2^64 over the golden ratio, after Knuth
  return hash ^ hash >> 32;
}

// Returns for each of `count` items the first one equal to it, by `hash(i)` and `equal(i, j)`. Items are
// dealt out by the hash's high bits to parts, whose tables are small enough to stay close to a core; the
// parts are looked through side by side.
template <class Hash, class Equal>
[[nodiscard]] std::vector<int> first_of_equals(std::size_t count, const Hash& hash, const Equal& equal) {
  struct Item {
    std::uint32_t hash;  // its low half
    int number;
  };
  constexpr std::size_t kPart = std::size_t{1} << 15;  // items of a part, about
  constexpr int kMostBits = 12;
  const int bits = std::min(kMostBits, static_cast<int>(std::bit_width(count / kPart)));
  const std::size_t parts = std::size_t{1} << bits, blocks = (count + kBlock - 1) / kBlock;
  const auto part_of = [&](std::uint64_t h) { return bits == 0 ? 0 : h >> (64 - bits); };
  // Places of the items of a block and a part, in the order of parts, then of blocks.
  std::vector<std::size_t> place(parts * blocks + 1, 0);
  for_blocks(count, kBlock, [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) ++place[part_of(hash(i)) * blocks + from / kBlock];
  });
  for (std::size_t k = 0, sum = 0; k < place.size(); ++k) sum += std::exchange(place[k], sum);
  std::vector<Item> items(count);
  for_blocks(count, kBlock, [&](std::size_t from, std::size_t to) {
    std::vector<std::size_t> next(parts);
    for (std::size_t part = 0; part < parts; ++part) next[part] = place[part * blocks + from / kBlock];
    for (std::size_t i = from; i < to; ++i) {
      const std::uint64_t h = hash(i);
      items[next[part_of(h)]++] = {static_cast<std::uint32_t>(h), static_cast<int>(i)};
    }
  });
  std::vector<int> first(count);
  for_blocks(parts, 1, [&](std::size_t part, std::size_t) {
    constexpr Item kEmpty{0, -1};
    const auto own = std::span<const Item>(items).subspan(place[part * blocks],
                                                          place[(part + 1) * blocks] - place[part * blocks]);
    std::vector<Item> slots(std::bit_ceil(2 * own.size() + 1), kEmpty);
    const std::size_t mask = slots.size() - 1;
    for (const Item& item : own) {
      std::size_t slot = item.hash & mask;
      while (slots[slot].number >= 0 &&
             (slots[slot].hash != item.hash ||
              !equal(static_cast<std::size_t>(slots[slot].number), static_cast<std::size_t>(item.number))))
        slot = (slot + 1) & mask;
      if (slots[slot].number < 0) slots[slot] = item;
      first[static_cast<std::size_t>(item.number)] = slots[slot].number;
    }
  });
  return first;
}

}  // namespace hotblade::surface

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

// An item by its number, with the low half of its hash.
struct HashedItem {
  std::uint32_t hash;
  int number;
};

// Writes to `first` the first one equal to it of these items, for each of them.
template <class Equal>
void enter_firsts(std::span<const HashedItem> items, const Equal& equal, std::vector<int>& first) {
  constexpr HashedItem kEmpty{0, -1};
  std::vector<HashedItem> slots(std::bit_ceil(2 * items.size() + 1), kEmpty);
  const std::size_t mask = slots.size() - 1;
  for (const HashedItem& item : items) {
    std::size_t slot = item.hash & mask;
    while (slots[slot].number >= 0 &&
           (slots[slot].hash != item.hash ||
            !equal(static_cast<std::size_t>(slots[slot].number), static_cast<std::size_t>(item.number))))
      slot = (slot + 1) & mask;
    if (slots[slot].number < 0) slots[slot] = item;
    first[static_cast<std::size_t>(item.number)] = slots[slot].number;
  }
}

// Where items that are equal mostly stand: those of neighbours in a mesh are near each other in its file, and
// the check of an STL of 10 million facets takes a tenth less time when they are joined so.
enum class Equals { kRare, kNear };

// Returns for each of `count` items the first one equal to it, by `hash(i)` and `equal(i, j)`. Near ones are
// found in blocks, whose items stay close to a core; what is left, the first ones of a block, is dealt out by
// the hash's high bits to parts, whose tables are as small. Blocks and parts are looked through side by side.
template <class Hash, class Equal>
[[nodiscard]] std::vector<int> first_of_equals(std::size_t count, const Hash& hash, const Equal& equal,
                                               Equals where) {
  std::vector<int> first(count);
  for_blocks(count, kBlock, [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) first[i] = static_cast<int>(i);
    if (where == Equals::kRare) return;
    std::vector<HashedItem> own;
    own.reserve(to - from);
    for (std::size_t i = from; i < to; ++i)
      own.push_back({static_cast<std::uint32_t>(hash(i)), static_cast<int>(i)});
    enter_firsts(own, equal, first);
  });
  constexpr std::size_t kPart = std::size_t{1} << 15;  // items of a part, about
  constexpr int kMostBits = 12;
  const int bits = std::min(kMostBits, static_cast<int>(std::bit_width(count / kPart)));
  const std::size_t parts = std::size_t{1} << bits, blocks = (count + kBlock - 1) / kBlock;
  const auto part_of = [&](std::uint64_t h) { return bits == 0 ? 0 : h >> (64 - bits); };
  const auto left = [&](std::size_t i) { return first[i] == static_cast<int>(i); };
  // Places of the items of a block and a part, in the order of parts, then of blocks.
  std::vector<std::size_t> place(parts * blocks + 1, 0);
  for_blocks(count, kBlock, [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i)
      if (left(i)) ++place[part_of(hash(i)) * blocks + from / kBlock];
  });
  for (std::size_t k = 0, sum = 0; k < place.size(); ++k) sum += std::exchange(place[k], sum);
  std::vector<HashedItem> items(place.back());
  for_blocks(count, kBlock, [&](std::size_t from, std::size_t to) {
    std::vector<std::size_t> next(parts);
    for (std::size_t part = 0; part < parts; ++part) next[part] = place[part * blocks + from / kBlock];
    for (std::size_t i = from; i < to; ++i) {
      if (!left(i)) continue;
      const std::uint64_t h = hash(i);
      items[next[part_of(h)]++] = {static_cast<std::uint32_t>(h), static_cast<int>(i)};
    }
  });
  for_blocks(parts, 1, [&](std::size_t part, std::size_t) {
    const std::size_t from = place[part * blocks], to = place[(part + 1) * blocks];
    enter_firsts(std::span<const HashedItem>(items).subspan(from, to - from), equal, first);
  });
  if (where == Equals::kRare) return first;
  // The first of a block is itself or of a block before, whose first is final.
  std::vector<int> last(count);
  for_blocks(count, kBlock, [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) last[i] = first[static_cast<std::size_t>(first[i])];
  });
  return last;
}

}  // namespace hotblade::surface

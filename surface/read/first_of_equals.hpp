// Finds equal items of a long list without sorting it.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace hotblade::surface {

// Returns the hash with 64 bits stirred in; every bit of both reaches the low bits of the result.
[[nodiscard]] constexpr std::uint64_t stir(std::uint64_t hash, std::uint64_t bits) {
  hash = (hash ^ bits) * 0x9e3779b97f4a7c15ULL;  // 2^64 over the golden ratio, after Knuth
  return hash ^ hash >> 32;
}

// Returns for each of `count` items the first one equal to it, by `hash(i)` and `equal(i, j)`. It fills one
// table and allocates nothing an item.
template <class Hash, class Equal>
[[nodiscard]] std::vector<int> first_of_equals(std::size_t count, const Hash& hash, const Equal& equal) {
  constexpr int kEmpty = -1;
  std::vector<int> slots(std::bit_ceil(2 * count + 1), kEmpty);
  const std::uint64_t mask = slots.size() - 1;
  std::vector<int> first(count);
  for (std::size_t i = 0; i < count; ++i) {
    std::uint64_t slot = hash(i) & mask;
    while (slots[slot] != kEmpty && !equal(static_cast<std::size_t>(slots[slot]), i))
      slot = (slot + 1) & mask;
    if (slots[slot] == kEmpty) slots[slot] = static_cast<int>(i);
    first[i] = slots[slot];
  }
  return first;
}

}  // namespace hotblade::surface

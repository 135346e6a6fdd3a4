// Numbers of binary files.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <string_view>

namespace hotblade::surface {

// Returns the number whose bytes stand at `at`, of which all have to be there.
template <class Number>
[[nodiscard]] Number number_at(std::string_view bytes, std::size_t at,
                               std::endian order = std::endian::little) {
  std::array<char, sizeof(Number)> raw{};
  std::memcpy(raw.data(), bytes.data() + at, raw.size());
  if (order != std::endian::native) std::reverse(raw.begin(), raw.end());
  return std::bit_cast<Number>(raw);
}

}  // namespace hotblade::surface

// The distance of two words, for "did you mean".
#pragma once

#include <cstddef>
#include <string_view>

namespace hotblade::pipeline {

// The least number of letters to add, leave out or change that makes one word of the other (Levenshtein
// 1966).
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

}  // namespace hotblade::pipeline

// How far apart two words are, for "did you mean".
#pragma once

#include <cstddef>
#include <string_view>

namespace hotblade::pipeline {

// Least number of letters to add, leave out or change (Levenshtein 1966).
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

}  // namespace hotblade::pipeline

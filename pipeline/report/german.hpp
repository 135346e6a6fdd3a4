// German for what limits, plans, cells and designs are told by: pairs of English and German.
#pragma once

#include <span>
#include <string_view>
#include <utility>

namespace hotblade::pipeline {

// Returns names, units and meanings of limits, and words that stand in sentences.
[[nodiscard]] std::span<const std::pair<std::string_view, std::string_view>> german_words_of_limits();

// Returns sentences, with the same places for values in the same order (pipeline/sayings/saying.hpp,
// surface/read/warning.hpp).
[[nodiscard]] std::span<const std::pair<std::string_view, std::string_view>> german_sentences();

}  // namespace hotblade::pipeline

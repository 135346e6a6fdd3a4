// Text that was taken from a good file and broken, for readers that have to say so.
#pragma once

#include <cstddef>
#include <random>
#include <span>
#include <string>

namespace hotblade::testing {

// One to six changes: a byte, a token, a cut, a doubled stretch.
inline std::string broken(std::string text, std::span<const char* const> tokens, std::mt19937_64& random) {
  const auto below = [&random](std::size_t n) { return n > 0 ? random() % n : 0; };
  const std::size_t changes = 1 + below(6);
  for (std::size_t i = 0; i < changes; ++i) {
    const std::size_t at = below(text.size());
    switch (below(4)) {
      case 0:
        if (!text.empty()) text[at] = static_cast<char>(random());
        break;
      case 1:
        text.insert(at, tokens[below(tokens.size())]);
        break;
      case 2:
        text.erase(at, 1 + below(40));
        break;
      default:
        text.insert(at, text.substr(at, 1 + below(60)));
    }
  }
  return text;
}

}  // namespace hotblade::testing

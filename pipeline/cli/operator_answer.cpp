#include "pipeline/cli/operator_answer.hpp"

#include <algorithm>
#include <cctype>

namespace hotblade::pipeline {

namespace {

bool same_letters(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [&](char x, char y) { return lower(x) == lower(y); });
}

}  // namespace

bool agrees_to_start(std::string_view answer, std::string_view strip_id) {
  constexpr std::string_view kBlanks = " \t\r";
  const std::size_t first = answer.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return false;
  const std::string_view word = answer.substr(first, answer.find_last_not_of(kBlanks) - first + 1);
  return same_letters(word, "yes") || same_letters(word, strip_id);
}

}  // namespace hotblade::pipeline

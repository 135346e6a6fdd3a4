// Every settings key in one table: where it lives, its type, range and meaning. Reading, checking, writing
// and documenting settings all walk this table, so that they cannot disagree.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "pipeline/settings/settings.hpp"

namespace hotblade::pipeline {

// A place inside a Settings value.
using SettingPlace =
    std::variant<double*, int*, std::string*, Keep*, Gaps*, ShallowFolds*, OverBudget*, std::vector<double>*,
                 std::vector<std::array<double, 2>>*, std::vector<std::array<double, 3>>*,
                 std::array<double, 3>*, std::optional<std::array<double, 3>>*,
                 std::optional<std::array<double, 6>>*>;

// The choices of a string that may be any text.
inline constexpr std::string_view kAnyText = "*";

// The words of each enum, in its order.
inline constexpr std::string_view kKeepWords = "below|above|back|front", kGapsWords = "bridge|apart",
                                  kShallowFoldsWords = "auto|crossed|parted",
                                  kOverBudgetWords = "warn|refuse";

struct SettingField {
  std::string_view section, key, unit;
  double min = 0, max = 0;   // of a number, or of every number of a list; both included
  std::string_view choices;  // of a string or an enum: the words allowed, separated by '|'; an empty word
                             // means unset; kAnyText: any
  std::string_view description;
  SettingPlace (*place)(Settings&);
  bool off_at_zero = false;  // 0, or an empty list, leaves out what it is about, and programs and reports
                             // leave it out then
};

// The table, in the order of docs/configuration.md.
[[nodiscard]] std::span<const SettingField> setting_fields();

// "section.key".
[[nodiscard]] std::string full_key(const SettingField& field);

// The words of field.choices, one by one.
[[nodiscard]] std::vector<std::string> choices(const SettingField& field);

// Sets an enum to the value that a word of field.choices names; returns whether there is one.
template <typename Enum>
[[nodiscard]] bool choose(const SettingField& field, std::string_view word, Enum& value) {
  const std::vector<std::string> words = choices(field);
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] != word) continue;
    value = static_cast<Enum>(i);
    return true;
  }
  return false;
}

// The shortest text that reads back to the same number.
[[nodiscard]] std::string number_text(double value);

// Returns a text as a basic string of TOML, quoted: a JSON string with its escapes is one, but for DEL, which
// TOML has escaped only.
[[nodiscard]] std::string toml_string(const std::string& text);

// The value as TOML; absent for an optional that is absent.
[[nodiscard]] std::optional<std::string> toml_text(const SettingPlace& place);

// The values that are accepted, in words: "0.1 to 100", "3 numbers, each 10 to 10000", "z or y".
[[nodiscard]] std::string range_text(const SettingField& field);

}  // namespace hotblade::pipeline

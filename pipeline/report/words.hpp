// The words of report.html and sheets.html in the language of job.language: a table from the English ones.
#pragma once

#include <fmt/format.h>

#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace hotblade::pipeline {

class Words {
 public:
  // Takes "en" or "de".
  explicit Words(std::string_view language);

  // Returns the words that stand for these English ones. Throws std::logic_error where the language's table
  // has none: a test renders every page in every language.
  [[nodiscard]] std::string operator()(std::string_view english) const;

  // Returns the same of what a plan, a cell or a design was told, whatever values stand in it: a limit's name
  // or a sentence (pipeline/sayings/saying.hpp), found by what stands between its values, which are looked up
  // likewise. Names from outside, values in quotes, and what no table has, stay as they are.
  [[nodiscard]] std::string said(std::string_view english) const;

  // Returns the words with values in their places, as fmt::format puts them there.
  template <typename... Values>
  [[nodiscard]] std::string format(std::string_view english, const Values&... values) const {
    return fmt::format(fmt::runtime((*this)(english)), values...);
  }

  // Returns the language's code.
  [[nodiscard]] const std::string& language() const { return language_; }

  // Returns all pairs of the language's table, English first; none for English.
  [[nodiscard]] std::span<const std::pair<std::string_view, std::string_view>> table() const;

 private:
  std::string language_;
};

}  // namespace hotblade::pipeline

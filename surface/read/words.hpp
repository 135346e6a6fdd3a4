// Words and numbers of text from outside.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace hotblade::surface {

// Returns a token as messages show it: unprintable bytes as '?', and cut where it is long, so that a message
// stays one readable line.
[[nodiscard]] std::string shown_token(std::string_view token);

// Returns the words with a blank between two.
[[nodiscard]] std::string joined_words(std::span<const std::string> words);

// Returns the number with the noun that goes with it.
[[nodiscard]] std::string counted(std::size_t n, const std::string& one, const std::string& many);

// Returns the number that a word is, with a sign + taken too; one too large is infinite, one too small 0.
// Absent for a word that is no number.
[[nodiscard]] std::optional<double> number_in(std::string_view word);

// Reads a number of at most 15 digits without an exponent, as nearly all are, and returns where it ends;
// `from` for any other. Digits and the power of ten that they are divided by are exact, so the quotient is
// the nearest number, as std::from_chars finds it (Clinger 1990), in a third of the time.
[[nodiscard]] const char* plain_number(const char* from, const char* end, double& value);

[[nodiscard]] constexpr bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}
[[nodiscard]] constexpr bool is_line_end(char c) {
  return c == '\n' || c == '\r';
}

// Walks text word by word and counts its lines; LF, CR LF and a lone CR end one.
class Words {
 public:
  explicit Words(std::string_view text, std::size_t lines_before = 0)
      : text_(text), line_(lines_before + 1), word_line_(line_) {}

  // Returns the next word, on whatever line it is; empty at the end of the text.
  std::string_view next();
  // Returns the next word of the line that the walk is on; empty at its end, which stays ahead.
  std::string_view next_in_line();
  // Returns what is left of the line, without blanks at its ends, and goes beyond its end.
  std::string_view rest_of_line();

  // The line of the last word, from 1, or, where the text has ended, the last line.
  [[nodiscard]] std::size_t line() const { return word_line_; }
  // The place in the text that the walk has come to.
  [[nodiscard]] std::size_t offset() const { return at_; }

 private:
  void skip_blanks();
  void pass_line_end();

  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t line_, word_line_;
};

}  // namespace hotblade::surface

#include "surface/read/words.hpp"

#include <array>
#include <charconv>
#include <cstdint>
#include <cstdlib>

namespace hotblade::surface {

std::string shown_token(std::string_view token) {
  constexpr std::size_t kLongest = 40;
  std::string out(token.substr(0, kLongest));
  for (char& c : out) {
    if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) >= 0x7f) c = '?';
  }
  return token.size() > kLongest ? out + "..." : out;
}

std::string joined_words(std::span<const std::string> words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

std::string counted(std::size_t n, const std::string& one, const std::string& many) {
  return std::to_string(n) + " " + (n == 1 ? one : many);
}

const char* plain_number(const char* from, const char* end, double& value) {
  constexpr std::size_t kMostDigits = 15;  // of 2^53 all: a whole number of so many is not rounded
  constexpr std::array<double, kMostDigits + 1> kTens{1,   1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                      1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};
  const char* at = from;
  const bool negative = at != end && *at == '-';
  if (negative) ++at;
  std::uint64_t whole = 0;
  std::size_t digits = 0, behind = 0, point = 0;
  for (; at != end; ++at) {
    const auto digit = static_cast<unsigned>(static_cast<unsigned char>(*at)) - '0';
    if (digit <= 9) {
      if (++digits > kMostDigits) return from;
      whole = 10 * whole + digit;
      behind += point;
    } else if (*at == '.' && point == 0) {
      point = 1;
    } else {
      break;
    }
  }
  if (digits == 0) return from;
  const double size = static_cast<double>(static_cast<std::int64_t>(whole)) / kTens[behind];
  value = negative ? -size : size;
  return at;
}

std::optional<double> number_in(std::string_view word) {
  std::string_view digits = word;
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  double value = 0;
  if (plain_number(digits.data(), digits.data() + digits.size(), value) == digits.data() + digits.size() &&
      !digits.empty())
    return value;
  const auto [rest, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  // Out of range is said for numbers too small as well; those are zero for every purpose here.
  if (error == std::errc::result_out_of_range) value = std::strtod(std::string(digits).c_str(), nullptr);
  if (error == std::errc::invalid_argument || rest != digits.data() + digits.size()) return std::nullopt;
  return value;
}

void Words::skip_blanks() {
  while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
}

void Words::pass_line_end() {
  at_ += text_.substr(at_, 2) == "\r\n" ? 2 : 1;
  ++line_;
}

std::string_view Words::next_in_line() {
  skip_blanks();
  const std::size_t begin = at_;
  while (at_ < text_.size() && !is_blank(text_[at_]) && !is_line_end(text_[at_])) ++at_;
  if (at_ > begin) word_line_ = line_;
  return text_.substr(begin, at_ - begin);
}

std::string_view Words::next() {
  for (;;) {
    if (const std::string_view word = next_in_line(); !word.empty()) return word;
    if (at_ == text_.size()) return {};
    pass_line_end();
  }
}

std::string_view Words::rest_of_line() {
  skip_blanks();
  const std::size_t begin = at_;
  while (at_ < text_.size() && !is_line_end(text_[at_])) ++at_;
  std::string_view rest = text_.substr(begin, at_ - begin);
  while (!rest.empty() && is_blank(rest.back())) rest.remove_suffix(1);
  word_line_ = line_;
  if (at_ < text_.size()) pass_line_end();
  return rest;
}

}  // namespace hotblade::surface

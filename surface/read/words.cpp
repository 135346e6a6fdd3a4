#include "surface/read/words.hpp"

#include <charconv>
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

std::optional<double> number_in(std::string_view word) {
  std::string_view digits = word;
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  double value = 0;
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

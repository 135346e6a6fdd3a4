#include "pipeline/program/number_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace hotblade::pipeline {
namespace {

// A number of so many decimals is an integer over `scale`.
struct Decimals {
  std::size_t count;
  double scale;
};

// From to_chars' exponents below 1e-3 up to no more than 15 digits, so that two numbers never share a double.
constexpr double kSmallest = 1e-3, kFine = 1e3, kLargest = 1e7;
constexpr Decimals kFew{8, 1e8}, kMany{12, 1e12};

char* write_any(char* to, double value) {
  return std::to_chars(to, to + kNumberText, value).ptr;
}

}  // namespace

char* write_number(char* to, double value) {
  const double size = std::abs(value);
  if (!(size >= kSmallest && size < kLargest)) return write_any(to, value);
  const Decimals decimals = size < kFine ? kMany : kFew;
  const auto count = static_cast<std::uint64_t>(std::llrint(size * decimals.scale));
  // Both are integers that a double holds: their quotient is the double nearest to the decimal number. As
  // doubles tell all numbers of 15 digits apart, no shorter text reads back as this one.
  if (static_cast<double>(count) / decimals.scale != size) return write_any(to, value);
  if (size >= 1e5 && size == std::floor(size)) return write_any(to, value);  // to_chars writes 1e+05
  const fmt::format_int digits(count);
  const std::size_t whole = std::max(digits.size(), decimals.count) - decimals.count;
  if (value < 0) *to++ = '-';
  if (whole == 0) *to++ = '0';
  to = std::copy_n(digits.data(), whole, to);
  *to++ = '.';
  to = std::fill_n(to, decimals.count - (digits.size() - whole), '0');
  to = std::copy_n(digits.data() + whole, digits.size() - whole, to);
  while (to[-1] == '0') --to;
  return to[-1] == '.' ? to - 1 : to;
}

char* write_number(char* to, float value) {
  // No two decimals of six digits share a float: where one reads back as this float no shorter text does.
  constexpr std::array kTens{1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8};
  const double size = std::abs(value);
  if (!(size >= kSmallest && size < kTens[6])) return std::to_chars(to, to + kNumberText, value).ptr;
  std::size_t decimals = kTens.size() - 1;
  while (size * kTens[decimals] >= kTens[6]) --decimals;
  const double six = std::nearbyint(size * kTens[decimals]) / kTens[decimals];
  if (static_cast<float>(six) != std::abs(value)) return std::to_chars(to, to + kNumberText, value).ptr;
  return write_number(to, std::copysign(six, static_cast<double>(value)));
}

}  // namespace hotblade::pipeline

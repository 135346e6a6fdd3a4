#include "pipeline/verify/refusal.hpp"

#include <fmt/format.h>

#include <cmath>

namespace hotblade::pipeline {

std::string rib_id(const std::string& strip, std::size_t index) {
  return fmt::format("{}R{:03}", strip, index + 1);
}

std::string limit_text(const Refusal& r) {
  return info(r.limit).name + r.when;
}

std::string unit(const Refusal& r) {
  return info(r.limit).unit;
}

std::string note(const Refusal& r) {
  return r.note.empty() ? info(r.limit).meaning : r.note;
}

AmountText amount_text(const Refusal& r) {
  constexpr double kRounding = 1e-9;  // of any limit's unit: a zero that was computed
  constexpr int kFewestDigits = 4, kMostDigits = 15;
  const double value = std::abs(r.value) < kRounding ? 0 : r.value;
  for (int digits = kFewestDigits;; ++digits) {
    AmountText text{fmt::format("{:.{}g}", value, digits), fmt::format("{:.{}g}", r.bound, digits)};
    if (text.value != text.bound || value == r.bound || digits == kMostDigits) return text;
  }
}

std::string describe_amount(const Refusal& r) {
  const std::string in_unit = unit(r).empty() ? "" : " " + unit(r);
  const AmountText amount = amount_text(r);
  return fmt::format("{} {}{}{} (limit {}{}){}", info(r.limit).name, r.capped ? ">= " : "", amount.value,
                     in_unit, amount.bound, in_unit, r.when);
}

std::string describe(const Refusal& r) {
  const std::string place = r.place.empty() ? "" : " " + r.place;
  const std::string said = note(r);
  return fmt::format("{}{}: {}{}", r.rib.empty() ? r.strip : r.rib, place, describe_amount(r),
                     said.empty() ? "" : ": " + said);
}

}  // namespace hotblade::pipeline

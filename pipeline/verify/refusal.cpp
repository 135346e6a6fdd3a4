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

double shown_value(const Refusal& r) {
  constexpr double kRounding = 1e-9;  // of any limit's unit: a zero that was computed
  return std::abs(r.value) < kRounding ? 0 : r.value;
}

std::string describe_amount(const Refusal& r) {
  const std::string in_unit = unit(r).empty() ? "" : " " + unit(r);
  return fmt::format("{} {}{:.4g}{} (limit {:.4g}{}){}", info(r.limit).name, r.capped ? ">= " : "",
                     shown_value(r), in_unit, r.bound, in_unit, r.when);
}

std::string describe(const Refusal& r) {
  const std::string place = r.place.empty() ? "" : " " + r.place;
  const std::string said = note(r);
  return fmt::format("{}{}: {}{}", r.rib.empty() ? r.strip : r.rib, place, describe_amount(r),
                     said.empty() ? "" : ": " + said);
}

}  // namespace hotblade::pipeline

#include "pipeline/verify/refusal.hpp"

#include <fmt/format.h>

namespace hotblade::pipeline {

std::string rib_id(const std::string& strip, std::size_t index) {
  return fmt::format("{}R{:03}", strip, index + 1);
}

std::string describe_amount(const Refusal& r) {
  const std::string unit = r.unit.empty() ? "" : " " + r.unit;
  return fmt::format("{} {:.4g}{} (limit {:.4g}{})", r.limit, r.value, unit, r.bound, unit);
}

std::string describe(const Refusal& r) {
  const std::string place = r.place.empty() ? "" : " " + r.place;
  return fmt::format("{}{}: {}: {}", r.rib.empty() ? r.strip : r.rib, place, describe_amount(r), r.hint);
}

}  // namespace hotblade::pipeline

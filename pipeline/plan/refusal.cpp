#include "pipeline/plan/refusal.hpp"

#include <fmt/format.h>

namespace hotblade::pipeline {

std::string rib_id(const std::string& strip, std::size_t index) {
  return fmt::format("{}R{:03}", strip, index + 1);
}

std::string describe(const Refusal& r) {
  const std::string place = r.rib.empty() ? r.strip : r.rib;
  return fmt::format("{}: {} {:.4g} {} (limit {:.4g} {}): {}", place, r.limit, r.value, r.unit, r.bound,
                     r.unit, r.hint);
}

}  // namespace hotblade::pipeline

#include "pipeline/plan/refusal.hpp"

#include <fmt/format.h>

namespace hotblade::pipeline {

std::string describe(const Refusal& r) {
  const std::string place = r.rib.empty() ? r.strip : r.rib;
  return fmt::format("{}: {} {:.4g} {} (limit {:.4g} {}): {}", place, r.limit, r.value, r.unit, r.bound,
                     r.unit, r.hint);
}

}  // namespace hotblade::pipeline

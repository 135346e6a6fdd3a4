// Why a strip cannot be cut as asked: one line a limit, by name and amount.
#pragma once

#include <string>
#include <vector>

namespace hotblade::pipeline {

struct Refusal {
  std::string strip;  // S003, or a place in the design when no strip exists yet
  std::string rib;    // S003R012, or empty when the whole strip is meant
  std::string limit;  // what was exceeded: deviation, radius, margin, clearance, ...
  double value = 0;   // measured
  double bound = 0;   // allowed
  std::string unit;
  std::string hint;     // what would make it cuttable
  std::string place{};  // in words where it helps: `at (x, y, z)` in the design frame
  // The same for each candidate that was tried, one line each: which limit stopped which blade length.
  std::vector<std::string> details{};
};

// S003R012: rib `index` (from 0) of a strip.
[[nodiscard]] std::string rib_id(const std::string& strip, std::size_t index);

// `S003R012 at (1.0, 2.0, 3.0): radius 55.2 mm (limit 70.5 mm): hint`
[[nodiscard]] std::string describe(const Refusal& refusal);

// `radius 55.2 mm (limit 70.5 mm)`.
[[nodiscard]] std::string describe_amount(const Refusal& refusal);

}  // namespace hotblade::pipeline

// Why a strip cannot be cut as asked: one line a limit, by name and amount.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "robot/pose/limit.hpp"

namespace hotblade::pipeline {

using robot::Limit;

struct Refusal {
  std::string strip;  // S003, or a place in the design when no strip exists yet
  std::string rib;    // S003R012, or empty when the whole strip is meant
  Limit limit = Limit::kNone;
  double value = 0;     // measured, in the limit's unit
  double bound = 0;     // allowed
  std::string note{};   // what else is known of it here; empty: what the limit means
  std::string place{};  // in words where it helps: `at (x, y, z)` in the design frame
  std::string when{};   // phase and time, as they follow the amount: ` in phase cut at 12.00 s`
  // The same for each candidate that was tried, one line each: which limit stopped which blade length.
  std::vector<std::string> details{};
  bool capped = false;                  // the value is where the search ended: it is this much or more
  std::optional<Eigen::Vector3d> at{};  // the place in the design frame, where there is one
};

// Returns the name of rib `index` (from 0) of a strip, S003R012.
[[nodiscard]] std::string rib_id(const std::string& strip, std::size_t index);

// Return the refusal's limit by name, phase and time; its unit, empty where it has none; what is known of it
// beside its amount: the clamps that a budget asks for, the first warning, or what the limit means.
[[nodiscard]] std::string limit_text(const Refusal& refusal);
[[nodiscard]] std::string unit(const Refusal& refusal);
[[nodiscard]] std::string note(const Refusal& refusal);

// The measured value and what is allowed, in digits that tell them apart.
struct AmountText {
  std::string value, bound;
};
// Returns both in four digits, or as many as they first differ in; a zero that was computed is one.
[[nodiscard]] AmountText amount_text(const Refusal& refusal);

// Returns `S003R012 at (1.0, 2.0, 3.0): radius 55.2 mm (limit 70.5 mm): note`: the reason, and not what may
// help, which takes a trial (pipeline/advice/advice.hpp).
[[nodiscard]] std::string describe(const Refusal& refusal);

// Returns `radius 55.2 mm (limit 70.5 mm)`.
[[nodiscard]] std::string describe_amount(const Refusal& refusal);

}  // namespace hotblade::pipeline

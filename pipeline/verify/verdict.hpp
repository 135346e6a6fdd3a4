// The verdict on a plan in one colour: green, amber or red.
//
// The status of a program says whether every limit held in what was planned and measured. Clamps that err,
// weight and the mesh add to that; where the error budget with them is over the tolerance, a passed plan is
// amber, with the errors of the clamps that would bring it within.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

enum class VerdictColor { kGreen, kAmber, kRed };
[[nodiscard]] const char* name(VerdictColor color);

// How far each clamp may be off.
struct ClampErrors {
  double position_mm = 0, angle_rad = 0;
};

struct Verdict {
  VerdictColor color = VerdictColor::kRed;
  double tolerance_mm = 0;
  double budget_mm = 0;  // the sum of the error budget
  double clamp_mm = 0;   // of it, what the clamps' errors add
  ClampErrors planned;   // the clamps' errors that the budget was made with
  // Where the budget is over the tolerance: errors, rounded down to two digits and in the planned ones'
  // proportion, with which it is not; absent where exact clamps would not bring it within either.
  std::optional<ClampErrors> needed;

  // A sum that is no number is over.
  [[nodiscard]] bool over_budget() const { return !(budget_mm <= tolerance_mm); }
};

// Returns the verdict on a program, from its status, budget and poses alone.
[[nodiscard]] Verdict verdict_of(const Program& program);

// Returns the verdict as a headline: `can be cut within 1 mm if the clamps are within 0.021 mm and 0.042
// mrad`.
[[nodiscard]] std::string headline(const Verdict& verdict);

// Returns what would bring the budget within the tolerance: `within 1 mm if the clamps are within ...`, or
// that no clamps would.
[[nodiscard]] std::string needed_text(const Verdict& verdict);

// Returns how the budget compares with the tolerance, in a line, and what would bring it within.
[[nodiscard]] std::string budget_text(const Verdict& verdict);

// Returns the verdict as a JSON object: color, text, budget_mm, clamp_error_mm, planned and needed clamps.
[[nodiscard]] nlohmann::ordered_json to_json(const Verdict& verdict);

}  // namespace hotblade::pipeline

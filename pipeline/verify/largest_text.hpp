// The largest deviation in words.
#pragma once

#include <string>

#include "pipeline/verify/verify.hpp"

namespace hotblade::pipeline {

// Returns it as it is written: "2.959 mm", or ">= 2.959 mm" where it is capped.
[[nodiscard]] std::string largest_text(const VerifyReport& report);

// Returns it with the bound of all places: "2.959 mm (nowhere over 2.981 mm)"; a capped one has no bound.
[[nodiscard]] std::string largest_and_bound_text(const VerifyReport& report);

// Returns which limits a cut is measured to be over, each with its value: "" where it is within tolerance.
[[nodiscard]] std::string over_text(const VerifyReport& report, const VerifyOptions& options);

}  // namespace hotblade::pipeline

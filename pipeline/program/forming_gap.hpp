// Where a strip's blade would be pushed through foam that it does not melt.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

// Poses of a strip, from the first that forms the design to the last, that are cold or form nothing.
struct FormingGap {
  std::size_t first = 0, last = 0;  // indices into strip.poses
  bool cold = false;                // the first of them is; else its `foam` is null
};

// Returns the first of them; nothing where the blade is hot and forms the design all the way.
[[nodiscard]] std::optional<FormingGap> forming_gap(const Strip& strip);

// Returns it as a sentence: strip, what is wrong, for how many seconds, phase, time and pose.
[[nodiscard]] std::string describe(const Strip& strip, const FormingGap& gap);

}  // namespace hotblade::pipeline

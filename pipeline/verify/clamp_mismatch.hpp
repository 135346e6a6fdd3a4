// Whether the clamps of a program hold its blades where it says.
#pragma once

#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

// More is a program whose clamps and blade do not belong together; less is rounding.
inline constexpr double kClampMismatchMm = 1e-3;

// Returns the largest distance between a clamp and the blade's end it holds, mm, tangents a radian counted as
// 1000 mm.
[[nodiscard]] double clamp_mismatch_mm(const Program& program);

}  // namespace hotblade::pipeline

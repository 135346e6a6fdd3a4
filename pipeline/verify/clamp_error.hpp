// What the errors of the clamps move a blade by.
#pragma once

#include "pipeline/program/program.hpp"
#include "pipeline/settings/settings.hpp"

namespace hotblade::pipeline {

// Returns what both clamps err by at their worst, as margins count errors: of position, and of angle times
// half the blade's length.
[[nodiscard]] double worst_clamp_error_mm(const MachineSettings& machine, double blade_length_mm);

// Returns whether a blade is so close to straight, its clamps a few errors from pulling it taut, that an
// error along it moves it to second order only: neither its sensitivity nor its distance to a snap say
// anything there.
[[nodiscard]] bool nearly_straight(const BladePose& pose, const MachineSettings& machine);

// Returns what the clamps' errors move the blade by, mm: to first order, and as a straight strip where that
// says nothing. It may bow to its other side when the errors reach `straight_mm`.
[[nodiscard]] double clamp_error_mm(const BladePose& pose, double straight_mm,
                                    const MachineSettings& machine);

}  // namespace hotblade::pipeline

// What the errors of the clamps move a blade by.
#pragma once

#include <optional>

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

// What the clamps' errors, or a share of them, move one blade by. It may bow to its other side when the
// errors reach `straight_mm`.
class ClampResponse {
 public:
  // Keeps a reference to the pose.
  ClampResponse(const BladePose& pose, double straight_mm, const MachineSettings& machine)
      : pose_(&pose), straight_mm_(straight_mm), machine_(machine) {}

  // Returns what this share of the machine's errors moves the blade's part in foam (or all of it) by across
  // itself, mm: to first order, and as a straight strip where that says nothing. Not from two threads at
  // once.
  [[nodiscard]] double at(double share);

 private:
  const BladePose* pose_;
  double straight_mm_;
  MachineSettings machine_;
  std::optional<double> first_order_mm_;  // by the whole errors; found when first asked for
};

// Returns what the clamps' errors move the blade by, mm: a ClampResponse at its whole.
[[nodiscard]] double clamp_error_mm(const BladePose& pose, double straight_mm,
                                    const MachineSettings& machine);

}  // namespace hotblade::pipeline

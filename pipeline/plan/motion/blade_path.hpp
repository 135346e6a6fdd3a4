// A strip as a path of blade shapes: from the flat arc through every rib and back, before time is known.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "pipeline/plan/ribs/strip_plan.hpp"

namespace hotblade::pipeline {

// One shape of the blade at one place of the sweep.
struct BladeShape {
  double offset_mm = 0;         // plane along the sweep
  elastica::Elastica blade;     // in the strip's axes
  double foam0 = 0, foam1 = 0;  // arc lengths of the part that forms the design; equal when there is none
  bool in_foam = false;         // any part may touch the stock
  double rib0 = 0, rib1 = 0;    // of the rib: what forms the design and what lies in the waste beside it
};

// The same before the blade's start is known: a curve, and where on it the blade starts.
struct BladePlace {
  double offset_mm = 0;
  elastica::Elastica curve;
  double from_mm = 0, length_mm = 0;  // arc length on the curve, also before 0; of the blade
  double foam0 = 0, foam1 = 0;
  bool in_foam = false;
  double rib0 = 0, rib1 = 0;
};
// Returns the shapes at these places.
[[nodiscard]] std::vector<BladeShape> shapes_of(std::span<const BladePlace> places);

// A stretch of the path that starts and ends at rest; `place` takes [0, 1].
struct Stretch {
  StripPhase phase = StripPhase::kForm;
  bool heat = false;
  int samples = 0;  // that resolve it
  std::function<BladePlace(double)> place;
};
// Returns the shapes at these parameters, on all cores allowed; each depends on its own parameter alone.
[[nodiscard]] std::vector<BladeShape> shapes_at(const Stretch& stretch, std::span<const double> parameters);

// Heights along the sweep where the phases of the middle stretch meet.
struct SweepMarks {
  double start_mm = 0, first_rib_mm = 0, last_rib_mm = 0, end_mm = 0;
};

// The stretches of a strip, one after the other.
struct BladePath {
  std::vector<Stretch>
      stretches;  // form, approach, cutting (lead_in, cut, lead_out), retract, unform, travel
  SweepMarks marks;
};

// Returns the path of a strip, which it refers to: the strip has to outlive it.
[[nodiscard]] BladePath make_path(const StripPlan& strip, const Settings& settings);

}  // namespace hotblade::pipeline

// The blade's physical data: one record for settings, programs, planner and controller. mm, MPa, kg/m^3.
//
// Each layer adds what its readers need more, so that nobody has to make up a number it was not given: a
// controller is told section and length, and knows no weight.
#pragma once

#include <vector>

#include "robot/blade/melt.hpp"

namespace hotblade::robot {

// What bending in a plane depends on: a rectangular section, its width along the normal of that plane.
struct BladeSection {
  double width_mm = 0, thickness_mm = 0;
  double youngs_modulus_mpa = 0, yield_strength_mpa = 0;
  bool operator==(const BladeSection&) const = default;
};

// One blade between the clamps, as OPEN announces it (robot/wire/protocol.hpp converts it).
struct ClampedBlade : BladeSection {
  double length_mm = 0;  // free, from clamp to clamp
  bool operator==(const ClampedBlade&) const = default;
};

// What planning and measuring need besides: twist and sag, the accepted stress, the band that melts.
struct Blade : BladeSection {
  double poisson_ratio = 0;
  double safety = 1;  // bending stress stays below the yield strength divided by this
  double density_kg_m3 = 0;
  double kerf_mm = 0;  // melted band of a blade that moves square to its width, the thickness included
  Melt melt{};         // by its speed; where that says nothing, kerf_mm at every speed
  double stiffness_error = 0;  // it is stiffer by this share than section and modulus say
  // Returns the melted band in mm of a blade that moves so fast square to itself and to its width.
  [[nodiscard]] double band_mm(double speed_mm_s) const {
    return melt.by_speed() ? melt.band_mm(speed_mm_s) : kerf_mm;
  }
  bool operator==(const Blade&) const = default;
};

// The blades at hand: one section and material in several free lengths, ascending.
struct BladeSet : Blade {
  std::vector<double> free_lengths_mm;
  bool operator==(const BladeSet&) const = default;
};

}  // namespace hotblade::robot

// The blade as a job announces it to the controller: whole micrometres and megapascals, as registers hold it.
#pragma once

#include <cstdint>

namespace hotblade::robot {

struct AnnouncedBlade {
  std::uint32_t length_um = 0, width_um = 0, thickness_um = 0;
  std::uint32_t youngs_modulus_mpa = 0, yield_strength_mpa = 0;
  [[nodiscard]] double length_mm() const { return length_um / 1000.0; }
  bool operator==(const AnnouncedBlade&) const = default;
};

}  // namespace hotblade::robot

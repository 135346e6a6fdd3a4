// The band that a hot blade melts into foam, by its speed.
//
// Heat per length and time, q, melts band times speed of foam, rho (c dT + latent) a volume, and is lost into
// the foam beside the cut as if the band went on by a speed more: q = rho (c dT + latent) band (v + loss). So
//   band = melt / (v + loss),  melt = q / (rho (c dT + latent)),
// and 1 / band is linear in v. Measured bands are joined as that says: a table of two pairs is the model.
#pragma once

#include <array>
#include <vector>

namespace hotblade::robot {

struct Melt {
  // Pairs of mm/s and mm, of a blade that moves square to its width, its thickness included: speeds
  // ascending, bands not rising. Below the first speed its band holds, above the last one its band.
  std::vector<std::array<double, 2>> band_mm_at_mm_s;
  // The model's constants, where there are no pairs; melt 0: none.
  double melt_mm2_s = 0, loss_mm_s = 0;

  // Returns whether the band depends on the speed at all.
  [[nodiscard]] bool by_speed() const { return !band_mm_at_mm_s.empty() || melt_mm2_s > 0; }

  // Returns the band in mm at a speed in mm/s of at least 0, square to the blade. Throws std::logic_error
  // where the band does not depend on the speed.
  [[nodiscard]] double band_mm(double speed_mm_s) const;

  bool operator==(const Melt&) const = default;
};

}  // namespace hotblade::robot

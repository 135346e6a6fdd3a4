#include "robot/blade/melt.hpp"

#include <algorithm>
#include <cstddef>
#include <stdexcept>

namespace hotblade::robot {

double Melt::band_mm(double speed_mm_s) const {
  if (!by_speed()) throw std::logic_error("band_mm: the band does not depend on the speed");
  if (band_mm_at_mm_s.empty()) return melt_mm2_s / (speed_mm_s + loss_mm_s);
  const auto after = std::find_if(band_mm_at_mm_s.begin(), band_mm_at_mm_s.end(),
                                  [&](const std::array<double, 2>& pair) { return pair[0] > speed_mm_s; });
  if (after == band_mm_at_mm_s.begin()) return band_mm_at_mm_s.front()[1];
  if (after == band_mm_at_mm_s.end()) return band_mm_at_mm_s.back()[1];
  const auto& [v0, band0] = *(after - 1);
  const auto& [v1, band1] = *after;
  const double t = (speed_mm_s - v0) / (v1 - v0);
  return 1 / ((1 - t) / band0 + t / band1);
}

}  // namespace hotblade::robot

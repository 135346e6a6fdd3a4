#include "gpu/kernels/cubic_lanes.h"

namespace hotblade::gpu {

std::size_t nearest_on_cubic_baseline(const CubicChords& chords, const double* x, const double* y, double ox,
                                      double oy, std::size_t n, double* distance, double* t,
                                      unsigned* unsure) {
  return nearest_on_cubic(chords, x, y, ox, oy, n, distance, t, unsure);
}

}  // namespace hotblade::gpu

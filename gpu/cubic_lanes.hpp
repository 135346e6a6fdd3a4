// The fast half of the nearest point on a cubic, for the instruction set at hand.
#pragma once

#include <cstddef>

#include "gpu/kernels/cubic_nearest.h"

namespace hotblade::gpu {

// For n points (x, y) minus (ox, oy): distance and parameter of the nearest point; `unsure` gets the numbers
// of the points that the fast way does not settle, and their count is returned.
using NearestOnCubic = std::size_t (*)(const CubicChords&, const double* x, const double* y, double ox,
                                       double oy, std::size_t n, double* distance, double* t,
                                       unsigned* unsure);

[[nodiscard]] std::size_t nearest_on_cubic_baseline(const CubicChords&, const double* x, const double* y,
                                                    double ox, double oy, std::size_t n, double* distance,
                                                    double* t, unsigned* unsure);
[[nodiscard]] std::size_t nearest_on_cubic_avx2(const CubicChords&, const double* x, const double* y,
                                                double ox, double oy, std::size_t n, double* distance,
                                                double* t, unsigned* unsure);
[[nodiscard]] std::size_t nearest_on_cubic_avx512(const CubicChords&, const double* x, const double* y,
                                                  double ox, double oy, std::size_t n, double* distance,
                                                  double* t, unsigned* unsure);

}  // namespace hotblade::gpu

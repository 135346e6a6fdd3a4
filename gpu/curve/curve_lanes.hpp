// Names what is computed curve by curve in lanes, for the instruction set at hand.
#pragma once

#include <cstddef>
#include <cstdint>

#include "gpu/kernels/curve_pieces.h"

namespace hotblade::gpu {

// Holds n points, (x - ox, y - oy) scale in the curve's frame; distances come out unscaled. `unsure` has room
// for n + 8 and gets the numbers of the points that are not proven.
struct CurveQueries {
  const double *x, *y;
  double ox, oy, scale;
  std::size_t n;
  double *distance, *t;
  unsigned* unsure;
};

// Arrays for n residuals, their status codes and error bounds; no bounds where `bound` is null.
struct CurveResiduals {
  double* e;
  std::uint8_t* status;
  double* bound;
};

// The first two return how many are unsure (kernels/curve_nearest.h). The third takes eight numbers a curve.
struct CurveLanes {
  std::size_t (*whole)(const hb_curve_whole& curve, const CurveQueries& queries);
  std::size_t (*pieces)(const hb_curve_piece* pieces, int count, double sag, const CurveQueries& queries);
  void (*residuals)(const double* curves, std::size_t n, const CurveResiduals& out);
};

extern const CurveLanes kCurveBaseline, kCurveAvx2, kCurveAvx512;

// Returns the widest that this processor runs.
[[nodiscard]] const CurveLanes& curve_lanes();

}  // namespace hotblade::gpu

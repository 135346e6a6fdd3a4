// Lambda-residuals of many cubic Beziers: structure of arrays, SIMD chosen at run time.
//
// e, status and bound are as in lambda_residual (elastica/bezier/lambda_residual.hpp); a curve for which 24
// nodes do not bring the bound below 1e-9 takes graded panels, some five times as long. Each curve's result
// depends on its own numbers and the instruction set alone, so splitting a batch changes no bit. The
// functions do not allocate, and several threads may run them at once. All spans of one call have the same
// size (std::logic_error).
#pragma once

#include <cstdint>
#include <span>

#include "elastica/bezier/lambda_residual.hpp"
#include "elastica/kernels/simd.hpp"

namespace hotblade::elastica {

// Control points p0 .. p3 of n curves, any length unit.
struct BezierBatch {
  std::span<const double> x0, y0, x1, y1, x2, y2, x3, y3;
};

// The same as rows, x0 y0 .. x3 y3 of one curve and then of the next: 8 n numbers.
struct BezierRows {
  std::span<const double> points;
};

// Curves in standard position (elastica/bezier/standard_position.hpp): end edges of lengths l1, l2 (chords)
// in directions a1, a2 (rad, |a| up to 1e6).
struct EdgeBatch {
  std::span<const double> a1, a2, l1, l2;
};

// |e[i] - its true value| <= bound[i]; e[i] and bound[i] are 0 where status[i] is not kOk. An empty span of
// bounds asks for none.
struct ResidualBatch {
  std::span<double> e;
  std::span<ResidualStatus> status;
  std::span<double> bound{};
};

// Writes e and status of every curve; of rows the same bits as of columns.
void lambda_residuals(const BezierBatch& curves, const ResidualBatch& out, Simd simd = best_simd());
void lambda_residuals(const BezierRows& curves, const ResidualBatch& out, Simd simd = best_simd());
void lambda_residuals(const EdgeBatch& curves, const ResidualBatch& out, Simd simd = best_simd());

// Writes de/dl1 and de/dl2 as well, the exact derivatives of the quadrature; both are 0 where e is 0.
void lambda_residual_gradients(const EdgeBatch& curves, const ResidualBatch& out, std::span<double> by_l1,
                               std::span<double> by_l2, Simd simd = best_simd());

}  // namespace hotblade::elastica

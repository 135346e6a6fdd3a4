// What a program says of its ribs, measured: the Bezier against the elastica, sampled along its state form,
// all ribs in one batch (gpu/curve/pair_distance.hpp), and the Bezier's lambda-residual
// (gpu/curve/lambda_residuals.hpp). The plan writes these measures and verify measures them again.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "gpu/backend/backend.hpp"
#include "pipeline/program/program.hpp"
#include "pipeline/verify/refusal.hpp"

namespace hotblade::pipeline {

// Largest amount by which a measured Hausdorff distance may be too large, mm: far below what any blade or
// mesh resolves.
inline constexpr double kRibHausdorffErrorMm = 1e-4;

// Bezier against elastica, as in Rib.
struct RibMeasure {
  double l2 = 0, h1 = 0;    // pure numbers; NaN where the pair has no answer
  double hausdorff_mm = 0;  // upper bound
  double hausdorff_error_mm = 0;
};

struct RibMeasures {
  std::vector<RibMeasure> ribs;  // in the program's order, strip by strip
  gpu::BackendUse used;
};

// Measures all ribs of a program at once. No bit of the measures depends on the backend.
[[nodiscard]] RibMeasures measured_ribs(const Program& program, gpu::Backend backend);

// A number of a rib that is not what was measured.
struct RibMismatch {
  std::string rib;     // id
  std::string number;  // "l2", "h1", "hausdorff_mm" or "lambda_residual"
  double stated = 0, measured = 0, bound = 0;
};

// A rib whose Beziers do not stand for its elastica.
struct FarBezier {
  std::string strip, rib;   // ids
  double hausdorff_mm = 0;  // proven: it is at least this; NaN where the pair has no answer
  double limit_mm = 0;
};

struct RibCheck {
  std::size_t ribs = 0;                 // that were measured
  std::vector<RibMismatch> mismatches;  // in the program's order
  double bezier_limit_mm = 0;           // kBezierShare of the tolerance
  std::vector<double> bezier_mm;  // Hausdorff distance of each rib's Beziers from its elastica, from above
  std::vector<FarBezier> far;     // the ribs over that limit, in the program's order
  gpu::BackendUse used;           // what measured the distances
};

// By how much a stated number may differ from the measured one. The bounds leave room for programs of version
// 0.1, which integrated L2 and H1 by 200 intervals (0.7 % off where a Bezier nearly has a cusp) and held the
// Hausdorff distance to 1e-6 of the Bezier's length.
inline constexpr double kRibDifferenceRel = 0.01;  // of L2 and H1 themselves
inline constexpr double kRibDifferenceAbs =
    1e-9;                                         // of L2 and H1 of curves that are the same but for rounding
inline constexpr double kRibHausdorffRel = 2e-6;  // of the elastica's length, beside the measure's own error
inline constexpr double kRibResidualAbs = 1e-6;   // of the lambda-residual
// A cubic whose inner control points lie nearer to its chord, in chords, has no residual worth comparing: the
// digits of its coordinates do not say which way it bends.
inline constexpr double kRibResidualLeastBend = 1e-4;

// Measures all ribs of a program, compares them with what it says of them, and holds their Beziers to their
// share of a tolerance.
[[nodiscard]] RibCheck check_ribs(const Program& program, double tolerance_mm, gpu::Backend backend);

// One line: "S001R002: l2 is 0.5 in the program, 0.000123 when measured (bound 1.2e-07)".
[[nodiscard]] std::string describe(const RibMismatch& mismatch);

// One line: "strip S001, rib S001R002: Bezier 0.432 mm off its elastica (limit 0.1 mm)".
[[nodiscard]] std::string describe(const FarBezier& bezier);

// The refusal of a plan with such a rib.
[[nodiscard]] Refusal refusal_of(const FarBezier& bezier);

// One line for all ribs: how many, the largest distance, the 99th percentile, how many are over the limit.
[[nodiscard]] std::string describe_beziers(const RibCheck& check);

}  // namespace hotblade::pipeline

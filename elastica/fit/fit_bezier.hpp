// The elastica nearest to a cubic Bezier in the paper's L2 distance, one curve or many at a time (Brander,
// Bærentzen, Fisker, Gravesen, "Bezier curves that are close to elastica", section 2: an elastica of any
// length, traversed proportionally). Any length unit.
#pragma once

#include <span>
#include <vector>

#include "elastica/bezier/bezier.hpp"
#include "elastica/curve/elastica.hpp"

namespace hotblade::elastica {

enum class FitStatus {
  kOk,
  kNotConverged,  // the best found is returned, but the search was still moving
  kUnsupported,   // a cusp, a zero end edge, or turning beyond what any blade takes: no fit
};

// Returns the word for a status.
[[nodiscard]] constexpr const char* name(FitStatus status) {
  constexpr const char* kNames[] = {"ok", "not_converged", "unsupported"};
  return kNames[static_cast<int>(status)];
}

struct BezierFitOptions {
  // Tries every start for every curve; otherwise the others are tried only where the first answer is farther
  // off than its lambda-residual lets one expect (docs/elastica.md).
  bool all_starts = false;
};

struct BezierElasticaFit {
  Elastica elastica;
  // The paper's distances: pure numbers, relative to the Bezier's length; by quadrature over 49 nodes, good
  // to 1e-3 of themselves or 1e-6 (tested within the paper's constraints).
  double l2 = 0, h1 = 0;
  int starts_tried = 0;
  FitStatus status = FitStatus::kOk;
};

// The nearest elastica, with its distances and how the search ended.
[[nodiscard]] BezierElasticaFit fit_bezier_elastica(const Bezier& bezier,
                                                    const BezierFitOptions& options = {});

// The fits of many curves: bit for bit those of one at a time, several times faster.
[[nodiscard]] std::vector<BezierElasticaFit> fit_bezier_elastica(std::span<const Bezier> beziers,
                                                                 const BezierFitOptions& options = {});

}  // namespace hotblade::elastica

// Seams of swept strips: planes at which two parts of a design meet, where both shall form the same surface.
//
// A place of a seam is a point of the design on it, with one on either side, across the seam. Each is formed
// by the families of both parts, off the design by a signed distance along its normal; the difference of the
// two is what stands between the surfaces there. On the seam it is the gap, and its change across the seam
// the kink.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "pipeline/plan/ribs/strip_plan.hpp"
#include "pipeline/plan/sweep/sweep_sections.hpp"

namespace hotblade::pipeline {

// A part as its seams see it.
struct SeamSide {
  const RibAxes* axes = nullptr;
  const std::vector<SweepSeam>* seams = nullptr;
  const WasteSurface* surface = nullptr;  // the triangles near the part
  const SweepSag* sag = nullptr;          // of the blades that form it; none: weightless ones
  const SweptBands* bands = nullptr;      // SweepSectionOptions
  double first_mm = 0, last_mm = 0;       // of its family, along the sweep
};

struct SeamPlace {
  static constexpr std::size_t kProbes = 3;
  Eigen::Vector3d at{0, 0, 0};  // of the design
  std::array<std::array<FormedPoint, kProbes>, 2>
      on;  // by the first and the second part: before, on, behind the seam
};

struct PartSeam {
  std::size_t first = 0, second = 0;  // numbers of the parts, the smaller one first
  std::vector<SeamPlace> places;      // some mm apart; at least one
};

// Probes beside a seam are this far from it: within what both parts' data reach past it.
inline constexpr double kSeamProbeMm = 6;

// Returns the seams of parts that have a plane in common, seen from both sides, and design there. The result
// does not depend on the order of triangles but for ties.
[[nodiscard]] std::vector<PartSeam> seams_of(const std::vector<SeamSide>& parts,
                                             const SweepSectionOptions& options);

// Returns what two families leave between them at a seam: the largest gap in mm and kink in degrees.
[[nodiscard]] SeamFacts seam_facts(const PartSeam& seam, const SweepFamily& first, const SweepFamily& second,
                                   double reach_mm);

}  // namespace hotblade::pipeline

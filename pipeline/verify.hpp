// The verify stage: the surface a program cuts against the design, both ways.
//
// Cut to design: every sample of the as-cut surface. A sample whose nearest design point lies on the design's
// border has run past the edge; only its distance across the design's plane there counts. Design to cut:
// every sample of the design; one farther than `reach` tolerances from every cut counts as uncut area, not as
// deviation.
#pragma once

#include <vector>

#include "pipeline/program.hpp"
#include "surface/design_surface.hpp"

namespace hotblade::pipeline {

struct VerifyOptions {
  double tolerance_mm = 1;
  double max_uncut_share = 0.01;
  double sample_mm = 2.5;  // spacing of samples on both surfaces
  double reach = 3;        // tolerances
};

struct VerifyReport {
  Deviation deviation;
  std::vector<double> strip_max_mm;  // cut to design, by strip
  double uncut_mm2 = 0, area_mm2 = 0;
  std::size_t cut_samples = 0, design_samples = 0;
  bool within_tolerance = false;  // deviation and uncut share both
  [[nodiscard]] double uncut_share() const { return area_mm2 > 0 ? uncut_mm2 / area_mm2 : 0; }
};

[[nodiscard]] VerifyReport verify(const Program& program, const surface::DesignSurface& design,
                                  const VerifyOptions& options);

// What no stage of this version looks at; said in every program and report.
[[nodiscard]] std::vector<std::string> not_checked();

}  // namespace hotblade::pipeline

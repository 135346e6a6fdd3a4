// The error budget of an executed motion: every step of the chain measured on its own, mm.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "pipeline/program/program.hpp"
#include "pipeline/verify/verify.hpp"
#include "surface/read/design_surface.hpp"

namespace hotblade::pipeline {

struct ExecutedStrip;

struct AsCutBudget {
  // mesh: chord height of the facets (budget.hpp). section: the ribs' targets against the design, by the
  // blade's whole width and half its band. fit, joint_fit: the ribs' elastica against their targets, by each
  // rib's own fit and by what solving the strip together added. between_ribs: what the planned deviation
  // exceeds that of the ribs' own curves by. kerf_width: the half band by the cut's own slope against that by
  // the design's. gravity_droop, gravity_in_plane, clamp_error: as planned, from the program. quantisation:
  // the blade between the registers' clamps against the one between the program's, moved alike.
  // interpolation: that against the planned motion, a cubic in time through the program's poses.
  std::vector<std::pair<std::string, double>> lines_mm;
  std::vector<std::string> missing;  // lines of the plan that the program does not have
  double shape_mismatch_mm =
      0;  // largest of executed blade against the planned motion, where it was compared
};

// Returns the budget's lines, each measured on its own from the program, the log and the design.
[[nodiscard]] AsCutBudget as_cut_budget(const Program& program, const std::vector<ExecutedStrip>& executed,
                                        const surface::DesignSurface& design, double half_band_mm,
                                        const VerifyOptions& options);

// Returns how far a place on the path, s, lies between two poses of the program, 0 to 1.
[[nodiscard]] double share_of_step(const BladePose& from, const BladePose& to, double path_s);

}  // namespace hotblade::pipeline

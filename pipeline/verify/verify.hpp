// The verify stage: the surface a program cuts against the design, both ways.
//
// Cut to design: every sample of the as-cut surface. A sample whose nearest design point lies on the design's
// border has run past the edge; only its distance across the design's plane there counts, and nothing of it
// farther than `edge_mm` past the edge: there is no design to compare it with, and the plane of the last
// facet is off by more and more of its turn. Design to cut: every sample of the design; it counts as uncut
// area, not as deviation, when it lies farther than `reach` tolerances from the cut and its nearest cut point
// is on the cut's edge, or farther than `far` tolerances from every cut.
//
// Samples lie close only where that settles something. The cut's lie as far apart as it is straight
// (swept_surface.hpp). The design's are corners of cells that are divided (design_cells.hpp) until the bound
// of all that lies between them is no more than a hundredth of the tolerance above the largest deviation
// found.
//
// The cut is measured on the program's shapes. That the clamps lead the blade to just these, on one stable
// branch from the flat arc and within yield, is found by solving its equilibrium again from the clamp poses
// alone (pipeline/verify/branch.hpp). What the program says of its ribs is measured again, all ribs at once
// (pipeline/verify/rib_measures.hpp). So is what its motion asks of machine, heat and block
// (pipeline/verify/motion_check.hpp).
#pragma once

#include <vector>

#include "gpu/backend/backend.hpp"
#include "pipeline/program/program.hpp"
#include "pipeline/verify/branch.hpp"
#include "pipeline/verify/clamp_mismatch.hpp"
#include "pipeline/verify/deviation_statistics.hpp"
#include "pipeline/verify/motion_check.hpp"
#include "pipeline/verify/rib_measures.hpp"
#include "pipeline/verify/row_bounds.hpp"
#include "pipeline/verify/swept_surface.hpp"
#include "surface/read/design_surface.hpp"

namespace hotblade::pipeline {

struct VerifyOptions {
  double tolerance_mm = 1;
  double max_uncut_share = 0.01;
  double sample_mm = 2.5;      // spacing of samples on both surfaces, where they lie close
  double widest = 4;           // times that: where nothing asks for close ones; 1: a dense grid everywhere
  double reach = 3, far = 20;  // tolerances
  double edge_mm = 0.1;  // samples of the cut farther past the design's edge are left out: a border counts as
                         // the design, whose every place is compared with the cut
  gpu::Backend backend = gpu::Backend::kCpu;  // no value of the report depends on it
  double min_margin = 0;                      // smallest accepted stability margin
  // Only what is cut against the design, of which no more than the corners of large facets are asked for:
  // nothing is said of what of it is left uncut.
  bool cut_only = false;
  bool by_every_pose = false;  // where the band's edge is: GridSteps
  bool motion = true;  // with what a program's motion must not; a plan made and measured its own
};

// Where a hot blade is in foam without forming the design: points of its centre line.
struct BladeTouches {
  std::vector<Eigen::Vector3d> points;         // mm, design frame
  std::vector<Eigen::Vector3d> plane_normals;  // unit, of the plane the blade bends in
  std::vector<double> speeds_mm_s;             // square to the blade
  std::vector<int> strip_of_point;
};

struct VerifyReport {
  Deviation deviation;  // of the samples; mean, root mean square and percentiles by the area they stand for
  // No place of the design that counts lies farther from the cut, samples or not, as a controller is told it
  // in micrometres; no less than the deviation. What it takes for granted: the surface that is cut bends
  // between the grid's points as at them.
  double bound_mm = 0;
  int worst_strip = -1;     // of the largest deviation: index into program.strips
  double gouge_mm = 0;      // deepest cut of a touch into the kept side of its own strip's design
  double half_band_mm = 0;  // largest difference of the half band by the cut's own slope and by the design's
  DeviationHistogram histogram;                           // up to 1.5 tolerances
  std::vector<std::pair<double, double>> percentiles_mm;  // percent of the area, deviation it stays within
  // By strip: of the samples of both surfaces that are its own or nearest to it, and the bound of their
  // cells.
  std::vector<double> strip_max_mm, strip_bound_mm;
  std::vector<Eigen::Vector3d> strip_max_at;  // where the samples deviate the most
  // By strip: how much of its bound the registers' micrometres are; none of a cut that was only measured.
  std::vector<double> strip_told_mm;
  RowBounds rows;  // of a cut that was only measured
  double uncut_mm2 = 0, area_mm2 = 0;
  double clamp_mismatch_mm = 0;  // clamp poses against the ends of the planned blade
  std::size_t cut_samples = 0, design_samples = 0;
  std::size_t beyond_samples = 0;  // of the cut: past the design's edge, in a window for example
  double beyond_mm2 = 0;           // that they stand for
  // What lies farther off than `reach` past an edge counts as uncut or beyond, so a deviation close to that
  // is as large or larger.
  bool capped = false;
  bool within_tolerance = false;       // the bound and the uncut share both
  gpu::BackendUse to_design, to_cut;   // what computed the distances each way
  std::vector<BranchReport> branches;  // by strip
  RibCheck ribs;                       // what the program says of its ribs, measured again
  std::vector<MotionBreach> motion;    // what its motion asks for beside that and must not; empty: nothing
  // Returns whether every strip's blade takes the program's shapes and is led by its clamps.
  [[nodiscard]] bool holds() const;
  [[nodiscard]] double uncut_share() const { return area_mm2 > 0 ? uncut_mm2 / area_mm2 : 0; }
};

// Adds to a strip's bound what its branch says of the registers' micrometres, where they move the blade.
void add_told(VerifyReport& report, std::size_t index, const Strip& strip, const BranchReport& branch,
              double width_mm);

// Measures what a program cuts against the design: everything of verify() but the shapes and the clamps. A
// touch counts, by the edge of its melted band, where it reaches into the kept side of what its own strip
// forms; on the waste side it does no harm.
[[nodiscard]] VerifyReport measure(const Program& cut, const BladeTouches& touches,
                                   const surface::DesignSurface& design, const VerifyOptions& options);

// The same of a surface, with the strips and the blade of a program.
[[nodiscard]] VerifyReport measure(const SweptSurface& cut, const Program& program,
                                   const surface::DesignSurface& design, const VerifyOptions& options);

// Measures what a program cuts against the design, and finds its blades again from their clamps.
[[nodiscard]] VerifyReport verify(const Program& program, const surface::DesignSurface& design,
                                  const VerifyOptions& options);

// Returns what no stage of this version looks at, as every program and report says it.
[[nodiscard]] std::vector<std::string> not_checked(const robot::Blade& blade);

}  // namespace hotblade::pipeline

// What was cut: the surface of an executed motion, from its log alone, against the design.
//
// The log's poses are the interpolated motion of the quantised registers and the blade's equilibrium there,
// every 10 ms in the cell frame (docs/controller-protocol.md). The program brings them back to the design
// frame (design_to_cell) and says which part of the blade forms the design. mm, s.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/program/strip_jobs.hpp"
#include "pipeline/verify/verify.hpp"

namespace hotblade::pipeline {

// The motion of one strip as it was executed: poses in the design frame, with `foam` where the hot blade
// forms the design. The log knows no phases, ribs or margins: those stand at their defaults.
struct ExecutedStrip {
  std::vector<BladePose> poses;
  std::vector<std::size_t> after;  // of every pose: the program's pose at or before it on the path
  std::vector<double> path_s;      // and its place on the path, in the program's time
  double executed_s = 0;           // motion clock at the last pose
};

// Returns the strips of a program, in its order, out of an execution log. The proof comes first: every
// waypoint once, in order, byte for byte, hash chain equal. Throws Error: kFile when the log cannot be read,
// kBadInput when it is no log, of another program, incomplete, or without shapes, with the reason.
[[nodiscard]] std::vector<ExecutedStrip> read_executed(const StripJobs& work,
                                                       const std::filesystem::path& log_file);

// Returns the program with the poses that were executed in place of the planned ones: those that form the
// design, in the order of the path, without what was gone over again after a retraction. Where the blade was
// cold or in no foam between two of them, a cold pose stands.
[[nodiscard]] Program as_executed(const Program& program, const std::vector<ExecutedStrip>& executed);

struct AsCutReport {
  // Executed surface against the design, both ways; no branches and no clamps, which the log's shapes
  // replace. Every hot pose counts in which any part of the blade is inside the stock: what forms the design
  // by its whole deviation, the rest (lead-in and lead-out, approach, retract, the ends beyond the design) by
  // how far the edge of its melted band reaches into the kept side.
  VerifyReport cut;
  std::string strip, rib;                                 // of the largest deviation, the nearest rib
  std::vector<std::pair<std::string, double>> budget_mm;  // in order; together no less than the deviation
  std::vector<std::string> not_in_budget;                 // lines the program does not have
  double shape_mismatch_mm =
      0;  // executed blade against the planned one, largest of interpolation and registers
  std::size_t hot_poses = 0, touch_samples = 0;
  double executed_s = 0;
  [[nodiscard]] double budget_sum_mm() const;
  // The measured deviation with the lines of the budget that no execution log tells: the design's facets,
  // the blade's weight and its clamps' errors. It is to the budget of a plan as what was cut is to the plan.
  [[nodiscard]] double in_cell_mm() const;
};

// Returns the measure of an executed motion against the design, with its error budget.
[[nodiscard]] AsCutReport as_cut(const Program& program, const std::vector<ExecutedStrip>& executed,
                                 const surface::DesignSurface& design, const VerifyOptions& options);

// Returns one JSON object: deviation, uncut area, worst place, budget, counts.
[[nodiscard]] std::string to_json(const AsCutReport& report, const VerifyOptions& options);
// Returns text for people, one fact a line.
[[nodiscard]] std::string describe(const AsCutReport& report, const VerifyOptions& options);

}  // namespace hotblade::pipeline

// What a cell does otherwise than a plan thought: the numbers that a measured cut is asked for.
//
// Sixteen numbers: how each clamp holds the blade from where it is told to be (three shifts, three turns),
// how much longer every blade is between its clamps, how much stiffer, the band it melts at one speed, and
// how much that depends on the speed. All of them are settings too. mm, rad, mm/s.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "elastica/blade/gravity.hpp"
#include "pipeline/program/program.hpp"
#include "pipeline/settings/settings.hpp"
#include "pipeline/verify/swept_surface.hpp"

namespace hotblade::pipeline {

// The numbers, in their order; shifts and turns along and about the tangent, the in-plane normal, the plane's
// normal.
enum class CellError : std::size_t {
  kShiftA,
  kTurnA = 3,
  kShiftB = 6,
  kTurnB = 9,
  kLength = 12,
  kStiffness,
  kBand,
  kSlowing,
};
inline constexpr std::size_t kCellErrors = 16;
using ErrorVector = Eigen::Matrix<double, kCellErrors, 1>;

struct CellErrorInfo {
  std::string_view key;    // of reports
  std::string_view words;  // "clamp A along the blade"
  std::string_view unit;   // mm, rad, or empty: a share
  // What it may be off by, as one standard deviation, before anything is measured: wide enough for a cell
  // that was set up by hand. Where a scan tells nothing, the estimate stays at the settings.
  double expected = 0;
};
[[nodiscard]] const CellErrorInfo& info_of(std::size_t error);

// How the band depends on the speed v, about a speed of reference: band / (1 + slowing (v / reference - 1)).
// Slowing 0 is one band; melt_mm2_s / (v + loss_mm_s) has loss_mm_s = reference (1 / slowing - 1). Where a
// table was given, `band` over the table's at the reference scales all of it, and slowing says nothing.
struct BandModel {
  double reference_mm_s = 0;
  robot::Blade nominal;  // with the melt that the program was planned with

  // Takes the feed of the plan as the speed of reference.
  explicit BandModel(const Program& program);
  // Returns the band at the speed of reference and the slowing that the plan took.
  [[nodiscard]] double band_mm() const { return nominal.band_mm(reference_mm_s); }
  [[nodiscard]] double slowing() const;
  [[nodiscard]] bool tabled() const { return !nominal.melt.band_mm_at_mm_s.empty(); }
  // Sets the band of a blade to what two of the numbers say.
  void apply(double band_mm, double slowing, robot::Blade& blade) const;
};

// Returns what the program was planned with.
[[nodiscard]] ErrorVector planned_errors(const Program& program);
// Returns the settings of the program with these numbers in place of theirs.
[[nodiscard]] Settings with_errors(const Program& program, const ErrorVector& errors);
// Returns what settings say of the cell that cuts a program: of all of the numbers, in place of the program's
// own.
[[nodiscard]] ErrorVector errors_of(const Program& program, const Settings& settings);

// Returns the keys of the settings that errors_of() looks at: no other says anything of the cell.
[[nodiscard]] const std::vector<std::string>& cell_keys();

// What the clamps of a strip do to the blade in every pose.
struct HeldStrip {
  Strip strip;                            // with the blade in the plane that its clamps hold it in
  std::vector<elastica::EndTurns> turns;  // by pose: of both ends out of that plane
  std::size_t lost = 0;                   // poses without an equilibrium on the way from the planned shape
};

// Returns a strip as a cell with these errors executes it: its clamps told as before, every blade in the
// equilibrium that follows from the planned shape as the clamps move to where they really hold it, and the
// blade's length changes.
[[nodiscard]] HeldStrip held_strip(const Program& program, const Strip& strip, const ErrorVector& errors);

// Returns a program of one strip with only those of its forming poses that a surface of this sample takes.
[[nodiscard]] Program thinned_to(const Program& program, std::size_t strip, double sample_mm);

// Returns the surface that a cell with these errors cuts with the only strip of thinned_to(sample_mm). Its
// grid does not depend on the errors, so that surfaces can be compared vertex by vertex.
[[nodiscard]] SweptSurface cut_with(const Program& thinned, const ErrorVector& errors, double sample_mm);

}  // namespace hotblade::pipeline

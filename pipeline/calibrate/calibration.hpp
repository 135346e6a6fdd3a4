// From scans of what was cut to settings for what is cut next.
#pragma once

#include <string>
#include <vector>

#include "pipeline/calibrate/estimate.hpp"
#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

// The scan of one strip's cut.
struct MeasuredCut {
  std::size_t strip = 0;                // index into the program's
  std::string file;                     // as messages name it
  std::vector<Eigen::Vector3d> points;  // mm
};

// What is known of where a scan stands.
enum class ScanPlacement {
  kSearch,  // nothing: any place and direction
  kNear,    // within some 20 mm and 10 degrees of the design's frame
  kFixed,   // in the design's frame: the scan was measured from the block's own marks
};

struct Calibration {
  std::vector<std::string> strips;  // of the scans
  std::vector<std::string> files;
  Estimate estimate;
  ScanPlacement placement = ScanPlacement::kSearch;
};

// Returns what the scans say of the cell that cut a program, whose poses are those that were executed. Throws
// Error (kBadInput), with the scan's file: a strip whose blade is nearly straight, so that the clamps' errors
// decide its shape to second order only; a scan that is larger or smaller than the cut as by a wrong unit, or
// does not fit it; one that fits it as well from several sides, each named; and one that tells nothing.
[[nodiscard]] Calibration calibrate(const Program& executed, const std::vector<MeasuredCut>& scans,
                                    ScanPlacement placement);

// Returns the settings that a plan with this calibration has in place of the program's.
[[nodiscard]] Settings calibrated(const Program& program, const Calibration& calibration);

// Returns calibration.toml: the settings with what is known of each number beside it.
[[nodiscard]] std::string calibration_toml(const Program& program, const Calibration& calibration);

// Returns the report for people, and as one JSON object. `truth` stands beside each number where it is known,
// in a rehearsal.
[[nodiscard]] std::string describe(const Calibration& calibration, const ErrorVector* truth = nullptr);
[[nodiscard]] std::string to_json(const Calibration& calibration, const ErrorVector* truth = nullptr);

}  // namespace hotblade::pipeline

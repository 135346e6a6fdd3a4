// What a measured cut says of the cell that made it.
//
// Unknown are the sixteen numbers of cell_errors.hpp and where each scan lies. Every scanned point asks that
// the cut of a cell with these numbers passes through it; points that stray far have no say (Tukey's
// biweight). Before any point is looked at the numbers are expected at the settings, each within what a cell
// set up by hand may be off by: so where the scan says nothing they stay there, and the answer's uncertainty
// is that expectation. Gauss and Newton, with derivatives of the cut surface by differences.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <string>
#include <vector>

#include "pipeline/calibrate/cell_errors.hpp"
#include "pipeline/calibrate/cut_mesh.hpp"

namespace hotblade::pipeline {

using ErrorMatrix = Eigen::Matrix<double, kCellErrors, kCellErrors>;

// The surfaces that scans are held against have vertices about so far apart; between them they are smooth
// (cut_mesh.hpp).
inline constexpr double kCutSampleMm = 10;

// One strip's cut as it was measured.
struct StripScan {
  Program program;  // of this strip alone, thinned_to(sample_mm)
  std::vector<Eigen::Vector3d> points;
  Eigen::Isometry3d scan_to_design = Eigen::Isometry3d::Identity();  // a placement near its own
  double sample_mm = kCutSampleMm;
};

// So many points of a scan are looked at; more say nothing new at this sample.
inline constexpr std::size_t kMostScanPoints = 8000;

struct EstimateOptions {
  int most_rounds = 30;  // of Gauss and Newton; what is not found by then is hardly told
  bool fixed = false;    // the scans stand in the design's frame already
};

// Heights of measured points above a surface, those with a say.
struct Misfit {
  double rms_mm = 0, p95_mm = 0, max_mm = 0;
};

// A blend of numbers that the scan cannot tell: changing all of them together, each by its share of what it
// is expected to be off by, changes nothing that was measured.
struct Blend {
  struct Part {
    std::size_t error = 0;
    double share = 0;  // with sign; the squares of all sum up to 1
  };
  std::vector<Part> parts;  // the larger ones, largest first
  double left = 1;          // uncertainty left of what was expected, 0 to 1
  [[nodiscard]] std::string describe() const;
};

struct Estimate {
  ErrorVector planned = ErrorVector::Zero(), value = ErrorVector::Zero();
  ErrorVector expected = ErrorVector::Zero();     // 0 where a number was not asked for
  ErrorMatrix covariance = ErrorMatrix::Zero();   // of the value, what was expected included
  std::vector<Eigen::Isometry3d> scan_to_design;  // by scan
  Misfit before, after;                           // against the cut as planned, and as estimated
  double noise_mm = 0;                            // of a point: of the heights that are left
  double correlation = 1;                         // so many neighbouring points say as much as one
  std::size_t points = 0, used = 0, far = 0, beside = 0;
  std::vector<Blend> untold;  // least told first
  std::size_t told = 0;       // independent blends that the scan tells
  int rounds = 0;

  [[nodiscard]] double sd(std::size_t error) const;
  // Tells whether the scan left at most half of what a number was expected to be off by.
  [[nodiscard]] bool told_alone(std::size_t error) const;
  [[nodiscard]] bool tells_nothing() const { return told == 0; }
};

// Returns what the scans say together. Throws Error (kBadInput) where fewer than 100 points lie on the cut.
[[nodiscard]] Estimate estimate(const std::vector<StripScan>& scans, const EstimateOptions& options);

}  // namespace hotblade::pipeline

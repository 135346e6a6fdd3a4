// What a scanner would see of a cut by a cell that is off: for rehearsals, and to prove the calibration by.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "pipeline/calibrate/cell_errors.hpp"

namespace hotblade::pipeline {

struct ScanRehearsal {
  std::size_t points = 5000;
  double noise_mm = 0.2;   // standard deviation of a point, along the surface's normal and across it
  double outliers = 0.02;  // share of the points that lie anywhere within 10 mm of the surface
  double seen = 1;         // share of the cut's area, from one corner on
  bool moved = true;       // the scanner's frame is not the design's: any turn, any shift within half a metre
  std::uint64_t seed = 1;
};

struct RehearsedScan {
  std::vector<Eigen::Vector3d> points;                               // mm, in the scanner's frame
  Eigen::Isometry3d scan_to_design = Eigen::Isometry3d::Identity();  // what registration should find
};

// Returns the scan of one strip's cut by a cell with these errors. The surface is sampled every 2 mm, finer
// than a calibration looks, and the same seed gives the same points on every machine.
[[nodiscard]] RehearsedScan rehearsed_scan(const Program& program, std::size_t strip,
                                           const ErrorVector& errors, const ScanRehearsal& how);

}  // namespace hotblade::pipeline

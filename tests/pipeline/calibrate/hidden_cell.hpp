// Cells that are off by what nobody told the planner.
#pragma once

#include <array>
#include <cmath>
#include <random>

#include "pipeline/calibrate/cell_errors.hpp"
#include "pipeline/plan/plan.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline::testing {

// A saddle-like panel that looks the same from no two sides: 420 mm along the ribs, 300 mm along the sweep.
inline surface::DesignSurface crooked_panel() {
  return grid_design("panel", 40, 60, [](double u, double v) {
    const double x = 300 * u, y = 420 * (v - 0.5);
    return Eigen::Vector3d(x, y,
                           60 - 0.0011 * y * y - 0.00035 * (x - 120) * (x - 120) + 1.1e-6 * y * y * y +
                               0.0004 * x * y + 1.2e-6 * x * y * y);
  });
}

inline Settings panel_settings() {
  Settings settings = along_x();
  settings.design.tolerance_mm = 0.5;
  return settings;
}

inline const Program& panel_program() {
  static const Program program = plan(crooked_panel(), panel_settings(), {}).program;
  return program;
}

// Errors of a cell drawn within what is expected: normal, one standard deviation times `scale`, of each of
// the numbers.
inline ErrorVector hidden_errors(const Program& program, unsigned seed, double scale = 1) {
  std::mt19937_64 engine(seed);
  ErrorVector errors = planned_errors(program);
  for (std::size_t i = 0; i < kCellErrors; ++i) {
    // The sum of twelve is nearly normal, and the same on every machine.
    double sum = -6;
    for (int k = 0; k < 12; ++k) sum += static_cast<double>(engine() >> 11U) * 0x1p-53;
    errors[static_cast<Eigen::Index>(i)] += scale * sum * info_of(i).expected;
  }
  auto& slowing = errors[static_cast<Eigen::Index>(CellError::kSlowing)];
  slowing = std::min(0.8, std::abs(slowing));
  auto& band = errors[static_cast<Eigen::Index>(CellError::kBand)];
  band = std::max(band, 0.55);
  return errors;
}

}  // namespace hotblade::pipeline::testing

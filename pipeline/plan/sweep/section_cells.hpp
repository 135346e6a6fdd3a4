// Samples of one section on their way: one for each cell of a grid, the nearest to its middle, and all points
// of the border.
#pragma once

#include <vector>

#include "pipeline/plan/sweep/sweep_sections.hpp"

namespace hotblade::pipeline {

class SectionCells {
 public:
  explicit SectionCells(double cell_mm) : cell_mm_(cell_mm) {}

  void add(const SweepSample& sample);
  void add_border(const SweepSample& sample) { border_.push_back(sample); }

  // Ascending in x.
  [[nodiscard]] std::vector<SweepSample> samples() const;

 private:
  struct InCell {
    long x = 0, y = 0;  // the cell
    double away = 0;    // from its middle, squared, in cells
    SweepSample sample;
  };

  double cell_mm_;
  std::vector<InCell> cells_;  // as they came; a cell's samples that came in a row are one
  std::vector<SweepSample> border_;
};

}  // namespace hotblade::pipeline

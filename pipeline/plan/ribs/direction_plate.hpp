// Directions of a run's ribs as one smooth field over their window and the sweep: a thin plate that is bent
// to what the sections say and goes on where they say nothing.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "pipeline/plan/ribs/target.hpp"

namespace hotblade::pipeline {

// Of all fields the one with the least sum of: squared differences from the sections' directions, and squared
// second derivatives times a twentieth of window and sweep to the fourth power (Duchon 1977); by bilinear
// elements. So single facets do not show, curvatures go on as they are, and an affine field comes back
// exactly.
class DirectionPlate {
 public:
  // `starts`: where each section begins along the window, mm. Offsets ascending, at least two sections.
  DirectionPlate(std::span<const RibTarget> sections, const std::vector<double>& starts,
                 const std::array<double, 2>& window_mm);

  // Direction in rad, not modulo a turn; places outside are taken to the nearest one inside.
  [[nodiscard]] double at(double along_mm, double offset_mm) const;

 private:
  // Nodes around a place and their shares.
  struct Cell {
    std::array<int, 4> node{};
    std::array<double, 4> share{};
  };
  [[nodiscard]] Cell cell(double along_mm, double offset_mm) const;

  std::array<double, 2> window_, sweep_{};
  Eigen::VectorXd theta_;
};

}  // namespace hotblade::pipeline

// Extruded profiles for the planner's tests: stair nosings, half-rounds, grooves.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <string>

#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {

// A fold rounded by a radius, between two flat legs; without legs a half-round. The foam is inside.
struct Fold {
  double radius_mm = 30, turn_rad = 1.5707963267948966, first_mm = 300, second_mm = 150, long_mm = 1000;
  double share = 0.5;  // of the turn before the profile is level
  bool hollow = false;

  // At t in [0, 1] along the profile, in y and z; the arc's middle is the origin.
  [[nodiscard]] Eigen::Vector2d at(double t) const {
    const double arc = radius_mm * turn_rad, s = t * (first_mm + arc + second_mm) - first_mm;
    const double angle = (s <= 0 ? 0.0 : s >= arc ? turn_rad : s / radius_mm) - share * turn_rad;
    const double beyond = s <= 0 ? s : s >= arc ? s - arc : 0.0;
    const Eigen::Vector2d out(std::sin(angle), std::cos(angle)), on(std::cos(angle), -std::sin(angle));
    const Eigen::Vector2d p = radius_mm * out + beyond * on;
    return hollow ? Eigen::Vector2d(p.x(), -p.y()) : p;
  }
};

inline surface::DesignSurface extruded(const Fold& fold,
                                       const Eigen::Isometry3d& placed = Eigen::Isometry3d::Identity()) {
  return grid_design("fold", 20, 96, [&](double u, double v) -> Eigen::Vector3d {
    const Eigen::Vector2d p = fold.at(v);
    return placed * Eigen::Vector3d(fold.long_mm * u, p.x(), p.y());
  });
}

inline Eigen::Isometry3d tilted_in_space() {
  Eigen::Isometry3d t = Eigen::Isometry3d::Identity();
  t.rotate(Eigen::AngleAxisd(0.6, Eigen::Vector3d(1, 2, -0.7).normalized()));
  t.pretranslate(Eigen::Vector3d(-900, 5000, 320));
  return t;
}

}  // namespace hotblade::pipeline

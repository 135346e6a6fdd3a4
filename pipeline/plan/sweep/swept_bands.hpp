// What a blade melts at the places of its cut, by the speeds of a plan: the next one is offset by that.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>

#include "pipeline/verify/blade_speeds.hpp"
#include "robot/blade/blade.hpp"

namespace hotblade::pipeline {

class SweptBands {
 public:
  // `speeds` are not empty, and the blade's band depends on them.
  SweptBands(const robot::Blade& blade, BladeSpeeds speeds) : blade_(blade), speeds_(std::move(speeds)) {}

  // Returns the melted band in mm, square to the blade's width, where the blade passes nearest to a point.
  [[nodiscard]] double band_mm(const Eigen::Vector3d& point) const {
    return blade_.band_mm(speeds_.at(point));
  }
  // Returns by how much these bands and others differ at most, at places of these; with none, from one band.
  [[nodiscard]] double farthest_mm(const SweptBands* other, double band_mm) const {
    double farthest = 0;
    speeds_.for_each([&](const Eigen::Vector3d& point, double speed_mm_s) {
      const double was = other ? other->band_mm(point) : band_mm;
      farthest = std::max(farthest, std::abs(blade_.band_mm(speed_mm_s) - was));
    });
    return farthest;
  }

 private:
  robot::Blade blade_;
  BladeSpeeds speeds_;
};

}  // namespace hotblade::pipeline

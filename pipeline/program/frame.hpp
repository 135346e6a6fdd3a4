// A plane with axes in the design frame, mm.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace hotblade::pipeline {

// A plane's axes in the design frame; the third axis is x cross y.
struct Frame {
  Eigen::Vector3d origin{0, 0, 0}, x{1, 0, 0}, y{0, 1, 0};
  [[nodiscard]] Eigen::Vector3d normal() const { return x.cross(y); }
  [[nodiscard]] Eigen::Vector3d point(double u, double v, double w = 0) const {
    return origin + u * x + v * y + w * normal();
  }
};

}  // namespace hotblade::pipeline

#include "pipeline/plan/ribs/rib_axes.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace hotblade::pipeline {

Frame RibAxes::plane(double offset_mm) const {
  if (!planes.turns()) return {planes.centre() + offset_mm * sweep, x, y};
  return {planes.centre(), planes.turned(x, offset_mm), planes.turned(y, offset_mm)};
}

Frame RibAxes::plane_at(const Eigen::Vector3d& p) const {
  if (!planes.turns()) return plane(planes.offset(p));
  return {planes.centre(), planes.turned_to(x, p), planes.turned_to(y, p)};
}

double RibAxes::offset(const Frame& frame) const {
  if (!planes.turns()) return (frame.origin - planes.centre()).dot(sweep);
  const Eigen::Vector3d normal =
      x.cross(y).dot(sweep) > 0 ? frame.normal() : Eigen::Vector3d(-frame.normal());
  const double angle = std::atan2(planes.axis().dot(sweep.cross(normal)), sweep.dot(normal));
  return planes.radius_mm() * angle;
}

double RibAxes::rate(const Eigen::Vector2d& q) const {
  if (!planes.turns()) return 1;
  const Eigen::Vector3d out = q.x() * x + q.y() * y;
  return planes.axis().cross(out).norm() / planes.radius_mm();
}

}  // namespace hotblade::pipeline

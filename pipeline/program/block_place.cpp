#include "pipeline/program/block_place.hpp"

#include <cmath>
#include <numbers>

namespace hotblade::pipeline {

robot::Pose BlockPlace::in_box(const robot::Pose& in_cell) const {
  if (turned_rad == 0) return in_cell;
  const Eigen::Quaterniond back(Eigen::AngleAxisd(-turned_rad, Eigen::Vector3d::UnitZ()));
  return {back * in_cell.p, back * in_cell.q};
}

BlockPlace standing_place(const Block& block, const robot::Pose& design_to_cell) {
  BlockPlace place;
  const Eigen::Matrix3d turn = design_to_cell.q.toRotationMatrix();
  constexpr double kRounding_rad = 1e-6, kUpright = 0.7;
  Eigen::Vector3d back = turn * block.frame.y;
  if (std::abs(back.z()) > kUpright)
    back = Eigen::Vector3d::UnitZ().cross(Eigen::Vector3d(turn * block.frame.x));
  const double angle = std::atan2(-back.x(), back.y());  // from the cell's y axis
  const double turned = angle - std::numbers::pi * std::round(angle / std::numbers::pi);
  if (std::abs(turned) > kRounding_rad) place.turned_rad = turned;
  const robot::Pose to_box = place.in_box(design_to_cell);
  const Eigen::Matrix3d to_axes = to_box.q.toRotationMatrix();
  for (const Eigen::Vector3d& corner : block.corners())
    place.box.extend(Eigen::Vector3d(to_axes * corner + to_box.p));
  place.corner = Eigen::AngleAxisd(place.turned_rad, Eigen::Vector3d::UnitZ()) * place.box.min();
  return place;
}

}  // namespace hotblade::pipeline

#include "pipeline/verify/hanging.hpp"

namespace hotblade::pipeline {

Eigen::Vector3d down_in_plane(const Pose& design_to_cell, const Frame& frame) {
  const Eigen::Vector3d down = design_to_cell.q.conjugate() * -Eigen::Vector3d::UnitZ();
  return {down.dot(frame.x), down.dot(frame.y), down.dot(frame.normal())};
}

robot::SagProfile hanging(const elastica::Elastica& blade, const Frame& frame, const Pose& design_to_cell,
                          const robot::Blade& section) {
  return hanging({&blade, 1}, {&frame, 1}, design_to_cell, section).front();
}

std::vector<robot::SagProfile> hanging(std::span<const elastica::Elastica> blades,
                                       std::span<const Frame> frames, const Pose& design_to_cell,
                                       const robot::Blade& section) {
  std::vector<Eigen::Vector3d> down;
  for (const Frame& frame : frames) down.push_back(down_in_plane(design_to_cell, frame));
  std::vector<robot::SagProfile> sags = sag_profiles(blades, section, down);
  for (robot::SagProfile& sag : sags) {
    if (sag.stable) continue;
    sag.droop_mm.assign(sag.droop_mm.size(), 0);
    sag.twist_rad.assign(sag.twist_rad.size(), 0);
    sag.in_plane_mm.assign(sag.in_plane_mm.size(), Eigen::Vector2d::Zero());
  }
  return sags;
}

Hang hang_of(const robot::SagProfile::Value& sag, const Frame& frame, const Eigen::Vector2d& tangent) {
  const Eigen::Vector3d normal = frame.normal();
  const Eigen::Vector3d left = -tangent.y() * frame.x + tangent.x() * frame.y;
  return {sag.in_plane_mm.x() * frame.x + sag.in_plane_mm.y() * frame.y + sag.droop_mm * normal,
          (normal - sag.twist_rad * left).normalized()};
}

}  // namespace hotblade::pipeline

#include "pipeline/program/clamps.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "elastica/blade/blade_batch.hpp"

namespace hotblade::pipeline {

using elastica::Elastica;

namespace {

Pose clamp_pose(const elastica::CurvePoint& p, const Frame& frame) {
  const Eigen::Vector2d t = p.tangent();
  const Eigen::Vector3d tangent = t.x() * frame.x + t.y() * frame.y;
  const Eigen::Vector3d normal = frame.normal();
  Eigen::Matrix3d r;
  r << tangent, normal.cross(tangent), normal;
  return {frame.point(p.x, p.y), robot::canonical(Eigen::Quaterniond(r).normalized())};
}

}  // namespace

ClampPoses clamps(const Elastica& blade, const Frame& frame) {
  return clamps(std::span(&blade, 1), std::span(&frame, 1)).front();
}

std::vector<ClampPoses> clamps(std::span<const Elastica> blades, std::span<const Frame> frames) {
  std::vector<double> lengths;
  for (const Elastica& e : blades) lengths.push_back(e.length);
  std::vector<elastica::CurvePoint> ends(blades.size());
  elastica::points_at(blades, lengths, ends);
  std::vector<ClampPoses> pairs;
  for (std::size_t i = 0; i < blades.size(); ++i) {
    const Elastica& e = blades[i];
    pairs.push_back({clamp_pose({e.x, e.y, e.theta, e.kappa}, frames[i]), clamp_pose(ends[i], frames[i])});
  }
  return pairs;
}

double clamp_clearance_mm(const ClampPoses& clamps, const Block& block) {
  return std::min(block.distance_mm(clamps.a.p), block.distance_mm(clamps.b.p));
}

}  // namespace hotblade::pipeline

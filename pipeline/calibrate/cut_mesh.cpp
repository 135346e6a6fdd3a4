#include "pipeline/calibrate/cut_mesh.hpp"

#include <Eigen/Geometry>
#include <utility>

namespace hotblade::pipeline {

namespace {

// Weights of the corners at a point of their triangle.
std::array<double, 3> weights_at(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                 const Eigen::Vector3d& c) {
  const Eigen::Vector3d n = (b - a).cross(c - a);
  const double whole = n.squaredNorm();
  if (!(whole > 0)) return {1, 0, 0};
  const double wb = (p - a).cross(c - a).dot(n) / whole, wc = (b - a).cross(p - a).dot(n) / whole;
  return {1 - wb - wc, wb, wc};
}

}  // namespace

CutMesh::CutMesh(SweptSurface surface)
    : surface_(std::move(surface)),
      normals_(surface_.vertices.size(), Eigen::Vector3d::Zero()),
      distance_(surface_.vertices, surface_.triangles) {
  for (const std::array<int, 3>& t : surface_.triangles) {
    const auto corner = [&](std::size_t k) -> const Eigen::Vector3d& {
      return surface_.vertices[static_cast<std::size_t>(t[k])];
    };
    const Eigen::Vector3d by_area = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    for (const int v : t) normals_[static_cast<std::size_t>(v)] += by_area;
  }
  for (Eigen::Vector3d& n : normals_) n.stableNormalize();
}

std::vector<Foot> CutMesh::feet(std::span<const Eigen::Vector3d> points) const {
  // A point above the middle of a surface is seen square to it; what is seen aside by more than this, past
  // the facets' own turn, lies past an edge.
  constexpr double kAsideMm = 0.3, kAsideShare = 0.2;
  const std::vector<gpu::Nearest> nearest = distance_.query(points);
  std::vector<Foot> feet(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    Foot& foot = feet[i];
    foot.point = nearest[i].point;
    foot.corners = surface_.triangles[static_cast<std::size_t>(nearest[i].triangle)];
    const auto corner = [&](std::size_t k) -> const Eigen::Vector3d& {
      return surface_.vertices[static_cast<std::size_t>(foot.corners[k])];
    };
    foot.weights = weights_at(foot.point, corner(0), corner(1), corner(2));
    const Eigen::Vector3d flat = (corner(1) - corner(0)).cross(corner(2) - corner(0)).stableNormalized();
    const Eigen::Vector3d d = points[i] - foot.point;
    const double height = d.dot(flat);
    foot.beside = (d - height * flat).norm() > kAsideMm + kAsideShare * std::abs(height);
    double bulge = 0;
    foot.normal.setZero();
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3d& n = normals_[static_cast<std::size_t>(foot.corners[k])];
      foot.normal += foot.weights[k] * n;
      bulge += 0.5 * foot.weights[k] * (corner(k) - foot.point).dot(n);
    }
    foot.normal.stableNormalize();
    foot.height_mm = height - bulge;
  }
  return feet;
}

std::vector<double> CutMesh::distances(std::span<const Eigen::Vector3d> points) const {
  std::vector<double> distances;
  distances.reserve(points.size());
  for (const gpu::Nearest& nearest : distance_.query(points)) distances.push_back(nearest.distance);
  return distances;
}

}  // namespace hotblade::pipeline

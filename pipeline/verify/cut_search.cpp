#include "pipeline/verify/cut_search.hpp"

#include <tbb/parallel_invoke.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "gpu/backend/stop.hpp"
#include "pipeline/verify/design_border.hpp"

namespace hotblade::pipeline {

CutSearch::CutSearch(const SweptSurface& cut, double near_mm, gpu::Backend backend) : cut_(cut) {
  tbb::parallel_invoke([&] { cells_.emplace(cut.vertices, near_mm); },
                       [&] { search_.emplace(cut.vertices, cut.triangles, backend); });
  gpu::stop_point();
}

double CutSearch::distance_mm(const Eigen::Vector3d& p, const gpu::Nearest& nearest) const {
  const auto& t = cut_.triangles[static_cast<std::size_t>(nearest.triangle)];
  const auto at = [&](std::size_t i) -> const Eigen::Vector3d& {
    return cut_.vertices[static_cast<std::size_t>(t[i])];
  };
  const auto normal = [&](std::size_t i) -> const Eigen::Vector3d& {
    return cut_.normals[static_cast<std::size_t>(t[i])];
  };
  const Eigen::Vector3d ab = at(1) - at(0), ac = at(2) - at(0), twice = ab.cross(ac);
  const double size_sq = twice.squaredNorm();
  if (!(size_sq > 0)) return nearest.distance;
  const Eigen::Vector3d foot = nearest.point - at(0);
  const double b = foot.cross(ac).dot(twice) / size_sq, c = ab.cross(foot).dot(twice) / size_sq;
  const std::array<double, 3> share{1 - b - c, b, c};
  double surface_mm = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t k = (i + 1) % 3;
    surface_mm += 0.5 * share[i] * share[k] * (at(k) - at(i)).dot(normal(k) - normal(i));
  }
  const Eigen::Vector3d up = share[0] * normal(0) + share[1] * normal(1) + share[2] * normal(2);
  const double above = (p - nearest.point).dot(up) < 0 ? -nearest.distance : nearest.distance;
  return std::abs(above - surface_mm);
}

bool CutSearch::on_edge(const gpu::Nearest& nearest) const {
  const auto sides = [&](int v) { return cut_.sides_of_vertex[static_cast<std::size_t>(v)]; };
  return lies_on(
      {cut_.vertices, cut_.triangles}, nearest, [&](int v) { return sides(v) != 0; },
      [&](int corner) {
        const auto& t = cut_.triangles[static_cast<std::size_t>(corner / 3)];
        const auto i = static_cast<std::size_t>(corner % 3);
        return (sides(t[i]) & sides(t[(i + 1) % 3])) != 0;
      });
}

}  // namespace hotblade::pipeline

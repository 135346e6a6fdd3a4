// Which side of the design a point of the cut lies on, and how far.
#include <cmath>
#include <limits>

#include "gpu/mesh/mesh_distance.hpp"
#include "pipeline/preview/scene.hpp"
#include "pipeline/verify/design_border.hpp"

namespace hotblade::pipeline::preview {
namespace {

Eigen::Vector3d area_vector(const surface::TriangleMesh& mesh, std::size_t triangle) {
  const auto& [a, b, c] = mesh.triangles()[triangle];
  const auto at = [&](int i) -> const Eigen::Vector3d& {
    return mesh.vertices()[static_cast<std::size_t>(i)];
  };
  return 0.5 * (at(b) - at(a)).cross(at(c) - at(a));
}

// +1 where face normals point to the waste, -1 where they point into the part. Normals agree over the design,
// so the sum decides also for faces that stand upright.
double waste_sign(const surface::TriangleMesh& design, Keep keep) {
  if (keep == Keep::kBack) return 1;
  if (keep == Keep::kFront) return -1;
  double up = 0;
  for (std::size_t i = 0; i < design.triangles().size(); ++i) up += area_vector(design, i).z();
  return (up >= 0) == (keep != Keep::kAbove) ? 1 : -1;
}

}  // namespace

std::vector<double> signed_deviation_mm(const surface::TriangleMesh& design, Keep keep,
                                        const std::vector<Eigen::Vector3d>& points, double near_mm) {
  const gpu::MeshDistance to_design(design.vertices(), design.triangles());
  const auto nearest = to_design.query(points);
  const auto sides = to_design.sides(points, nearest);
  const double to_waste = waste_sign(design, keep);
  const MeshView mesh{design.vertices(), design.triangles()};
  const DesignBorder border(design);
  std::vector<double> signed_mm(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    double distance = nearest[i].distance;
    if (border.holds(nearest[i])) {
      const Eigen::Vector3d d = points[i] - nearest[i].point, n = facet(mesh, nearest[i].triangle).normal();
      const bool beyond = (d - n.dot(d) * n).norm() > near_mm;
      distance = beyond ? std::numeric_limits<double>::quiet_NaN() : std::abs(n.dot(d));
    }
    signed_mm[i] = to_waste * static_cast<double>(sides[i]) < 0 ? -distance : distance;
  }
  return signed_mm;
}

}  // namespace hotblade::pipeline::preview

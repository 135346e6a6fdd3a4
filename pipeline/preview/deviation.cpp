// Which side of the design a point of the cut lies on, and how far.
#include <cmath>
#include <limits>

#include "pipeline/preview/scene.hpp"
#include "pipeline/verify/design_faces.hpp"

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

std::vector<double> signed_deviation_mm(const surface::TriangleMesh& design, const Program& program,
                                        const std::vector<Eigen::Vector3d>& points,
                                        const std::vector<int>& strip_of_point, double near_mm) {
  const DesignFaces faces(design, program, gpu::Backend::kCpu);
  const auto feet = faces.feet_and_sides(points, [&](std::size_t i) { return strip_of_point[i]; });
  const double to_waste = waste_sign(design, program.design.keep);
  std::vector<double> signed_mm(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const DesignFaces::Foot& foot = feet[i];
    double distance = foot.distance;
    if (foot.on_border) {
      const Eigen::Vector3d d = points[i] - foot.point, &n = foot.normal;
      const bool beyond = (d - n.dot(d) * n).norm() > near_mm;
      distance = beyond ? std::numeric_limits<double>::quiet_NaN() : std::abs(n.dot(d));
    }
    signed_mm[i] = to_waste * static_cast<double>(foot.side) < 0 ? -distance : distance;
  }
  return signed_mm;
}

}  // namespace hotblade::pipeline::preview

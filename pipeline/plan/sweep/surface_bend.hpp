// How a mesh that stands for a smooth surface bends at its vertices.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <utility>
#include <vector>

namespace hotblade::pipeline {

// The second fundamental form of a surface at a point, as a symmetric tensor in space: xx, yy, zz, xy, xz,
// yz, per mm. In single precision: a thousandth of a percent of what it says of a mesh.
struct SurfaceBend {
  using Form = Eigen::Matrix<float, 6, 1>;
  Form form = Form::Zero();

  // Of a unit direction in the tangent plane the normal curvature, positive where the surface rises towards
  // its normal; of a step by its length squared.
  [[nodiscard]] double of(const Eigen::Vector3d& step) const;
};

// From a to b, at 0 to 1.
[[nodiscard]] SurfaceBend between(const SurfaceBend& a, const SurfaceBend& b, double t);

// Returns the forms at the vertices of a mesh with these unit normals and this border, on the mean over a
// circle of about `over_mm`: where the facets are finer, a fold between two of them is no sharper than that.
[[nodiscard]] std::vector<SurfaceBend> surface_bends(std::span<const Eigen::Vector3d> points,
                                                     std::span<const Eigen::Vector3d> normals,
                                                     std::span<const std::array<int, 3>> triangles,
                                                     std::span<const std::pair<int, int>> border,
                                                     double over_mm);

}  // namespace hotblade::pipeline

// How a mesh that stands for a smooth surface bends at its vertices.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <utility>
#include <vector>

namespace hotblade::pipeline {

// The second fundamental form of a surface at a point, as a symmetric tensor in space. In single precision:
// a thousandth of a percent of what it says of a mesh.
class SurfaceBend {
 public:
  SurfaceBend() = default;
  explicit SurfaceBend(const Eigen::Matrix3d& form);

  // Twice what the surface rises off its tangent plane at a step in it, mm; positive towards the normal's
  // side.
  [[nodiscard]] double of(const Eigen::Vector3d& step) const;

  friend SurfaceBend between(const SurfaceBend& a, const SurfaceBend& b, double t);
  friend SurfaceBend operator*(float by, const SurfaceBend& b);
  SurfaceBend& operator+=(const SurfaceBend& other);

 private:
  std::array<float, 6> form_{};  // xx, yy, zz, xy, xz, yz; per mm
};

// Returns the forms at the vertices of a mesh with these unit normals and this border, on the mean over a
// circle of about `over_mm`: where the facets are finer, a fold between two of them is no sharper than that.
[[nodiscard]] std::vector<SurfaceBend> surface_bends(std::span<const Eigen::Vector3d> points,
                                                     std::span<const Eigen::Vector3d> normals,
                                                     std::span<const std::array<int, 3>> triangles,
                                                     std::span<const std::pair<int, int>> border,
                                                     double over_mm);

}  // namespace hotblade::pipeline

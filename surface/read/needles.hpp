// Takes out triangles whose corners lie on one line without opening a gap.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace hotblade::surface {

// Tells whether the triangle has an area that is more than rounding.
[[nodiscard]] bool has_area(std::span<const Eigen::Vector3d> vertices, const std::array<int, 3>& triangle);

// The triangles that have an area, each with the line of the file it came from.
struct WithoutNeedles {
  std::vector<std::array<int, 3>> triangles;
  std::vector<std::uint32_t> line;
  std::size_t removed = 0;
};

// Returns the triangles that have an area, in their order. A triangle without one whose middle corner lies on
// an edge of another is taken out by splitting that one at the corner, since leaving a hole of no width would
// cut every curve that crosses it; at a border it is dropped.
[[nodiscard]] WithoutNeedles remove_needles(std::span<const Eigen::Vector3d> vertices,
                                            std::vector<std::array<int, 3>> triangles,
                                            std::vector<std::uint32_t> line);

}  // namespace hotblade::surface

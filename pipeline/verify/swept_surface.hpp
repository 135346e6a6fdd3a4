// The surface that a program leaves on the kept foam: positions of the hanging blade over the cut, moved to
// the edge of the melted band.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <functional>
#include <vector>

#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

// Returns half of what a blade melts across a surface of this unit normal, mm, at this speed square to
// itself: the width stands along the normal of the plane the blade bends in.
[[nodiscard]] double half_band_mm(const robot::Blade& blade, const Eigen::Vector3d& normal,
                                  const Eigen::Vector3d& plane_normal, double speed_mm_s);

// A surface with what made each of its vertices.
struct SweptSurface {
  std::vector<Eigen::Vector3d> vertices;       // mm, design frame
  std::vector<Eigen::Vector3d> normals;        // unit, towards the waste
  std::vector<std::array<int, 3>> triangles;   // front on the waste side
  std::vector<int> strip_of_vertex;            // index into program.strips
  std::vector<int> pose_of_vertex;             // index into its strip's poses
  std::vector<double> curvature_per_mm;        // of the blade there, without sign
  std::vector<Eigen::Vector3d> plane_normals;  // unit, along the blade's width
  std::vector<double> speeds_mm_s;             // of the blade there, square to itself
  // The sides of its strip's surface that a vertex lies on, a bit each; an edge whose ends share one is the
  // strip's edge.
  std::vector<unsigned char> sides_of_vertex;
};

// Returns a grid over the poses that form the design (those with a foam interval), about `sample_mm` apart
// along and across the blade. Waste is on the left of the blade, A to B, in its frame (docs/program.md).
// Throws std::logic_error when sample_mm is not positive.
[[nodiscard]] SweptSurface swept_surface(const Program& program, double sample_mm = 2.5);

// Calls use(surface) for one run of whole strips after the other, in the program's order: memory. A run ends
// with the strip that brings it to `vertices` or more. Together the runs are swept_surface(). Throws as that.
void each_swept_surface(const Program& program, double sample_mm, std::size_t vertices,
                        const std::function<void(SweptSurface)>& use);

}  // namespace hotblade::pipeline

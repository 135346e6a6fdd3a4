// The surface that a program leaves on the kept foam: positions of the hanging blade over the cut, moved to
// the edge of the melted band.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

// Returns half of what a blade melts across a surface of this unit normal, mm, at this speed square to
// itself: the width stands along the normal of the plane the blade bends in, and `bend_per_mm` is the
// surface's across it (robot::over_width_mm).
[[nodiscard]] double half_band_mm(const robot::Blade& blade, const Eigen::Vector3d& normal,
                                  const Eigen::Vector3d& plane_normal, double speed_mm_s, double bend_per_mm);

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
  std::vector<double> areas_mm2;     // of the surface that a vertex stands for
  std::vector<double> bends_per_mm;  // the most that the surface curves there in any direction
  std::vector<double>
      width_bends_per_mm;             // of what is left, over the blade's width, as half_band_mm() takes it
  std::vector<double> half_bands_mm;  // from the blade's middle line to a vertex
};

// How far the points of a grid lie apart.
struct GridSteps {
  double finest_mm = 2.5;  // > 0
  double widest_mm = 2.5;  // where the surface is straight enough; no less than the finest
  double chord_mm = 0;     // a step that is wider than the finest leaves no place farther off its chord
  // Of more vertices than this all steps are wider, and chords with them, until they are fewer: memory, 600
  // bytes a vertex with a search tree over the facets.
  std::size_t most_vertices = std::size_t{1} << 18;
  // The band's edge is where the width of hot poses about a place passes (width_pass.hpp): of all of them, as
  // of a motion that was executed, or of as many as tell the edge of a planned one, which is smooth. Where
  // there are none, slope and bend of the cut put it.
  bool by_every_pose = false;
};

// Returns grids over the poses that form the design: hot ones with a foam interval, a grid of each stretch of
// them. Where a strip has others between, its surface has a gap, and both its sides are edges. Rows follow
// the poses: each is as far from the one before as its steps allow, by the chord of five points of every pose
// between. Columns are even along the blade, as far apart as its curvature allows. Waste is on the left of
// the blade, A to B, in its frame (docs/program.md). Throws std::logic_error for steps that are not positive.
[[nodiscard]] SweptSurface swept_surface(const Program& program, const GridSteps& steps);
// The same about `sample_mm` apart everywhere, however many vertices that takes.
[[nodiscard]] SweptSurface swept_surface(const Program& program, double sample_mm = 2.5);

}  // namespace hotblade::pipeline

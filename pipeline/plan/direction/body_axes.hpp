// A design's own axes, which turn with it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "surface/read/design_surface.hpp"

namespace hotblade::pipeline {

struct BodyAxes {
  Eigen::Vector3d centre;               // of the area
  std::array<Eigen::Vector3d, 3> axes;  // principal axes of the area, widest first, right-handed
};

// Returns the axes of a design; those whose extents are equal to a percent are set by the vertex farthest
// from the third axis.
[[nodiscard]] BodyAxes body_axes(const surface::TriangleMesh& mesh);

// Returns one of n and -n, as the design says: the first of its odd moments about the centre that does not
// vanish is positive, the third along n, then those across and upwards that change with the sense. A design
// without any is the same after half a turn; there the one whose first component above half the largest is
// positive.
[[nodiscard]] Eigen::Vector3d with_sense(const surface::TriangleMesh& mesh, const BodyAxes& body,
                                         const Eigen::Vector3d& n);
// Returns the same of many unit vectors.
[[nodiscard]] std::vector<Eigen::Vector3d> with_senses(const surface::TriangleMesh& mesh,
                                                       const BodyAxes& body,
                                                       std::span<const Eigen::Vector3d> directions);

// Returns unit vectors over the hemisphere, at most 30 degrees from the nearest: every 15 degrees in the
// plane of the two widest axes, every 45 degrees half-way up, and the narrowest axis.
[[nodiscard]] std::vector<Eigen::Vector3d> hemisphere(const BodyAxes& body);

// Returns directions square to the longest runs of equal heading among the border's edges, seen along the
// narrowest axis: planes across them hold a straight border whole. At most two, the longer run first, each
// with a tenth of the border's length at least.
[[nodiscard]] std::vector<Eigen::Vector3d> along_borders(const surface::TriangleMesh& mesh,
                                                         const BodyAxes& body);

// Returns the direction whose planes the surface is the least steep to: |sin slope| squared, over the area,
// is smallest. Returns nothing where another direction is as good, as on a sphere or a plane.
[[nodiscard]] std::optional<Eigen::Vector3d> least_steep(const surface::TriangleMesh& mesh);

}  // namespace hotblade::pipeline

// How high above a design a blade stands over its whole width, which lies square to the plane that it bends
// in: where the design bends, another place of the width than its middle may be the one nearest to it.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

#include "pipeline/verify/design_faces.hpp"

namespace hotblade::pipeline {

// A point of the blade's middle line.
struct WidthPlace {
  Eigen::Vector3d point;   // mm, design frame
  Eigen::Vector3d across;  // unit, along the width
  Eigen::Vector3d waste;   // towards the waste of the design
};

// What counts of places of the width past the border of a face.
enum class PastBorder {
  kNothing,  // there is no design
  kPlane,    // their heights above the plane of the facet there, with which the design goes on
};

// Returns for each point by how much its width is above the face of its strip where that is least of nine
// places, mm: along the facets' normals, negative on the kept side. It is infinite where the point itself is
// farther than `edge_mm` past the border. `strip_of(i)` is the strip of at[i].
[[nodiscard]] std::vector<double> width_heights(const DesignFaces& design, std::span<const WidthPlace> at,
                                                double width_mm, PastBorder past,
                                                const std::function<int(std::size_t)>& strip_of);

}  // namespace hotblade::pipeline

// Reads PLY, as text or binary of either byte order.
#pragma once

#include <string>
#include <string_view>

#include "surface/read/polygons.hpp"

namespace hotblade::surface {

// Returns the polygons of a PLY: x, y and z of element `vertex` as float or double, and of element `face` the
// list `vertex_indices` or `vertex_index` of any integer type. Other properties and elements are passed over
// by their size. `name` is the file's in messages, `limit` the largest coordinate taken, in the file's units.
// Throws MeshError, with the line, or the element's number and its byte, for the first thing that is not
// usable.
[[nodiscard]] Polygons parse_ply(std::string_view bytes, const std::string& name, double limit);

// Returns the vertices of a PLY alone, as of a scan: it needs no faces, and those that it has are passed
// over. Throws as parse_ply does.
[[nodiscard]] std::vector<Eigen::Vector3d> parse_ply_points(std::string_view bytes, const std::string& name,
                                                            double limit);

}  // namespace hotblade::surface

// Reads the text of an OBJ file, checked statement by statement: positions and polygons as written, nothing
// repaired.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "surface/read/polygons.hpp"

namespace hotblade::surface {

// Returns what OBJ text holds. `name` is the file's name in messages, `limit` the largest coordinate taken,
// in the file's units. Text whose lines are plain is read in parts of about `part_bytes`, side by side, with
// the same result. Throws MeshError for the first line that is not usable.
[[nodiscard]] Polygons parse_obj(std::string_view text, const std::string& name, double limit,
                                 std::size_t part_bytes = std::size_t{1} << 20);

}  // namespace hotblade::surface

// Reads STL, as text or binary.
#pragma once

#include <string>
#include <string_view>

#include "surface/read/polygons.hpp"

namespace hotblade::surface {

// Returns whether the bytes are a binary STL: 80 bytes, a count of facets and 50 bytes for each of them. The
// word `solid` does not tell, binary files begin with it too.
[[nodiscard]] bool is_binary_stl(std::string_view bytes);

// Returns the facets of an STL, three corners of its own each. A solid of a text is a group of its name. What
// the facets' normals say is compared with the way round that their corners go, and not used; attribute
// bytes are counted. `name` is the file's in messages, `limit` the largest coordinate taken, in the file's
// units. Throws MeshError, with the line or the number of the facet and its byte, for the first thing that is
// not usable.
[[nodiscard]] Polygons parse_stl(std::string_view bytes, const std::string& name, double limit);

}  // namespace hotblade::surface

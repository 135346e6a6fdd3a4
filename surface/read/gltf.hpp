// Reads glTF 2.0, as JSON with its buffers beside it or inside, and as GLB.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "surface/read/polygons.hpp"

namespace hotblade::surface {

// Returns the triangles of all nodes of the file's scene, in metres with y up, each where its node's and
// their parents' matrices put it. A face's group is its node, and in it its mesh. Buffers are the file's own,
// in it as base64, or files in its folder, whose bytes `read_file` gives and Polygons::beside keeps. `limit`
// is the largest coordinate taken, in metres. Throws MeshError, with the JSON's path or the byte, for the
// first thing that is not usable: Draco and meshopt compression, quantized and sparse data among them.
[[nodiscard]] Polygons parse_gltf(std::string_view bytes, const std::filesystem::path& file, double limit,
                                  const std::function<std::string(const std::filesystem::path&)>& read_file);

}  // namespace hotblade::surface

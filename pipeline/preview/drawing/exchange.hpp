// A scene as a file for other programs: glTF for viewers and CAD, VTK multiblock for ParaView.
#pragma once

#include <filesystem>
#include <string>

#include "pipeline/preview/drawing/draw.hpp"
#include "pipeline/preview/scene.hpp"

namespace hotblade::pipeline::preview {

// The text of a .gltf file with everything in it: metres, y up (x, z, -y of the design frame), the vertices
// have the picture's colours. It needs neither display nor EGL.
[[nodiscard]] std::string gltf_of(const Scene& scene);
// The same with the scene's meshes at hand.
[[nodiscard]] std::string gltf_of(const Scene& scene, const SceneMeshes& meshes);

// Writes FILE.vtm and the directory FILE beside it that holds its blocks: design, cut (point data
// deviation_mm or what it is coloured by, and strip), ribs, blades, stock, and bodies of a cell by their
// names; mm, design frame. Throws Error (kFile) when something is there without `force` or cannot be written.
void write_vtm(const Scene& scene, const std::filesystem::path& file, bool force);

}  // namespace hotblade::pipeline::preview

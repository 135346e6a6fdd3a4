// From checked OBJ text to an oriented triangle mesh whose vertices each have one fan of faces.
#pragma once

#include <vector>

#include "surface/read/design_surface.hpp"
#include "surface/read/obj_text.hpp"

namespace hotblade::surface {

// A mesh with what is known about its connectivity; vertex numbers in messages are those of the OBJ, from 1.
struct RepairedMesh {
  TriangleMesh mesh;
  std::vector<std::uint32_t> line;  // per triangle: of the OBJ, where its face starts
  std::size_t edges = 0;            // distinct
};

// Merges vertices of exactly equal coordinates, cuts polygons into triangles, takes the faces that
// options.facing asks for, drops degenerate and duplicate faces and unused vertices, turns faces to agree and
// parts sheets that touch in a point only. No vertex is moved but those that options.stitch_mm joins. Writes
// what it found and did to `health`: counts, repairs, warnings and blockers. `positions` are the design's, in
// mm. Throws MeshError, with `name` in the message, when no face with an area is left.
[[nodiscard]] RepairedMesh repair_mesh(const ObjText& obj, std::vector<Eigen::Vector3d> positions,
                                       const ReadOptions& options, const std::string& name, Health& health);

}  // namespace hotblade::surface

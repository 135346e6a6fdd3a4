// From a file's checked polygons to an oriented triangle mesh whose vertices each have one fan of faces.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "surface/read/design_surface.hpp"
#include "surface/read/polygons.hpp"

namespace hotblade::surface {

struct RepairedMesh {
  TriangleMesh mesh;
  std::vector<std::uint32_t> place;  // per triangle: its face's, in the file
};

// Returns the half-edge mesh of the file's faces: it merges vertices of exactly equal coordinates, cuts
// polygons into triangles, takes the faces that options.facing asks for, drops degenerate and duplicate faces
// and unused vertices, turns faces to agree and parts sheets that touch in a point only. No vertex is moved
// but those that options.stitch_mm joins. What it found and did it writes to `health`: counts, repairs,
// warnings and blockers; vertex numbers in them are those of the file, from 1. `positions` are the design's,
// in mm. Throws MeshError, with `name` in the message, when no face with an area is left.
[[nodiscard]] RepairedMesh repair_mesh(Polygons polygons, std::vector<Eigen::Vector3d> positions,
                                       const ReadOptions& options, const std::string& name, Health& health);

}  // namespace hotblade::surface

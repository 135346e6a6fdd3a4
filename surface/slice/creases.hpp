// Parts a design at its creases into faces that are smooth, as folded plates, hipped roofs and crossing
// vaults have them.
#pragma once

#include <vector>

#include "surface/read/triangle_mesh.hpp"

namespace hotblade::surface {

// When an edge is a crease.
struct CreaseLimits {
  // What a cut may be off by. A mesh stands for a smooth surface where its chords are within some of these.
  double tolerance_mm = 1;
  // The smallest radius that a cut can have: it rounds a fold of less within the tolerance.
  double least_radius_mm = 100;
  // Folds that such a radius rounds are creases too where they stand alone.
  bool shallow = false;
};

// Returns the corners, ascending and one for each edge, whose edge is a crease: both faces keep their
// directions for so far to its sides that a smooth surface through them would be off by more than four
// tolerances, and no rounding by the least radius stays within one; or, with `shallow`, it stands alone: no
// edge within 400 mm to its sides folds by a quarter of it. A fold that goes on at the next edges, as a
// coarse arc's, is none. Throws std::logic_error where a limit is not above 0.
[[nodiscard]] std::vector<int> creases(const TriangleMesh& mesh, const CreaseLimits& limits);

// Returns the faces that creases part the mesh into, those led on that fade towards others or a border (along
// the mesh's edges, as far as it folds there and their own length more), each with the vertices and triangles
// of its own in their order, in the order of their first triangles; the mesh alone where creases part
// nothing. `face_of_triangle`, where it is given, is set to the face of each triangle.
[[nodiscard]] std::vector<TriangleMesh> smooth_faces(const TriangleMesh& mesh, const CreaseLimits& limits,
                                                     std::vector<int>* face_of_triangle = nullptr);

}  // namespace hotblade::surface

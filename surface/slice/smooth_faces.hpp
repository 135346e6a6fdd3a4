// Parts a design at its creases into faces that are smooth.
#pragma once

#include <vector>

#include "surface/slice/creases.hpp"

namespace hotblade::surface {

// Returns the faces that creases part the mesh into, those led on that fade towards others or a border (along
// the mesh's edges, as far as it folds there and their own length more), each with the vertices and triangles
// of its own in their order, in the order of their first triangles; the mesh alone where creases part
// nothing. Chamfers and fillets that are creases are left out, of no face, and so are slivers that fold away
// at a border and end there within a tolerance. `face_of_triangle`, where it is given, is set to the
// face of each triangle, -1 where it is of none.
[[nodiscard]] std::vector<TriangleMesh> smooth_faces(const TriangleMesh& mesh, const CreaseLimits& limits,
                                                     std::vector<int>* face_of_triangle = nullptr);

// Returns for each triangle the number of the connected part that it is of, from 0 in the order of their
// first triangles.
[[nodiscard]] std::vector<int> connected_parts(const TriangleMesh& mesh);

// Returns the mesh of some of its triangles, in their order, with the vertices of these in theirs.
[[nodiscard]] TriangleMesh mesh_of(const TriangleMesh& mesh, const std::vector<int>& triangles);

}  // namespace hotblade::surface

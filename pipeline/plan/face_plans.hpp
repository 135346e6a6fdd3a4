// The smooth faces of a design as designs of their own, and their plans as one.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "pipeline/plan/sweep/sweep_search.hpp"
#include "surface/read/design_surface.hpp"
#include "surface/read/triangle_mesh.hpp"

namespace hotblade::pipeline {

// Returns a face of a design, in its units.
[[nodiscard]] surface::DesignSurface face_of(const surface::DesignSurface& design,
                                             const surface::TriangleMesh& mesh);

[[nodiscard]] double area_mm2(const surface::TriangleMesh& mesh);

// Plans faces by their index, the largest first; `plan` says whether there are any strips. Those that are
// small beside one that there are none for are left out: the design cannot be cut whatever they are.
void largest_first(const std::vector<surface::TriangleMesh>& faces,
                   const std::function<bool(std::size_t)>& plan);

// Parts of a design that lie farther apart are planned one by one: strips that go from one to the other cut
// foam in between for nothing. Nearer ones are one surface with a joint.
inline constexpr double kTogetherMm = 60;

// Returns the connected parts of a mesh, those nearer to each other than kTogetherMm as one, in the order of
// their first triangles. Distances are those of vertices from the other part.
[[nodiscard]] std::vector<surface::TriangleMesh> parts_apart(const surface::TriangleMesh& mesh);

// Tells whether any two of these are near enough to each other for the largest block to hold some of both.
[[nodiscard]] bool may_share_a_block(const std::vector<surface::TriangleMesh>& parts,
                                     const StockSettings& stock);

// Puts a face's plan behind those of the faces before, its parts named on from theirs.
void append(SweptPlan& whole, SweptPlan face);

}  // namespace hotblade::pipeline

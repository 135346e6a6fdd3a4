// Follows the curves in which the planes of a family cut a half-edge mesh, and finds which of them the
// surface joins between planes.
#pragma once

#include <span>
#include <vector>

#include "surface/slice/slice.hpp"

namespace hotblade::surface {

// A curve with the two pieces of surface it bounds: below its plane and above it. A piece of surface between
// two neighbouring planes has one number, so curves of plane k and k + 1 are joined by the surface between
// exactly when the lower one's `surface_above` is the upper one's `surface_below`.
struct MarchedPiece {
  SectionPiece piece;
  int surface_below = 0, surface_above = 0;
};

// Returns one list of curves a plane, sorted by their first points; offsets must rise strictly, the mesh must
// have triangles that agree. Every curve runs so that it, the plane's normal and the surface normal form a
// right-handed triple, which gives neighbouring curves the same sense. Loops start at their smallest point
// (x, then y, then z). A vertex on a plane counts as above it, everywhere alike: that is a shift of the plane
// by less than any length, so curves never branch and touch no vertex twice.
[[nodiscard]] std::vector<std::vector<MarchedPiece>> march_sections(const TriangleMesh& mesh,
                                                                    const PlaneFamily& planes,
                                                                    std::span<const double> offsets_mm);

// Returns unit normals at the vertices, weighted so that they are exact on a sphere (Max 1999, "Weights for
// computing vertex normals from facet normals"); zero where the faces cancel.
[[nodiscard]] std::vector<Eigen::Vector3d> vertex_normals(const TriangleMesh& mesh);

}  // namespace hotblade::surface

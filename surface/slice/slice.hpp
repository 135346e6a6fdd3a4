// Cuts the design into sections by parallel planes or by a fan of half planes about an axis.
//
// Planes are told apart by their offset (surface/slice/plane_family.hpp). A section piece is a polyline on
// the mesh. Curves are followed from face to face with vertices on a plane taken as above it, everywhere
// alike: that is a shift of the plane by less than any length, so curves never branch and touch no vertex
// twice.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "surface/read/design_surface.hpp"
#include "surface/slice/plane_family.hpp"

namespace hotblade::surface {

struct SectionPiece {
  std::vector<Eigen::Vector3d> points;  // mm, on the plane to rounding; no two consecutive equal; at least 2
  bool closed = false;                  // a loop; the first point is not repeated
  double length_mm = 0;
};

struct Section {
  double offset_mm = 0;
  std::vector<SectionPiece> pieces;  // by their first points
};

// Returns a section for each offset; offsets rise strictly, the mesh has triangles. Every piece runs so that
// it, the plane's normal and the surface normal form a right-handed triple, which gives neighbouring pieces
// the same sense. Loops start at their smallest point (x, then y, then z). A mesh that goes all the way round
// a fan's axis is cut open first (surface/slice/ring.hpp).
[[nodiscard]] std::vector<Section> slice(const TriangleMesh& mesh, const PlaneFamily& planes,
                                         std::span<const double> offsets_mm);

}  // namespace hotblade::surface

// Cuts the design into sections by parallel planes or by a fan of half planes about an axis, and links their
// pieces from plane to plane into strips of ribs.
//
// Planes are told apart by their offset (surface/slice/plane_family.hpp). A section piece is a polyline on
// the mesh. Pieces of neighbouring planes that the surface between them joins one to one, or that lie beside
// each other across a seam, form chains in one sense; where the surface branches, chains end. Curves are
// followed from face to face with vertices on a plane taken as above it, so each point knows its mesh edge
// and no curve branches.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "surface/read/design_surface.hpp"
#include "surface/slice/plane_family.hpp"

namespace hotblade::surface {

// One point of a section with what the later stages need of the design there.
struct SectionPoint {
  Eigen::Vector3d p;       // mm, design frame, on the plane to rounding
  Eigen::Vector3d normal;  // unit, interpolated between the design's vertices, on the face's front side
};

struct SectionPiece {
  std::vector<SectionPoint> points;  // no two consecutive points equal; at least 2
  bool closed = false;               // a loop; the first point is not repeated
  double length_mm = 0;
};

struct Section {
  double offset_mm = 0;
  std::vector<SectionPiece> pieces;
};

// One rib's place in the graph: section index and piece index.
struct RibRef {
  int section = 0, piece = 0;
};

// A run of pieces through consecutive sections, all running in the same sense: a strip before it is split.
struct Chain {
  std::vector<RibRef> ribs;
};

// Chains that the surface joins where they begin or end, side by side in their sections with gaps between
// them: a window, a notch, two arms. One blade could cut them together, through the waste in the gaps.
struct Bridge {
  std::vector<int> chains;                // indices, ascending
  std::vector<std::vector<RibRef>> ribs;  // of consecutive sections: the pieces in order along the section
};

struct RibGraph {
  PlaneFamily planes;
  std::vector<Section> sections;
  std::vector<Chain> chains;          // disjoint; ordered by first section, then position along the section
  std::vector<Bridge> bridges;        // disjoint; ordered by first chain
  std::vector<std::string> warnings;  // pieces dropped because they were too short, with place and length
};

struct SliceOptions {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();  // of parallel planes
  std::optional<FanAxis> fan;                         // half planes about this axis instead
  // Distances between the planes of a fan are measured at the design's outermost point.
  double spacing_mm = 20;      // largest distance between planes
  double end_inset_mm = 0.05;  // the first and last plane lie this far inside the design's extent
  double min_piece_mm = 5;     // shorter pieces are dropped, with a warning
  // But not the only piece of a section where the design ends in a tip, nor the last one of a chain that
  // ends on the way.
  bool keep_tips = false;
};

// Returns the design's sections and the chains of their pieces. Planes are spread evenly from the first to
// the last. Where a border runs so nearly along the first or the last that it leaves only a part of a
// section, the section a little further in is taken and moved along the surface to that plane, so that its
// ribs say what the strip's end needs (surface/slice/end_planes.hpp). Where chains end or begin on the way,
// planes are added as far below and above the place as the first and last plane lie inside the design. Closed
// loops are cut open into two open pieces where the loop is extreme across its longest extent, at the same
// side in every section. Throws std::logic_error when options are not finite or the design's health has
// blockers, and FanError when the fan's axis and the design do not go together.
[[nodiscard]] RibGraph slice(const DesignSurface& design, const SliceOptions& options);

}  // namespace hotblade::surface

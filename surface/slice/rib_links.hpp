// Links pieces of neighbouring sections that continue each other, and cuts loops open so that they can.
#pragma once

#include <vector>

#include "surface/slice/section_march.hpp"

namespace hotblade::surface {

// A piece in its section, with the piece that continues it in the next section and the one it continues.
struct RibNode {
  static constexpr int kNone = -1;
  int section = 0;
  SectionPiece piece;
  int next = kNone, previous = kNone;
  // As in MarchedPiece; kNone of a loop's halves.
  int surface_below = kNone, surface_above = kNone;
};

// Returns the pieces, section by section, linked where they are each other's best match in neighbouring
// sections, open to open and loop to loop. Where the surface joins exactly one piece to exactly one, they
// link if either one is covered by the other for most of its length; where it branches, only if both are
// covered nearly whole, so a Y ends its chains and a sliver does not. Pieces on sheets that are not joined
// link when they are as near as joined ones would be. `spacing_mm` is the distance of the planes.
[[nodiscard]] std::vector<RibNode> link_pieces(std::vector<std::vector<MarchedPiece>> sections,
                                               double spacing_mm);

// Replaces every loop by two open pieces. The loops of one chain are cut where they are extreme along one
// direction, that of the largest extent of them all, which the planes carry along; both pieces hold both cut
// points. `u`, `v` span the plane at offset 0; offsets are the sections'.
void cut_loops_open(std::vector<RibNode>& nodes, const PlaneFamily& planes, std::span<const double> offsets,
                    const Eigen::Vector3d& u, const Eigen::Vector3d& v);

}  // namespace hotblade::surface

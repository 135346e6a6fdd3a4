// The least lambda-residual at every place of a fine lattice of end directions, for generate_valleys.
#pragma once

#include <array>
#include <vector>

#include "elastica/projection/project_polish.hpp"
#include "elastica/projection/project_valleys.hpp"

namespace hotblade::elastica {

// Places along one side of a cell of the table; they lie off its borders by half their distance.
inline constexpr int kCellPlaces = 10;
inline constexpr int kPlaces = kValleyNodes * kCellPlaces;

// The direction with number i of `count` even ones, off the chord by half a step, rad.
[[nodiscard]] double lattice_angle(int i, int count);
// The number in [0, count) that stands for the same direction as i.
[[nodiscard]] int around(int i, int count);

// A node of a lattice of `count` by `count` directions, and its images under the symmetries of the problem:
// both angles change sign; or they swap with a sign while the edges swap.
struct Node {
  int i = 0, j = 0;
  bool operator<(const Node& o) const { return std::pair(i, j) < std::pair(o.i, o.j); }
};
[[nodiscard]] Node mirrored(Node n, int count);
[[nodiscard]] Node reversed(Node n, int count);
// Whether the node is the one that stands for its orbit under the symmetries.
[[nodiscard]] bool leads(Node n, int count);

// The best minimum known at a place; e above 1 says that there is none. The second derivatives are those of
// e2, as in Descent.
struct Floor {
  double u = 0, v = 0, e = 2, huu = 0, huv = 0, hvv = 0;
};

// The floors of one branch (not kBest), by place: [i * kPlaces + j].
[[nodiscard]] std::vector<Floor> lattice_floors(WantedBranch branch);

}  // namespace hotblade::elastica

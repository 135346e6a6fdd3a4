// Proves of many faces at once that no two of them cross.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "surface/read/triangle_mesh.hpp"

namespace hotblade::surface {

// Faces that are all seen from their front along an axis lie in a single layer where no line along the axis
// passes through the inside of two of them; then no two cross. How many such a line passes through is the
// winding number of the set's border about it (the border of the sum is the sum of the borders), so the
// border alone has to be looked at: some hundred edges of thousands of faces. Volino and Magnenat-Thalmann
// 1994 ask the same of a patch in one piece; here a set may fall into pieces and have holes. All is told in
// numbers that rounding cannot have turned (Shewchuk 1997, the filter of orient2d).
class SingleLayers {
 public:
  // Takes a mesh that is a plain surface (half_edges.hpp) and its faces, each once, in an order in which
  // those near each other follow each other. Both have to outlive it. Throws std::logic_error for another
  // mesh.
  SingleLayers(const TriangleMesh& mesh, std::span<const int> order);

  // Tells whether it is proved that the `count` faces from place `first` of the order on lie in a single
  // layer along one of the axes. False: not known.
  [[nodiscard]] bool holds(std::size_t first, std::size_t count) const;

 private:
  // Returns the axes, as bits, that all of some faces are surely seen along.
  [[nodiscard]] unsigned fronts(std::size_t first, std::size_t count) const;
  // Returns the axis of `axes` that most of the area of some of the faces is seen along.
  [[nodiscard]] int widest(std::size_t first, std::size_t count, unsigned axes) const;

  const TriangleMesh& mesh_;
  std::span<const int> order_;
  std::vector<int> place_;  // of each face
};

}  // namespace hotblade::surface

// Finds faces of a mesh that pass through each other or lie on each other.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <functional>
#include <string>

#include "surface/read/design_surface.hpp"

namespace hotblade::surface {

// Two faces cross where their common part runs through the inside of both, or is an area. Faces that touch
// along an edge or in a corner, joined or not, do not.
struct SelfCrossings {
  std::size_t pairs = 0;
  // The pair of the lowest numbers, and where it crosses, in mm. Meaningless when there is none.
  std::array<int, 2> faces{-1, -1};
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  // Adds `more` pairs, of which `pair` has the lowest numbers.
  void count(const std::array<int, 2>& pair, std::size_t more) {
    if (pairs == 0 || pair < faces) faces = pair;
    pairs += more;
  }
};

// Returns how many pairs of faces cross, and where the first does. Of a smooth surface most faces lie in
// single layers and are not compared (single_layers.hpp); of the others boxes tell most pairs apart
// (near_faces.hpp), a plane between the faces in plain numbers the next, and exact predicates (CGAL) the
// rest. `watch` is called before each of the search's portions, on its threads; what it throws ends the
// search.
[[nodiscard]] SelfCrossings find_self_crossings(const TriangleMesh& mesh,
                                                const std::function<void()>& watch = {});

// Returns what to tell about a design's crossing faces, with place and lines of the file; an empty text when
// there are none. `watch` as above.
[[nodiscard]] std::string self_crossings_text(const DesignSurface& design,
                                              const std::function<void()>& watch = {});

}  // namespace hotblade::surface

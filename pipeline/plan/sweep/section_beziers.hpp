// What the cubic Beziers along a design's sections say before any fit: how far elastica would be from
// sections by these planes, split along the ribs into so many pieces.
//
// A Bezier's lambda-residual e is the share of its curvature, as a root of mean squares over its length L,
// that no elastica has. What no elastica has waves about the best one a time and a half or more, so that it
// stands for e kappa_rms (L / 3 pi)^2 of distance at most; to it comes the Bezier's own distance from the
// section.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "surface/slice/plane_family.hpp"

namespace hotblade::pipeline {

// Planes, and into how many pieces along the ribs their sections are split.
struct SectionQuestion {
  std::size_t planes = 0, pieces = 1;
};

// Returns for each question what three in four pieces of the sections keep below, in mm: a curve near a cusp
// says nothing of the others. Infinite where there are no sections of a length that is worth a rib. All
// curves are asked in one batch. Throws std::logic_error where a question names no planes.
[[nodiscard]] std::vector<double> elastica_misses_mm(const surface::TriangleMesh& mesh,
                                                     std::span<const surface::PlaneFamily> planes,
                                                     std::span<const SectionQuestion> questions);

}  // namespace hotblade::pipeline

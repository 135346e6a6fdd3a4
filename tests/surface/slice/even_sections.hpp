// Sections of a test's mesh at even distances.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "surface/slice/slice.hpp"
#include "tests/surface/meshes.hpp"

namespace hotblade::surface {

struct EvenSections {
  PlaneFamily planes;
  std::vector<Section> sections;
};

// From `inset_mm` inside the first end of the mesh to as far inside the last one, `spacing_mm` apart at most.
inline EvenSections even_sections(const TriangleMesh& mesh, const PlaneFamily& planes, double spacing_mm = 20,
                                  double inset_mm = 0.05) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Eigen::Vector3d& p : mesh.vertices()) {
    low = std::min(low, planes.offset(p));
    high = std::max(high, planes.offset(p));
  }
  if (planes.closed()) high = -(low = -std::acos(-1.0) * planes.radius_mm());
  low += inset_mm;
  high -= inset_mm;
  constexpr double kRounding = 1e-9;
  const double steps = std::max(1.0, std::ceil((high - low) / spacing_mm - kRounding));
  std::vector<double> offsets;
  for (int i = 0; i <= static_cast<int>(steps); ++i) offsets.push_back(low + (high - low) * i / steps);
  return {planes, slice(mesh, planes, offsets)};
}

inline EvenSections even_sections(const TriangleSoup& mesh, const Eigen::Vector3d& normal,
                                  double spacing_mm = 20, double inset_mm = 0.05) {
  const TriangleMesh whole = from_mesh(mesh).mesh;
  return even_sections(whole, parallel_about(whole, normal.normalized()), spacing_mm, inset_mm);
}

inline EvenSections even_sections(const TriangleSoup& mesh, const FanAxis& axis, double spacing_mm = 20,
                                  double inset_mm = 0.05) {
  const TriangleMesh whole = from_mesh(mesh).mesh;
  return even_sections(whole, fan_about(whole, axis), spacing_mm, inset_mm);
}

// Lengths of a section's pieces, shortest first.
inline std::vector<double> lengths(const Section& section) {
  std::vector<double> all;
  for (const SectionPiece& piece : section.pieces) all.push_back(piece.length_mm);
  std::sort(all.begin(), all.end());
  return all;
}

}  // namespace hotblade::surface

// Finds the nearest points of a cut and tells how far the surface that its facets stand for is.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>

#include "gpu/mesh/mesh_distance.hpp"
#include "pipeline/verify/near_cells.hpp"
#include "pipeline/verify/swept_surface.hpp"

namespace hotblade::pipeline {

// Refers to the cut it is made of.
class CutSearch {
 public:
  // `near_mm` as of NearCells.
  CutSearch(const SweptSurface& cut, double near_mm, gpu::Backend backend);
  CutSearch(const CutSearch&) = delete;
  CutSearch& operator=(const CutSearch&) = delete;

  [[nodiscard]] const NearCells& cells() const { return *cells_; }
  [[nodiscard]] const gpu::MeshDistance& search() const { return *search_; }

  [[nodiscard]] std::size_t vertex_of(int triangle) const {
    return static_cast<std::size_t>(cut_.triangles[static_cast<std::size_t>(triangle)][0]);
  }
  [[nodiscard]] int strip_of(int triangle) const { return cut_.strip_of_vertex[vertex_of(triangle)]; }

  // Distance of a point from the surface that the facets stand for: its height above the nearest facet less
  // that of the surface, which bends between the corners as their normals turn (a quadratic patch).
  [[nodiscard]] double distance_mm(const Eigen::Vector3d& p, const gpu::Nearest& nearest) const;

  // Does the nearest point lie on the strips' edge?
  [[nodiscard]] bool on_edge(const gpu::Nearest& nearest) const;

 private:
  const SweptSurface& cut_;
  std::optional<NearCells> cells_;
  std::optional<gpu::MeshDistance> search_;
};

}  // namespace hotblade::pipeline

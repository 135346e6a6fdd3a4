// The faces of a design in cells that are divided where a question needs it: each cell is a triangle between
// three points of a face. It is cut in two at the middle of its longest edge, a needle across its long edges
// into as many pieces as it is too long: there are as many cells as a needle is long, not more and more
// beside each other.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/verify/mesh_view.hpp"

namespace hotblade::pipeline {

class DesignCells {
 public:
  // Begins with one cell a face, its corners the mesh's vertices.
  explicit DesignCells(const MeshView& mesh);

  struct Cell {
    std::array<std::uint32_t, 3> corners{};  // indices into points()
  };

  // All points there are: a point keeps its index.
  [[nodiscard]] const std::vector<Eigen::Vector3d>& points() const { return points_; }
  // Those that are neither divided nor settled.
  [[nodiscard]] const std::vector<Cell>& cells() const { return cells_; }

  [[nodiscard]] double area_mm2(const Cell& cell) const;
  [[nodiscard]] double longest_edge_mm(const Cell& cell) const;

  // How a cell is divided: a needle at its shortest edge, others in two at their longest.
  struct Cut {
    std::uint32_t pieces = 0;  // 0: it is not
    std::uint8_t edge = 0;
    bool needle = false;
  };
  // Towards that its longest edge is no longer than wanted, mm, > 0.
  [[nodiscard]] Cut cut_to(const Cell& cell, double wanted_mm) const;

  // Divides the cells, and takes those that are not away: they are settled. One cut a cell
  // (std::logic_error). A place on an edge that two of the cells share becomes one point. Returns the cells
  // that were; views of them stay valid meanwhile.
  std::vector<Cell> divide(std::span<const Cut> cuts);

 private:
  // The longest edge from corners[edge] to the next; of equal ones the one between the lowest indices, so
  // that two cells at an edge choose alike.
  [[nodiscard]] std::size_t longest_edge(const Cell& cell) const;
  [[nodiscard]] double edge_mm(const Cell& cell, std::size_t edge) const;

  // Points of one division, by the edge and the place on it.
  class Places;
  void halve(const Cell& cell, std::size_t longest, Places& places, std::vector<Cell>& parts);
  void slice(const Cell& cell, std::size_t shortest, std::size_t pieces, Places& places,
             std::vector<Cell>& parts);

  std::vector<Eigen::Vector3d> points_;
  std::vector<Cell> cells_;
};

}  // namespace hotblade::pipeline

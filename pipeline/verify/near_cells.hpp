// Which cells of a grid hold points or lie next to a cell that does: a quick answer to "is anything near?".
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace hotblade::pipeline {

class NearCells {
 public:
  // Marks the cells of edge `near_mm` > 0 around finite points (std::logic_error).
  NearCells(std::span<const Eigen::Vector3d> points, double near_mm);

  // Returns true wherever a point lies within near_mm, and perhaps up to 2 sqrt(3) near_mm away.
  [[nodiscard]] bool holds(const Eigen::Vector3d& p) const;
  // Writes 1 or 0 for each of many points, on all cores allowed. Spans of one size (std::logic_error);
  // quicker where points that follow each other share a cell.
  void hold(std::span<const Eigen::Vector3d> points, std::span<char> held) const;

 private:
  using Cell = std::array<std::int64_t, 3>;
  [[nodiscard]] bool known(const Cell& cell) const;
  [[nodiscard]] Cell cell(const Eigen::Vector3d& p) const;
  double edge_mm_;
  std::vector<Cell> cells_;  // sorted, each once
};

}  // namespace hotblade::pipeline

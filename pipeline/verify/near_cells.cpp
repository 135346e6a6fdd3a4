#include "pipeline/verify/near_cells.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "gpu/backend/stop.hpp"

namespace hotblade::pipeline {

namespace {

template <typename Cell>
void keep_each_once(std::vector<Cell>& cells) {
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
}

// Adds the cells before and behind along an axis.
template <typename Cell>
void widen(std::vector<Cell>& cells, std::size_t axis) {
  const std::size_t count = cells.size();
  cells.reserve(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    for (const int side : {-1, 1}) {
      cells.push_back(cells[i]);
      cells.back()[axis] += side;
    }
  }
  keep_each_once(cells);
}

}  // namespace

NearCells::NearCells(std::span<const Eigen::Vector3d> points, double near_mm) : edge_mm_(near_mm) {
  if (!(near_mm > 0)) throw std::logic_error("NearCells: near_mm must be positive");
  for (const Eigen::Vector3d& p : points) {
    const Cell c = cell(p);
    // Points come in rows, so most lie in the cell of the one before.
    if (cells_.empty() || cells_.back() != c) cells_.push_back(c);
  }
  keep_each_once(cells_);
  // Axis by axis: all 27 around each at once are several times as many as there are.
  for (std::size_t axis = 0; axis < 3; ++axis) widen(cells_, axis);
  cells_.shrink_to_fit();
}

NearCells::Cell NearCells::cell(const Eigen::Vector3d& p) const {
  Cell c;
  for (int i = 0; i < 3; ++i) {
    const double place = std::floor(p[i] / edge_mm_);
    // Far beyond any design, and exact in a double.
    constexpr double kFarthest = 1e15;
    if (!(std::abs(place) < kFarthest)) throw std::logic_error("NearCells: points must be finite");
    c[static_cast<std::size_t>(i)] = static_cast<std::int64_t>(place);
  }
  return c;
}

bool NearCells::known(const Cell& cell) const {
  return std::binary_search(cells_.begin(), cells_.end(), cell);
}

bool NearCells::holds(const Eigen::Vector3d& p) const {
  return known(cell(p));
}

void NearCells::hold(std::span<const Eigen::Vector3d> points, std::span<char> held) const {
  if (points.size() != held.size()) throw std::logic_error("NearCells: spans of different sizes");
  constexpr std::size_t kGrain = 4096;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), kGrain), [&](const auto& range) {
    gpu::stop_point();
    Cell last{};
    bool in_last = known(last);
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const Cell here = cell(points[i]);
      if (here != last) {
        last = here;
        in_last = known(here);
      }
      held[i] = in_last ? 1 : 0;
    }
  });
  gpu::stop_point();
}

}  // namespace hotblade::pipeline

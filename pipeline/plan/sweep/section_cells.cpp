#include "pipeline/plan/sweep/section_cells.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace hotblade::pipeline {

void SectionCells::add(const SweepSample& sample) {
  // Grids of designs start at round numbers: a shift by none keeps their points off the cells' edges, where
  // rounding would decide between neighbours.
  constexpr double kShift = 0.3719;
  const Eigen::Vector2d place = (sample.q / cell_mm_).array() + kShift;
  const auto floor = [](double v) {
    return static_cast<long>(v) - (v < static_cast<double>(static_cast<long>(v)));
  };
  InCell in{floor(place.x()), floor(place.y()), 0, sample};
  const Eigen::Vector2d cell(static_cast<double>(in.x), static_cast<double>(in.y));
  in.away = (place - cell - Eigen::Vector2d::Constant(0.5)).squaredNorm();
  if (cells_.empty() || cells_.back().x != in.x || cells_.back().y != in.y) {
    cells_.push_back(in);
  } else if (in.away < cells_.back().away) {
    cells_.back() = in;
  }
}

std::vector<SweepSample> SectionCells::samples() const {
  // Of two as near to the middle the first that came stays.
  std::vector<InCell> cells = cells_;
  std::stable_sort(cells.begin(), cells.end(), [](const InCell& a, const InCell& b) {
    return std::tie(a.x, a.y, a.away) < std::tie(b.x, b.y, b.away);
  });
  std::vector<SweepSample> all = border_;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i == 0 || cells[i].x != cells[i - 1].x || cells[i].y != cells[i - 1].y)
      all.push_back(cells[i].sample);
  }
  std::sort(all.begin(), all.end(), [](const SweepSample& a, const SweepSample& b) {
    return std::pair(a.q.x(), a.q.y()) < std::pair(b.q.x(), b.q.y());
  });
  return all;
}

}  // namespace hotblade::pipeline

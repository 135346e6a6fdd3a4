#include "pipeline/plan/sweep/sweep_block.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace hotblade::pipeline {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// What of a polygon lies where out . q <= at.
std::vector<Vector2d> cut_off(const std::vector<Vector2d>& polygon, const Vector2d& out, double at) {
  std::vector<Vector2d> left;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double over_p = out.dot(p) - at, over_q = out.dot(q) - at;
    if (over_p <= 0) left.push_back(p);
    if ((over_p < 0 && over_q > 0) || (over_p > 0 && over_q < 0))
      left.push_back(p + over_p / (over_p - over_q) * (q - p));
  }
  return left;
}

}  // namespace

double over_first_mm(const SweepData& data) {
  return data.seam_first ? 0 : kOverMm;
}

double over_last_mm(const SweepData& data) {
  return data.seam_last ? 0 : kOverMm;
}

Vector3d stock_for(const SweepData& data, const StockSettings& stock) {
  const Vector3d design = data.box.isEmpty() ? Vector3d::Zero() : Vector3d(data.box.sizes());
  Vector3d size = design + Vector3d(2 * stock.border_mm, stock.base_mm + stock.border_mm,
                                    2 * stock.border_mm + over_first_mm(data) + over_last_mm(data));
  std::sort(size.begin(), size.end());
  return size;
}

SweepFitOptions::Box block_in_planes(const SweepData& data, const StockSettings& stock, double clear_mm) {
  const double around = stock.border_mm + clear_mm, below = stock.base_mm + clear_mm;
  SweepFitOptions::Box box{data.low - Vector2d(around, below), data.high + Vector2d(around, around)};
  if (!data.axes.planes.turns()) return box;
  const Eigen::AlignedBox3d block(data.box.min() - Vector3d(around, below, around),
                                  data.box.max() + Vector3d::Constant(around));
  const double middle = 0.5 * (data.first_mm + data.last_mm), far = 2 * block.diagonal().norm();
  const Frame level = data.axes.plane(middle);
  const std::array<Vector3d, 3> edges{level.x, level.y, data.axes.planes.normal(middle)};
  for (const double offset : {data.first_mm, data.last_mm}) {
    const Frame plane = data.axes.plane(offset);
    const Vector2d centre = 0.5 * (data.low + data.high);
    std::vector<Vector2d> seen;
    for (const Vector2d& corner :
         {Vector2d(-far, -far), Vector2d(far, -far), Vector2d(far, far), Vector2d(-far, far)})
      seen.push_back(centre + corner);
    for (int i = 0; i < 3; ++i) {
      const Vector3d& edge = edges[static_cast<std::size_t>(i)];
      const Vector2d out(edge.dot(plane.x), edge.dot(plane.y));
      const double origin = edge.dot(plane.origin);
      seen = cut_off(seen, out, block.max()[i] - origin);
      seen = cut_off(seen, -out, origin - block.min()[i]);
    }
    for (const Vector2d& q : seen) {
      box.low = box.low.cwiseMin(q);
      box.high = box.high.cwiseMax(q);
    }
  }
  return box;
}

}  // namespace hotblade::pipeline

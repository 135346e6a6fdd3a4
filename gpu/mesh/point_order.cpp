#include "gpu/mesh/point_order.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "gpu/backend/stop.hpp"

namespace hotblade::gpu {
namespace {

using Eigen::Vector3d;

// Fewer points are answered before a sort has paid for itself.
constexpr std::size_t kSmall = 512;
// Points whose mean step is over this share of the spacing of as many points spread evenly are called
// scattered.
constexpr double kScattered = 2;
// Cells along each axis: 3 x 10 bits of the key, the point's number in the low 32.
constexpr int kCells = 1024;

// Ten bits with two empty ones between each.
std::uint64_t spread_bits(std::uint64_t v) {
  v = (v | (v << 16)) & 0x030000FFu;
  v = (v | (v << 8)) & 0x0300F00Fu;
  v = (v | (v << 4)) & 0x030C30C3u;
  v = (v | (v << 2)) & 0x09249249u;
  return v;
}

}  // namespace

std::vector<std::uint32_t> coherent_order(std::span<const Vector3d> points) {
  if (points.size() < kSmall || points.size() > std::numeric_limits<std::uint32_t>::max()) return {};
  Vector3d low = points[0], high = points[0], step = Vector3d::Zero();
  for (std::size_t i = 1; i < points.size(); ++i) {
    low = low.cwiseMin(points[i]);
    high = high.cwiseMax(points[i]);
    step += (points[i] - points[i - 1]).cwiseAbs();
  }
  const double extent = (high - low).maxCoeff(), count = static_cast<double>(points.size());
  // Coordinates too large for their difference, or all points one: no order to find.
  if (!std::isfinite(extent) || !(extent > 0)) return {};
  if (!(step.maxCoeff() > kScattered * extent * std::pow(count, 2.0 / 3.0))) return {};
  std::vector<std::uint64_t> keys(points.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), 4096), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      std::uint64_t key = 0;
      for (int k = 0; k < 3; ++k) {
        const int cell = std::min(kCells - 1, static_cast<int>((points[i][k] - low[k]) / extent * kCells));
        key |= spread_bits(static_cast<std::uint64_t>(cell)) << k;
      }
      keys[i] = key << 32 | i;
    }
  });
  stop_point();
  tbb::parallel_sort(keys.begin(), keys.end());
  stop_point();
  std::vector<std::uint32_t> order(points.size());
  std::transform(keys.begin(), keys.end(), order.begin(),
                 [](std::uint64_t key) { return static_cast<std::uint32_t>(key); });
  return order;
}

}  // namespace hotblade::gpu

#include "gpu/mesh/point_order.hpp"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "gpu/backend/blocks.hpp"
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

// Points that one thread looks at at a time.
constexpr std::size_t kLookedAt = 4096;

// The box of points, and the sums of their steps along each axis.
struct Spread {
  Vector3d low{0, 0, 0}, high{0, 0, 0};
  Vector3d step{0, 0, 0};
};

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
  std::vector<Spread> parts((points.size() + kLookedAt - 1) / kLookedAt);
  for_each_block(points.size(), kLookedAt, [&](std::size_t first, std::size_t end) {
    Spread& part = parts[first / kLookedAt];
    part = {points[first], points[first]};
    for (std::size_t i = first; i < end; ++i) {
      part.low = part.low.cwiseMin(points[i]);
      part.high = part.high.cwiseMax(points[i]);
      if (i > 0) part.step += (points[i] - points[i - 1]).cwiseAbs();
    }
  });
  Spread all = parts.front();
  for (const Spread& part : std::span(parts).subspan(1))
    all = {all.low.cwiseMin(part.low), all.high.cwiseMax(part.high), all.step + part.step};
  const Vector3d low = all.low;
  const double extent = (all.high - low).maxCoeff(), count = static_cast<double>(points.size());
  // Coordinates too large for their difference, or all points one: no order to find.
  if (!std::isfinite(extent) || !(extent > 0)) return {};
  if (!(all.step.maxCoeff() > kScattered * extent * std::pow(count, 2.0 / 3.0))) return {};
  std::vector<std::uint64_t> keys(points.size());
  for_each_in_blocks(points.size(), kLookedAt, [&](std::size_t i) {
    std::uint64_t key = 0;
    for (int k = 0; k < 3; ++k) {
      const int cell = std::min(kCells - 1, static_cast<int>((points[i][k] - low[k]) / extent * kCells));
      key |= spread_bits(static_cast<std::uint64_t>(cell)) << k;
    }
    keys[i] = key << 32 | i;
  });
  tbb::parallel_sort(keys.begin(), keys.end());
  stop_point();
  std::vector<std::uint32_t> order(points.size());
  for_each_in_blocks(keys.size(), kLookedAt,
                     [&](std::size_t i) { order[i] = static_cast<std::uint32_t>(keys[i]); });
  return order;
}

}  // namespace hotblade::gpu

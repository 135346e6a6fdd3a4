#include "gpu/mesh_distance_opencl.hpp"

#include <algorithm>
#include <chrono>

namespace hotblade::gpu {

extern const char* const mesh_distance_source;

namespace {

using Point = Eigen::Vector4f;
using Clock = std::chrono::steady_clock;

// Watchdogs of graphics drivers end launches of one or two seconds.
constexpr double kLaunchSeconds = 0.1;
constexpr std::size_t kFirstPortion = 1 << 14, kLargestPortion = 1 << 24;

}  // namespace

MeshSearchOnDevice::MeshSearchOnDevice(const MeshTree& tree) : portion_(kFirstPortion) {
  const std::size_t nodes = tree.nodes.size() * sizeof(TreeNode),
                    packets = tree.packets.size() * sizeof(TrianglePacket);
  const DeviceFacts& facts = device_.facts();
  // The rest is for points and the driver.
  if (nodes + packets > facts.memory_bytes / 4 * 3) {
    throw DeviceError("OpenCL: " + facts.name + ": the mesh needs " +
                      std::to_string((nodes + packets) >> 20) + " MiB of device memory (limit " +
                      std::to_string(facts.memory_bytes / 4 * 3 >> 20) + " MiB)");
  }
  kernel_ = device_.kernel(mesh_distance_source, "mesh_candidates");
  nodes_ = device_.upload(tree.nodes.data(), nodes);
  packets_ = device_.upload(tree.packets.data(), packets);
  kernel_.set(0, nodes_);
  kernel_.set(1, packets_);
}

void MeshSearchOnDevice::candidates(std::span<const Point> points, std::span<Found> found) const {
  const std::lock_guard lock(turn_);
  for (std::size_t first = 0; first < points.size();) {
    const std::size_t count = std::min(portion_, points.size() - first);
    if (points_.bytes() < count * sizeof(Point)) {
      points_ = device_.allocate(count * sizeof(Point));
      found_ = device_.allocate(count * sizeof(Found));
    }
    device_.write(points_, points.data() + first, count * sizeof(Point));
    kernel_.set(2, points_);
    kernel_.set(3, found_);
    kernel_.set(4, static_cast<int>(count));
    const auto start = Clock::now();
    device_.run(kernel_, count);
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    device_.read(found_, found.data() + first, count * sizeof(Found));
    first += count;
    const std::size_t room = device_.facts().memory_bytes / 16 / (sizeof(Point) + sizeof(Found));
    if (seconds < kLaunchSeconds / 4 && count == portion_) {
      portion_ = std::min({2 * portion_, kLargestPortion, std::max(room, kFirstPortion)});
    } else if (seconds > kLaunchSeconds) {
      portion_ = std::max<std::size_t>(portion_ / 2, 256);
    }
  }
}

}  // namespace hotblade::gpu

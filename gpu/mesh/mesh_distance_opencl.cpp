#include "gpu/mesh/mesh_distance_opencl.hpp"

#include <array>
#include <cstddef>

#include "gpu/backend/blocks.hpp"

namespace hotblade::gpu {

extern const char* const mesh_distance_source;

namespace {

// As the kernel lays answers out.
static_assert(sizeof(Nearest) == 40 && offsetof(Nearest, triangle) == 8 && offsetof(Nearest, point) == 16);
// Points that one thread copies at a time.
constexpr std::size_t kAskedAtOnce = 8192;

}  // namespace

MeshSearchOnDevice::MeshSearchOnDevice(const MeshFrame& frame, const MeshTree& tree)
    : device_(shared_opencl_device()), portions_(*device_, sizeof(Eigen::Vector3d), sizeof(Nearest)) {
  device_->require_fp64();
  const std::size_t nodes = tree.nodes().size() * sizeof(TreeNode),
                    packets = tree.packets().size() * sizeof(TrianglePacket),
                    vertices = frame.vertices.size() * sizeof(Eigen::Vector3d),
                    triangles = frame.triangles.size() * sizeof(frame.triangles[0]);
  const DeviceFacts& facts = device_->facts();
  const std::size_t all = nodes + packets + vertices + triangles;
  // The rest is for points and the driver.
  if (all > facts.memory_bytes / 4 * 3) {
    throw DeviceError("OpenCL: " + facts.name + ": the mesh needs " + std::to_string(all >> 20) +
                      " MiB of device memory (limit " + std::to_string(facts.memory_bytes / 4 * 3 >> 20) +
                      " MiB)");
  }
  kernel_ = device_->kernel(mesh_distance_source, "mesh_nearest");
  nodes_ = device_->upload(tree.nodes().data(), nodes);
  packets_ = device_->upload(tree.packets().data(), packets);
  vertices_ = device_->upload(frame.vertices.data(), vertices);
  triangles_ = device_->upload(frame.triangles.data(), triangles);
  kernel_.set(0, nodes_);
  kernel_.set(1, packets_);
  kernel_.set(2, vertices_);
  kernel_.set(3, triangles_);
  kernel_.set(4, std::array<double, 4>{frame.centre.x(), frame.centre.y(), frame.centre.z(), frame.scale});
}

void MeshSearchOnDevice::nearest(std::span<const Eigen::Vector3d> points, const Take& take) const {
  const std::lock_guard lock(turn_);
  portions_.run(
      *device_, kernel_, 5, points.size(),
      [&](std::size_t first, std::size_t n, void* into) {
        auto* const asked = static_cast<Eigen::Vector3d*>(into);
        for_each_in_blocks(n, kAskedAtOnce, [&](std::size_t i) { asked[i] = points[first + i]; });
      },
      [&](std::size_t first, std::size_t n, const void* from) {
        take(first, std::span(static_cast<const Nearest*>(from), n));
      });
}

}  // namespace hotblade::gpu

#include "gpu/mesh/mesh_distance_opencl.hpp"

namespace hotblade::gpu {

extern const char* const mesh_distance_source;

MeshSearchOnDevice::MeshSearchOnDevice(const MeshTree& tree)
    : device_(shared_opencl_device()), portions_(*device_, sizeof(Eigen::Vector4f), sizeof(Found)) {
  const std::size_t nodes = tree.nodes.size() * sizeof(TreeNode),
                    packets = tree.packets.size() * sizeof(TrianglePacket);
  const DeviceFacts& facts = device_->facts();
  // The rest is for points and the driver.
  if (nodes + packets > facts.memory_bytes / 4 * 3) {
    throw DeviceError("OpenCL: " + facts.name + ": the mesh needs " +
                      std::to_string((nodes + packets) >> 20) + " MiB of device memory (limit " +
                      std::to_string(facts.memory_bytes / 4 * 3 >> 20) + " MiB)");
  }
  kernel_ = device_->kernel(mesh_distance_source, "mesh_candidates");
  nodes_ = device_->upload(tree.nodes.data(), nodes);
  packets_ = device_->upload(tree.packets.data(), packets);
  kernel_.set(0, nodes_);
  kernel_.set(1, packets_);
}

void MeshSearchOnDevice::candidates(std::span<const Eigen::Vector4f> points, std::span<Found> found) const {
  const std::lock_guard lock(turn_);
  portions_.run(*device_, kernel_, 2, points.data(), found.data(), points.size());
}

}  // namespace hotblade::gpu

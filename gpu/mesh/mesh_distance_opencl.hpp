// Searches a mesh tree on an OpenCL device.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "gpu/backend/opencl_device.hpp"
#include "gpu/backend/opencl_portions.hpp"
#include "gpu/mesh/mesh_tree.hpp"

namespace hotblade::gpu {

class MeshSearchOnDevice {
 public:
  // A point may get this many triangles; with more the host searches for itself.
  static constexpr std::size_t kSlots = 4;
  static constexpr int kNone = -1, kTooMany = -2;
  using Found = std::array<int, kSlots>;

  // Throws DeviceError when there is no device, it has no room for the tree, or the kernel does not build.
  explicit MeshSearchOnDevice(const MeshTree& tree);

  [[nodiscard]] const DeviceFacts& facts() const { return device_->facts(); }

  // Writes, for every point of the tree's frame with its shared error (mesh_tree.h), the triangles that can
  // be nearest. Points go in portions (opencl_portions.hpp), and concurrent callers take turns. Throws
  // DeviceError.
  void candidates(std::span<const Eigen::Vector4f> points, std::span<Found> found) const;

 private:
  std::shared_ptr<const OpenClDevice> device_;
  DeviceBuffer nodes_, packets_;
  mutable std::mutex turn_;
  mutable DeviceKernel kernel_;
  mutable DevicePortions portions_;
};

}  // namespace hotblade::gpu

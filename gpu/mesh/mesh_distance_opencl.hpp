// Answers points to a mesh on an OpenCL device.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <mutex>
#include <span>

#include "gpu/backend/opencl_device.hpp"
#include "gpu/backend/opencl_portions.hpp"
#include "gpu/mesh/mesh_distance.hpp"
#include "gpu/mesh/mesh_frame.hpp"
#include "gpu/mesh/mesh_tree.hpp"

namespace hotblade::gpu {

class MeshSearchOnDevice {
 public:
  // Throws DeviceError when there is no device, it has no double precision or no room for mesh and tree, or
  // the kernel does not build.
  MeshSearchOnDevice(const MeshFrame& frame, const MeshTree& tree);

  [[nodiscard]] const DeviceFacts& facts() const { return device_->facts(); }

  // Takes the answers of points first .. first + answers.size(); one without a triangle is the host's to
  // find.
  using Take = std::function<void(std::size_t first, std::span<const Nearest> answers)>;

  // Hands every answer to `take`, in order. Points go in portions (opencl_portions.hpp), and concurrent
  // callers take turns. Throws DeviceError, and what `take` throws.
  void nearest(std::span<const Eigen::Vector3d> points, const Take& take) const;

 private:
  std::shared_ptr<const OpenClDevice> device_;
  DeviceBuffer nodes_, packets_, vertices_, triangles_;
  mutable std::mutex turn_;
  mutable DeviceKernel kernel_;
  mutable DevicePortions portions_;
};

}  // namespace hotblade::gpu

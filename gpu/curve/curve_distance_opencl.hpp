// Finds the nearest points of a curve on an OpenCL device.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <mutex>
#include <span>

#include "gpu/backend/opencl_device.hpp"
#include "gpu/backend/opencl_portions.hpp"
#include "gpu/curve/curve_search.hpp"

namespace hotblade::gpu {

class CurveSearchOnDevice {
 public:
  // Throws DeviceError when there is no device, it has no double precision or no room, or the kernel does not
  // build.
  explicit CurveSearchOnDevice(const CurvePieces& curve);

  [[nodiscard]] const DeviceFacts& facts() const { return device_->facts(); }

  // Writes the distance and parameter of every point of the curve's frame; the distance is -1 where the
  // device does not prove it. Points go in portions (opencl_portions.hpp), and concurrent callers take turns.
  // Throws DeviceError.
  void nearest(std::span<const Eigen::Vector2d> points, std::span<Eigen::Vector2d> answers) const;

 private:
  std::shared_ptr<const OpenClDevice> device_;
  DeviceBuffer whole_, pieces_;
  mutable std::mutex turn_;
  mutable DeviceKernel kernel_;
  mutable DevicePortions portions_;
};

}  // namespace hotblade::gpu

// Finds the nearest points of a curve on an OpenCL device.
#pragma once

#include <Eigen/Core>
#include <functional>
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

  // Writes point first + i of the curve's frame to into[i]; takes its distance and parameter, the distance
  // being -1 where the device does not prove it.
  using Fill = std::function<void(std::size_t first, std::span<Eigen::Vector2d> into)>;
  using Take = std::function<void(std::size_t first, std::span<const Eigen::Vector2d> answers)>;

  // Asks `fill` for so many points and hands their answers to `take`, in order. Points go in portions
  // (opencl_portions.hpp), and concurrent callers take turns. Throws DeviceError, and what those throw.
  void nearest(std::size_t count, const Fill& fill, const Take& take) const;

 private:
  std::shared_ptr<const OpenClDevice> device_;
  DeviceBuffer whole_, pieces_;
  mutable std::mutex turn_;
  mutable DeviceKernel kernel_;
  mutable DevicePortions portions_;
};

}  // namespace hotblade::gpu

// Measures pairs of curves on an OpenCL device, by the kernels that the host's lanes run
// (gpu/curve/pair_lanes.hpp), bit for bit.
#pragma once

#include <memory>
#include <mutex>

#include "gpu/backend/opencl_device.hpp"
#include "gpu/backend/opencl_portions.hpp"
#include "gpu/curve/pair_lanes.hpp"

namespace hotblade::gpu {

// Pairs go in portions (opencl_portions.hpp), and concurrent callers take turns.
class PairsOnDevice {
 public:
  // Throws DeviceError when there is no device, it has no double precision, or the kernel does not build.
  PairsOnDevice();

  [[nodiscard]] const DeviceFacts& facts() const { return device_->facts(); }

  // Both answer as PairLanes does. They throw DeviceError.
  void differences(const PairQueries& queries, int panels, double* l2, double* h1, double* length) const;
  void hausdorff(const PairQueries& queries, int samples, double* lower, double* upper) const;

 private:
  std::shared_ptr<const OpenClDevice> device_;
  mutable std::mutex turn_;
  mutable DeviceKernel differences_, hausdorff_;
  mutable DevicePortions difference_portions_, hausdorff_portions_;
};

}  // namespace hotblade::gpu

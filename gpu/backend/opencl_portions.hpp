// Takes many items through a device in portions: each fits its memory and keeps one launch short of any
// watchdog.
#pragma once

#include <cstddef>

#include "gpu/backend/opencl_device.hpp"

namespace hotblade::gpu {

// Sizes portions by how long the launches before took. Not for two threads at once.
class DevicePortions {
 public:
  // in_bytes and out_bytes are the bytes of one item going in and of its answer coming out; scratch_bytes is
  // what the kernel needs for itself while it works on one item.
  DevicePortions(const OpenClDevice& device, std::size_t in_bytes, std::size_t out_bytes,
                 std::size_t scratch_bytes = 0);

  // Runs the kernel, whose arguments from `first_argument` on are the items, the answers, their count (int)
  // and, where scratch was asked for, that. Throws DeviceError.
  void run(const OpenClDevice& device, DeviceKernel& kernel, unsigned first_argument, const void* in,
           void* out, std::size_t count);

 private:
  std::size_t in_bytes_, out_bytes_, scratch_bytes_, largest_, portion_;
  DeviceBuffer in_, out_, scratch_;
};

}  // namespace hotblade::gpu

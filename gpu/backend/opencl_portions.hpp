// Many items through a device in portions: each fits its memory and keeps one launch short of any watchdog.
#pragma once

#include <cstddef>

#include "gpu/backend/opencl_device.hpp"

namespace hotblade::gpu {

class DevicePortions {
 public:
  // Bytes of one item going in and of its answer coming out.
  DevicePortions(const OpenClDevice& device, std::size_t in_bytes, std::size_t out_bytes);

  // Runs the kernel, whose arguments from `first_argument` on are the items, the answers and their count
  // (int). Not for two threads at once. Throws DeviceError.
  void run(const OpenClDevice& device, DeviceKernel& kernel, unsigned first_argument, const void* in,
           void* out, std::size_t count);

 private:
  std::size_t in_bytes_, out_bytes_, largest_, portion_;
  DeviceBuffer in_, out_;
};

}  // namespace hotblade::gpu

// Takes many items through a device in portions: each fits its memory and keeps one launch short of any
// watchdog.
#pragma once

#include <array>
#include <cstddef>
#include <functional>

#include "gpu/backend/opencl_device.hpp"
#include "gpu/backend/opencl_lane.hpp"

namespace hotblade::gpu {

// Sizes portions by how long the kernel took for those before. Some are copied while others are computed,
// through memory that the device reads and writes itself. Not for two threads at once.
class DevicePortions {
 public:
  // in_bytes and out_bytes are the bytes of one item going in and of its answer coming out; scratch_bytes is
  // what the kernel needs for itself while it works on one item.
  DevicePortions(const OpenClDevice& device, std::size_t in_bytes, std::size_t out_bytes,
                 std::size_t scratch_bytes = 0);

  // Writes items first .. first + n to `into`.
  using Fill = std::function<void(std::size_t first, std::size_t n, void* into)>;
  // Takes the answers of items first .. first + n from `from`.
  using Take = std::function<void(std::size_t first, std::size_t n, const void* from)>;

  // Runs the kernel, whose arguments from `first_argument` on are the items, the answers, their count (int)
  // and, where scratch was asked for, that. `fill` and `take` are called in order, on this thread, and may
  // use others: it takes up no work but theirs meanwhile. Throws DeviceError, and what they throw once the
  // device has ended its work.
  void run(const OpenClDevice& device, DeviceKernel& kernel, unsigned first_argument, std::size_t count,
           const Fill& fill, const Take& take);

 private:
  // Two copies and a kernel run at once at most.
  static constexpr std::size_t kLanes = 3;

  void run_alone(const OpenClDevice& device, DeviceKernel& kernel, unsigned first_argument, std::size_t count,
                 const Fill& fill, const Take& take);

  std::size_t in_bytes_, out_bytes_, scratch_bytes_, largest_, portion_;
  std::array<DeviceLane, kLanes> lanes_;
};

}  // namespace hotblade::gpu

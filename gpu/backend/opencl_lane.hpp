// Takes one portion of items through a device without waiting for it.
#pragma once

#include <cstddef>
#include <memory>

#include "gpu/backend/opencl_device.hpp"

namespace hotblade::gpu {

// Holds a queue of its own, memory on either side of a kernel on the device, and as much on the host where
// the device itself reads and writes: portions on different lanes are copied and computed at once. Every
// member but abandon() throws DeviceError when the device refuses.
class DeviceLane {
 public:
  struct Bytes {
    std::size_t in = 0, out = 0, scratch = 0;
  };
  // Makes room for so much; what is there already stays. Not while a portion is on its way.
  void reserve(const OpenClDevice& device, const Bytes& bytes);

  // Where items are written before start(), and where their answers stand after finish().
  [[nodiscard]] void* in() const { return in_.get(); }
  [[nodiscard]] const void* out() const { return out_.get(); }

  // Sends in_bytes to the device, runs the kernel over `count` items, whose arguments from `first_argument`
  // on are the items, the answers, their count (int) and, where there is any, scratch memory, and fetches
  // out_bytes: all in the device's own time.
  void start(DeviceKernel& kernel, unsigned first_argument, std::size_t count, std::size_t in_bytes,
             std::size_t out_bytes);
  // Waits for the answers and returns the seconds that the kernel took.
  double finish();
  // Waits for whatever is on its way and drops it.
  void abandon() noexcept;

 private:
  [[nodiscard]] std::shared_ptr<void> host_memory(const OpenClDevice& device, std::size_t bytes) const;

  std::shared_ptr<void> queue_;
  std::shared_ptr<void> in_, out_;  // on the host
  Bytes host_;
  DeviceBuffer device_in_, device_out_, scratch_;
  std::shared_ptr<void> computed_, fetched_;  // events
};

}  // namespace hotblade::gpu

// Holds one OpenCL device behind values and exceptions: finds it, builds its programs, and owns memory and
// launches.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace hotblade::gpu {

// Says that a device is missing, lacks something, ran out of memory or was lost; the caller falls back to the
// CPU.
class DeviceError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class OpenClDevice;

// Owns memory on the device, which is freed with the value.
class DeviceBuffer {
 public:
  DeviceBuffer() = default;
  [[nodiscard]] std::size_t bytes() const { return bytes_; }

 private:
  friend class OpenClDevice;
  friend class DeviceKernel;
  friend class DeviceLane;
  std::shared_ptr<void> memory_;
  std::size_t bytes_ = 0;
};

// Holds a kernel with its arguments. Two threads must not use one at once.
class DeviceKernel {
 public:
  void set(unsigned index, const DeviceBuffer& buffer);
  template <typename T>
  void set(unsigned index, const T& value) {
    set_bytes(index, &value, sizeof(T));
  }

 private:
  friend class OpenClDevice;
  friend class DeviceLane;
  void set_bytes(unsigned index, const void* value, std::size_t size);
  std::shared_ptr<void> kernel_;
};

struct DeviceFacts {
  std::string name, vendor, driver;
  bool has_fp64 = false, is_cpu = false, little_endian = true;
  bool asked_for = false;  // by HOTBLADE_OPENCL_DEVICE
  std::size_t memory_bytes = 0, largest_buffer_bytes = 0;
};

// Returns the device that OpenClDevice() takes, without starting it: the one that HOTBLADE_OPENCL_DEVICE
// names (part of its name), else a GPU before an accelerator before a CPU. Throws DeviceError when there is
// none; a system without any driver is such a case. HOTBLADE_OPENCL_MEMORY_MIB says how much of its memory
// may be used; anything but a whole number above 0 is a DeviceError.
[[nodiscard]] DeviceFacts find_opencl_device();

// Every member throws DeviceError when the device refuses, with the OpenCL code in words.
class OpenClDevice {
 public:
  // Starts the device that HOTBLADE_OPENCL_DEVICE names (part of its name), else a GPU before an accelerator
  // before a CPU. Throws DeviceError when there is none; a system without any driver is such a case.
  OpenClDevice();

  [[nodiscard]] const DeviceFacts& facts() const { return facts_; }
  // Throws when the device has no double precision.
  void require_fp64() const;
  // Builds OpenCL C 1.2 source without relaxed mathematics and takes its kernel `name`. A source is built
  // once a device.
  [[nodiscard]] DeviceKernel kernel(std::string_view source, const std::string& name) const;
  [[nodiscard]] DeviceBuffer allocate(std::size_t bytes) const;
  [[nodiscard]] DeviceBuffer upload(const void* data, std::size_t bytes) const;
  void write(const DeviceBuffer& buffer, const void* data, std::size_t bytes) const;
  void read(const DeviceBuffer& buffer, void* data, std::size_t bytes) const;
  // Runs at least `count` work items, in groups of 64, and waits for them; the kernel skips those beyond.
  void run(const DeviceKernel& kernel, std::size_t count) const;

 private:
  friend class DeviceLane;
  [[nodiscard]] std::shared_ptr<void> program(std::string_view source, const std::string& name) const;

  DeviceFacts facts_;
  std::shared_ptr<void> context_, queue_;
  void* device_ = nullptr;
  mutable std::mutex programs_turn_;
  mutable std::map<std::string, std::shared_ptr<void>, std::less<>> programs_;  // by source
};

// Returns the one device that everything shares, with its programs, as long as anything holds it. Throws
// DeviceError as OpenClDevice() does.
[[nodiscard]] std::shared_ptr<const OpenClDevice> shared_opencl_device();

// Drops the shared device after a failure: who asks next starts it anew.
void forget_opencl_device();

// Throws DeviceError with what failed and why, unless the code is OpenCL's for success.
void check_opencl(int code, const char* what);

// Items of one group of a launch. Left to itself a CPU driver makes groups so large that their private memory
// overflows its stack.
inline constexpr std::size_t kDeviceGroup = 64;

// Returns OpenCL's error code in words, with the code.
[[nodiscard]] std::string opencl_error_text(int code);

}  // namespace hotblade::gpu

#include "gpu/backend/opencl_portions.hpp"

#include <algorithm>
#include <chrono>

namespace hotblade::gpu {
namespace {

using Clock = std::chrono::steady_clock;

// Watchdogs of graphics drivers end launches of one or two seconds.
constexpr double kLaunchSeconds = 0.1;
constexpr std::size_t kFirst = 1 << 14, kLargest = 1 << 24, kLeast = 256;

}  // namespace

// A sixteenth of the device's memory: the rest is for what the kernel reads and for the driver.
DevicePortions::DevicePortions(const OpenClDevice& device, std::size_t in_bytes, std::size_t out_bytes,
                               std::size_t scratch_bytes)
    : in_bytes_(in_bytes),
      out_bytes_(out_bytes),
      scratch_bytes_(scratch_bytes),
      largest_(std::clamp(device.facts().memory_bytes / 16 / (in_bytes + out_bytes + scratch_bytes), kLeast,
                          kLargest)),
      portion_(std::min(kFirst, largest_)) {}

void DevicePortions::run(const OpenClDevice& device, DeviceKernel& kernel, unsigned first_argument,
                         const void* in, void* out, std::size_t count) {
  for (std::size_t first = 0; first < count;) {
    const std::size_t n = std::min(portion_, count - first);
    if (in_.bytes() < n * in_bytes_) {
      in_ = device.allocate(n * in_bytes_);
      out_ = device.allocate(n * out_bytes_);
      if (scratch_bytes_ > 0) scratch_ = device.allocate(n * scratch_bytes_);
    }
    device.write(in_, static_cast<const char*>(in) + first * in_bytes_, n * in_bytes_);
    kernel.set(first_argument, in_);
    kernel.set(first_argument + 1, out_);
    kernel.set(first_argument + 2, static_cast<int>(n));
    if (scratch_bytes_ > 0) kernel.set(first_argument + 3, scratch_);
    const auto start = Clock::now();
    device.run(kernel, n);
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    device.read(out_, static_cast<char*>(out) + first * out_bytes_, n * out_bytes_);
    first += n;
    if (seconds < kLaunchSeconds / 4 && n == portion_) {
      portion_ = std::min(2 * portion_, largest_);
    } else if (seconds > kLaunchSeconds) {
      portion_ = std::max(portion_ / 2, kLeast);
    }
  }
}

}  // namespace hotblade::gpu

#include "gpu/backend/opencl_portions.hpp"

#include <tbb/task_arena.h>

#include <algorithm>

namespace hotblade::gpu {
namespace {

// Watchdogs of graphics drivers end launches of one or two seconds.
constexpr double kLaunchSeconds = 0.1;
constexpr std::size_t kFirst = 1 << 14, kLeast = 256;
// Few items are cut into portions of no fewer than this, so that copies of some pass beside work on others.
constexpr std::size_t kWorthALaunch = 1 << 16, kCuts = 4;
// Of a portion's items or answers: enough for a launch to fill any device, of which several are on their way.
constexpr std::size_t kLargestBytes = std::size_t{16} << 20;

}  // namespace

// Three lanes of a forty-eighth of the device's memory: the rest is for what the kernel reads and for the
// driver.
DevicePortions::DevicePortions(const OpenClDevice& device, std::size_t in_bytes, std::size_t out_bytes,
                               std::size_t scratch_bytes)
    : in_bytes_(in_bytes),
      out_bytes_(out_bytes),
      scratch_bytes_(scratch_bytes),
      largest_(std::max(kLeast, std::min(kLargestBytes / std::max(in_bytes, out_bytes),
                                         device.facts().memory_bytes / (16 * kLanes) /
                                             (in_bytes + out_bytes + scratch_bytes)))),
      portion_(std::min(kFirst, largest_)) {}

void DevicePortions::run(const OpenClDevice& device, DeviceKernel& kernel, unsigned first_argument,
                         std::size_t count, const Fill& fill, const Take& take) {
  // The caller may hold a lock that work from elsewhere waits for.
  tbb::this_task_arena::isolate([&] { run_alone(device, kernel, first_argument, count, fill, take); });
}

void DevicePortions::run_alone(const OpenClDevice& device, DeviceKernel& kernel, unsigned first_argument,
                               std::size_t count, const Fill& fill, const Take& take) {
  const std::size_t most = std::min(largest_, std::max(kWorthALaunch, (count + kCuts - 1) / kCuts)),
                    room = std::min(count, most);
  struct Portion {
    std::size_t first = 0, n = 0;
  };
  std::array<Portion, kLanes> portions;
  std::size_t given = 0, taken = 0, begun = 0, ended = 0;  // items, then portions
  try {
    while (taken < count) {
      while (given < count && begun - ended < kLanes) {
        DeviceLane& lane = lanes_[begun % kLanes];
        const Portion portion{given, std::min({portion_, most, count - given})};
        lane.reserve(device, {room * in_bytes_, room * out_bytes_, room * scratch_bytes_});
        fill(portion.first, portion.n, lane.in());
        lane.start(kernel, first_argument, portion.n, portion.n * in_bytes_, portion.n * out_bytes_);
        portions[begun % kLanes] = portion;
        given += portion.n;
        ++begun;
      }
      const Portion portion = portions[ended % kLanes];
      DeviceLane& lane = lanes_[ended % kLanes];
      const double seconds = lane.finish();
      ++ended;
      take(portion.first, portion.n, lane.out());
      taken += portion.n;
      if (seconds < kLaunchSeconds / 4 && portion.n == portion_) {
        portion_ = std::min(2 * portion_, largest_);
      } else if (seconds > kLaunchSeconds) {
        portion_ = std::max(portion_ / 2, kLeast);
      }
    }
  } catch (...) {
    for (DeviceLane& lane : lanes_) lane.abandon();
    throw;
  }
}

}  // namespace hotblade::gpu

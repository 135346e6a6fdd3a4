// Decides which backend answers a query. A device is started when it is first needed, timed where that can
// pay, and dropped for good when it fails.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "gpu/backend/backend.hpp"
#include "gpu/backend/opencl_device.hpp"

namespace hotblade::gpu {

// Work that the CPU ends sooner is not worth starting a device: a context and a compiled kernel take 0.1 to 1
// s.
inline constexpr double kDeviceStart_s = 0.5;

// Returns "1.2 s", for messages.
[[nodiscard]] std::string rounded_seconds(double seconds);

// Returns the seconds that a call of run() takes.
template <typename Run>
[[nodiscard]] double timed_s(const Run& run) {
  const auto start = std::chrono::steady_clock::now();
  run();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Has the host answer a part of a query's items by run(first, count), and returns the seconds that all of
// them would take it: by what the part takes but for its first eighth, which warms up. Items that are
// answered side by side in lanes stay in these.
template <typename Run>
[[nodiscard]] double host_seconds(std::size_t items, std::size_t part, const Run& run) {
  if (part == 0) return 0;
  constexpr std::size_t kLanes = 64;  // a multiple of any kernel's
  const std::size_t first = part / 8 / kLanes * kLanes;
  if (first > 0) run(std::size_t{0}, first);
  const double seconds = timed_s([&] { run(first, part - first); });
  return seconds * static_cast<double>(items) / static_cast<double>(part - first);
}

// Returns the seconds that a device takes for all items by run(n), which answers the first n of a part of
// them: by all of the part and an eighth of it, each after a run that warms up, as a launch costs the same
// for few and many.
template <typename Run>
[[nodiscard]] double device_seconds(std::size_t items, std::size_t part, const Run& run) {
  if (part == 0) return 0;
  const auto seconds = [&](std::size_t n) {
    run(n);
    return timed_s([&] { run(n); });
  };
  const std::size_t few = (part + 7) / 8;
  const double most = seconds(part);
  if (part == few) return most * static_cast<double>(items) / static_cast<double>(part);
  const double least = std::min(most, seconds(few));
  const auto more = static_cast<double>(items) - static_cast<double>(part);
  return most + (most - least) / static_cast<double>(part - few) * std::max(0.0, more);
}

// Search is what runs on the device; its facts() name that. Concurrent callers are safe.
template <typename Search>
class BackendChoice {
 public:
  using Device = std::shared_ptr<const Search>;
  explicit BackendChoice(Backend wanted) : wanted_(wanted) {}

  // Returns the device that is to answer, or null for the host. host_s() and device_s(search) give the
  // seconds that the query would take, make() starts the search; what throws DeviceError leaves the work to
  // the host. Once the device has been timed, the faster one answers all later queries.
  template <typename HostSeconds, typename Make, typename DeviceSeconds>
  [[nodiscard]] Device choose(const HostSeconds& host_s, const Make& make, const DeviceSeconds& device_s) {
    const std::lock_guard lock(mutex_);
    if (wanted_ == Backend::kCpu) return nullptr;
    try {
      if (wanted_ == Backend::kAuto) {
        if (!is_faster_) is_faster_ = compare(host_s, make, device_s);
        if (!is_faster_.value_or(false)) return nullptr;
      }
      if (!started(make)) return nullptr;
    } catch (const DeviceError& error) {
      forget(error);
      return nullptr;
    }
    use_.backend = Backend::kOpenCl;
    use_.name = "opencl " + device_->facts().name;
    return device_;
  }

  // Takes note of a failure: the host answers from now on, and used() says why.
  void drop(const DeviceError& error) {
    const std::lock_guard lock(mutex_);
    forget(error);
  }

  // Returns what answered the last query, and why.
  [[nodiscard]] BackendUse used() const {
    const std::lock_guard lock(mutex_);
    return use_;
  }

 private:
  template <typename Make>
  bool started(const Make& make) {
    if (!device_ && failure_.empty()) device_ = make();
    if (!device_) use_ = {Backend::kCpu, "cpu", failure_};
    return device_ != nullptr;
  }

  void forget(const DeviceError& error) {
    device_.reset();
    forget_opencl_device();
    failure_ = std::string(error.what()) + "; distances are computed on the CPU";
    use_ = {Backend::kCpu, "cpu", failure_};
  }

  // Tells whether the device is the faster one; nothing as long as all work so far was too little to tell.
  template <typename HostSeconds, typename Make, typename DeviceSeconds>
  std::optional<bool> compare(const HostSeconds& host_s, const Make& make, const DeviceSeconds& device_s) {
    use_ = {};
    const double host = host_s();
    host_s_ += host;
    use_.reason = "the CPU needs about " + rounded_seconds(host_s_);
    if (host_s_ < kDeviceStart_s) {
      use_.reason += ", less than starting a device (" + rounded_seconds(kDeviceStart_s) + ")";
      return std::nullopt;
    }
    const DeviceFacts facts = find_opencl_device();
    // Measured: the host's own code is several times faster than the same search through a CPU's OpenCL
    // driver.
    if (facts.is_cpu && !facts.asked_for) {
      use_.reason += ", and the only OpenCL device is a CPU (" + facts.name + ")";
      return false;
    }
    if (!started(make)) return false;
    const double device = device_s(*device_);
    use_.reason = "the CPU needs about " + rounded_seconds(host) + ", " + facts.name + " about " +
                  rounded_seconds(device);
    return device < host;
  }

  const Backend wanted_;
  mutable std::mutex mutex_;
  Device device_;
  std::string failure_;
  BackendUse use_;
  double host_s_ = 0;              // of all queries until the device was timed
  std::optional<bool> is_faster_;  // the device, once timed
};

}  // namespace hotblade::gpu

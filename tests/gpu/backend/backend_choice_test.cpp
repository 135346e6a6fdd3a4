#include "gpu/backend/backend_choice.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

namespace hotblade::gpu {
namespace {

// A search whose costs a test states.
struct StatedSearch {
  [[nodiscard]] DeviceFacts facts() const {
    DeviceFacts facts;
    facts.name = "stated";
    return facts;
  }
};

// What a choice says to queries of so many seconds on the host, one after the other, on a device that takes
// device_s for each.
std::vector<bool> choices(const std::vector<double>& host_s, double device_s, int& timings) {
  const BackendChoice<StatedSearch>::Device search = std::make_shared<const StatedSearch>();
  BackendChoice<StatedSearch> choice(Backend::kAuto);
  std::vector<bool> device;
  for (const double seconds : host_s) {
    device.push_back(nullptr != choice.choose([&] { return seconds; }, [&] { return search; },
                                              [&](const StatedSearch&) {
                                                ++timings;
                                                return device_s;
                                              }));
  }
  return device;
}

TEST(BackendChoice, TimesTheDeviceOnceAllWorkSoFarIsWorthItsStart) {
  std::string name;
  try {
    name = find_opencl_device().name;
  } catch (const DeviceError&) {
    GTEST_SKIP() << "no OpenCL device";
  }
  // PoCL's is a CPU, which nobody times unless it is asked for.
  setenv("HOTBLADE_OPENCL_DEVICE", name.c_str(), 1);
  int timings = 0;
  EXPECT_EQ(choices({0.2, 0.2, 0.2, 1e-6, 0.2}, 0.1, timings),
            (std::vector<bool>{false, false, true, true, true}));
  EXPECT_EQ(timings, 1);
  EXPECT_EQ(choices({0.6, 3}, 0.7, timings), (std::vector<bool>{false, false}));
  EXPECT_EQ(timings, 2);
  unsetenv("HOTBLADE_OPENCL_DEVICE");
}

TEST(BackendChoice, ExpectsADeviceToStartSlowly) {
  // 50 ms for a launch and 5 ns for each of the items; in proportion to a tenth of them it would be 1 s.
  const double device = device_seconds(100000000, 10000000, [](std::size_t n) {
    std::this_thread::sleep_for(std::chrono::duration<double>(0.05 + 5e-9 * static_cast<double>(n)));
  });
  EXPECT_NEAR(device, 0.55, 0.25);
  EXPECT_EQ(device_seconds(0, 0, [](std::size_t) {}), 0);
}

TEST(BackendChoice, TimesTheHostByWhatItAnswersOnce) {
  std::vector<int> answered(1000, 0);
  const double host = host_seconds(8000, answered.size(), [&](std::size_t first, std::size_t count) {
    // Twice as slow at first.
    std::this_thread::sleep_for(std::chrono::duration<double>((first == 0 ? 2e-4 : 1e-4) * double(count)));
    for (std::size_t i = first; i < first + count; ++i) ++answered[i];
  });
  EXPECT_EQ(answered, std::vector<int>(1000, 1));
  EXPECT_NEAR(host, 0.8, 0.2);
  EXPECT_EQ(host_seconds(5, 0, [](std::size_t, std::size_t) {}), 0);
}

}  // namespace
}  // namespace hotblade::gpu

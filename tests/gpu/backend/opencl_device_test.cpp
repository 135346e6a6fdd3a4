#include "gpu/backend/opencl_device.hpp"

#include <gtest/gtest.h>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <stdexcept>
#include <thread>

#include "gpu/backend/opencl_portions.hpp"
#include "gpu/mesh/mesh_distance.hpp"
#include "tests/gpu/soup.hpp"

namespace hotblade::gpu {
namespace {

constexpr const char* kDouble = R"(
__kernel void twice(__global const int* in, __global int* out, const int add) {
  const int i = (int)get_global_id(0);
  if (i < 4) out[i] = 2 * in[i] + add;
})";

// Sets a variable of the environment while it lives.
class Environment {
 public:
  Environment(const char* name, const char* value) : name_(name) { setenv(name, value, 1); }
  ~Environment() { unsetenv(name_); }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  const char* name_;
};
class NoSuchDevice : Environment {
 public:
  NoSuchDevice() : Environment("HOTBLADE_OPENCL_DEVICE", "no such device") {}
};
class MemoryLimit : Environment {
 public:
  explicit MemoryLimit(const char* mib) : Environment("HOTBLADE_OPENCL_MEMORY_MIB", mib) {}
};

std::shared_ptr<const OpenClDevice> device() {
  try {
    return shared_opencl_device();
  } catch (const DeviceError&) {
    return nullptr;
  }
}

TEST(OpenClDevice, RunsAKernelOverABuffer) {
  const auto gpu = device();
  if (!gpu) GTEST_SKIP() << "no OpenCL device";
  const std::vector<int> in{1, 2, 3, 40};
  std::vector<int> out(4);
  DeviceKernel kernel = gpu->kernel(kDouble, "twice");
  const DeviceBuffer from = gpu->upload(in.data(), 16), to = gpu->allocate(16);
  kernel.set(0, from);
  kernel.set(1, to);
  kernel.set(2, 5);
  gpu->run(kernel, 4);
  gpu->read(to, out.data(), 16);
  EXPECT_EQ(out, (std::vector<int>{7, 9, 11, 85}));
}

TEST(OpenClDevice, SaysWhatTheCompilerSaid) {
  const auto gpu = device();
  if (!gpu) GTEST_SKIP() << "no OpenCL device";
  try {
    (void)gpu->kernel("__kernel void broken(__global int* a) { a[0] = nonsense; }", "broken");
    FAIL() << "built";
  } catch (const DeviceError& error) {
    EXPECT_NE(std::string(error.what()).find("nonsense"), std::string::npos) << error.what();
  }
}

TEST(OpenClDevice, RefusesMoreMemoryThanTheDeviceHas) {
  const auto gpu = device();
  if (!gpu) GTEST_SKIP() << "no OpenCL device";
  EXPECT_THROW((void)gpu->allocate(gpu->facts().largest_buffer_bytes + 1), DeviceError);
}

TEST(OpenClDevice, IsSharedByAllThatUseIt) {
  const auto first = device();
  if (!first) GTEST_SKIP() << "no OpenCL device";
  EXPECT_EQ(device(), first);
  forget_opencl_device();
  EXPECT_NE(device(), first);
}

TEST(OpenClDevice, RefusesALimitThatIsNoNumber) {
  if (!device()) GTEST_SKIP() << "no OpenCL device";
  for (const char* bad : {"0", "-1", "many", "1.5", ""}) {
    const MemoryLimit limit(bad);
    EXPECT_THROW(OpenClDevice(), DeviceError) << bad;
  }
}

// A height field, and points around it.
struct Field {
  test::Soup soup;
  std::vector<Eigen::Vector3d> points;
};
Field field(int triangles, int points) {
  std::mt19937_64 rng(1);
  return {test::random_soup(rng, triangles, 100, 5), test::random_points(rng, points, 120)};
}

constexpr const char* kTwiceEach = R"(
__kernel void twice_each(__global const int* in, __global int* out, const int count) {
  const int i = (int)get_global_id(0);
  if (i < count) out[i] = 2 * in[i];
})";

// Items through a kernel that doubles them, so many that several portions are on their way at once.
class Doubled {
 public:
  explicit Doubled(std::shared_ptr<const OpenClDevice> gpu)
      : gpu_(std::move(gpu)),
        kernel_(gpu_->kernel(kTwiceEach, "twice_each")),
        portions_(*gpu_, sizeof(int), sizeof(int)) {}

  // Returns the answers; throws once more than `most` have come.
  std::vector<int> run(std::size_t count, std::size_t most) {
    std::vector<int> out;
    portions_.run(
        *gpu_, kernel_, 0, count,
        [](std::size_t first, std::size_t n, void* into) {
          for (std::size_t i = 0; i < n; ++i) static_cast<int*>(into)[i] = static_cast<int>(first + i);
        },
        [&](std::size_t first, std::size_t n, const void* from) {
          EXPECT_EQ(first, out.size());
          const int* const answers = static_cast<const int*>(from);
          out.insert(out.end(), answers, answers + n);
          if (out.size() > most) throw std::runtime_error("enough");
        });
    return out;
  }

 private:
  std::shared_ptr<const OpenClDevice> gpu_;
  DeviceKernel kernel_;
  DevicePortions portions_;
};

void expect_doubled(const std::vector<int>& out, std::size_t count) {
  ASSERT_EQ(out.size(), count);
  for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(out[i], 2 * static_cast<int>(i));
}

TEST(DevicePortions, ComeBackInOrderForEveryNumberOfItems) {
  if (!device()) GTEST_SKIP() << "no OpenCL device";
  Doubled doubled(device());
  for (const int items : {0, 1, 63, 65537, 5000003, 5}) {
    const auto count = static_cast<std::size_t>(items);
    expect_doubled(doubled.run(count, count), count);
  }
}

TEST(DevicePortions, GoOnAfterARunThatWasThrownOutOf) {
  if (!device()) GTEST_SKIP() << "no OpenCL device";
  Doubled doubled(device());
  for (int i = 0; i < 3; ++i) {
    EXPECT_THROW(doubled.run(500000, 100000), std::runtime_error);
    expect_doubled(doubled.run(300000, 300000), 300000);
  }
}

TEST(OpenClDevice, StreamsMorePointsThanItsMemoryHolds) {
  if (!device()) GTEST_SKIP() << "no OpenCL device";
  const MemoryLimit limit("1");
  const Field f = field(2000, 60000);  // 60000 points need 1.8 MiB
  const MeshDistance mesh(f.soup.vertices, f.soup.triangles, Backend::kOpenCl);
  const auto answers = mesh.query(f.points);
  EXPECT_EQ(mesh.used().backend, Backend::kOpenCl) << mesh.used().reason;
  const auto expected = MeshDistance(f.soup.vertices, f.soup.triangles).query(f.points);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    ASSERT_TRUE(answers[i].distance == expected[i].distance && answers[i].triangle == expected[i].triangle)
        << i;
  }
}

TEST(OpenClDevice, LeavesAMeshThatItsMemoryDoesNotHoldToTheCpuWithAMessage) {
  if (!device()) GTEST_SKIP() << "no OpenCL device";
  const MemoryLimit limit("1");
  const Field f = field(20000, 100);
  const MeshDistance mesh(f.soup.vertices, f.soup.triangles, Backend::kOpenCl);
  EXPECT_EQ(mesh.query(f.points).size(), 100u);
  EXPECT_EQ(mesh.used().backend, Backend::kCpu);
  EXPECT_NE(mesh.used().reason.find("MiB of device memory (limit 0 MiB)"), std::string::npos)
      << mesh.used().reason;
}

bool comes_true(const std::atomic<bool>& what) {
  for (int i = 0; i < 2000 && !what; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  return what;
}

// A query holds its turn at the device while it copies on many threads. Were this one to take up another
// query while it waits for the last of them, that would wait for itself.
TEST(DevicePortions, TakeUpNoOtherWorkWhileTheyCopy) {
  const auto gpu = device();
  if (!gpu) GTEST_SKIP() << "no OpenCL device";
  DeviceKernel kernel = gpu->kernel(kTwiceEach, "twice_each");
  DevicePortions portions(*gpu, sizeof(int), sizeof(int));
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 3);
  std::atomic<bool> copying = false, helped = false;
  std::atomic<int> taken_up = 0;
  const auto asker = std::this_thread::get_id();
  tbb::task_arena(3).execute([&] {
    tbb::task_group other;
    other.run([&] {
      comes_true(copying);
      tbb::task_group waiting;
      for (int i = 0; i < 4; ++i) {
        waiting.run([&] { taken_up += std::this_thread::get_id() == asker ? 1 : 0; });
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      waiting.wait();
    });
    portions.run(
        *gpu, kernel, 0, 1,
        [&](std::size_t, std::size_t, void* into) {
          *static_cast<int*>(into) = 1;
          copying = true;
          tbb::parallel_for(
              tbb::blocked_range<int>(0, 2, 1),
              [&](const auto&) {
                if (std::this_thread::get_id() == asker) {
                  comes_true(helped);
                } else {
                  helped = true;
                  std::this_thread::sleep_for(std::chrono::milliseconds(80));
                }
              },
              tbb::simple_partitioner());
        },
        [](std::size_t, std::size_t, const void*) {});
    copying = false;
    EXPECT_EQ(taken_up, 0);
    other.wait();
  });
  EXPECT_TRUE(helped) << "no thread helped to copy: nothing was tested";
}

TEST(OpenClDevice, IsADeviceErrorWhenThereIsNone) {
  const NoSuchDevice none;
  EXPECT_THROW(OpenClDevice(), DeviceError);
}

TEST(OpenClDevice, LeavesTheWorkToTheCpuWithAMessageWhenThereIsNone) {
  const NoSuchDevice none;
  const MeshDistance mesh(std::vector<Eigen::Vector3d>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                          std::vector<std::array<int, 3>>{{0, 1, 2}}, Backend::kOpenCl);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(mesh.query(std::vector<Eigen::Vector3d>{{0.25, 0.25, 2}})[0].distance, 2);
    EXPECT_EQ(mesh.used().backend, Backend::kCpu);
    EXPECT_NE(mesh.used().reason.find("no such device"), std::string::npos) << mesh.used().reason;
    EXPECT_NE(mesh.used().reason.find("on the CPU"), std::string::npos);
  }
}

}  // namespace
}  // namespace hotblade::gpu

#include "gpu/backend/opencl_device.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

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

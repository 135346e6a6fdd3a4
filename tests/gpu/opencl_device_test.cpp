#include "gpu/opencl_device.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "gpu/mesh_distance.hpp"

namespace hotblade::gpu {
namespace {

constexpr const char* kDouble = R"(
__kernel void twice(__global const int* in, __global int* out, const int add) {
  const int i = (int)get_global_id(0);
  if (i < 4) out[i] = 2 * in[i] + add;
})";

// Names a device that no system has while it lives.
class NoSuchDevice {
 public:
  NoSuchDevice() { setenv("HOTBLADE_OPENCL_DEVICE", "no such device", 1); }
  ~NoSuchDevice() { unsetenv("HOTBLADE_OPENCL_DEVICE"); }
  NoSuchDevice(const NoSuchDevice&) = delete;
  NoSuchDevice& operator=(const NoSuchDevice&) = delete;
};

std::optional<OpenClDevice> device() {
  try {
    return OpenClDevice();
  } catch (const DeviceError&) {
    return std::nullopt;
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

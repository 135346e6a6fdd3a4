#include "gpu/backend/opencl_lane.hpp"

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

namespace hotblade::gpu {
namespace {

std::shared_ptr<void> held(cl_event event) {
  return {event, [](void* p) { clReleaseEvent(static_cast<cl_event>(p)); }};
}

}  // namespace

// A buffer that the driver lays where the device reaches it, mapped for as long as it lives.
std::shared_ptr<void> DeviceLane::host_memory(const OpenClDevice& device, std::size_t bytes) const {
  int code = CL_SUCCESS;
  const std::shared_ptr<void> buffer(
      clCreateBuffer(static_cast<cl_context>(device.context_.get()),
                     CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR, bytes, nullptr, &code),
      [](void* p) {
        if (p != nullptr) clReleaseMemObject(static_cast<cl_mem>(p));
      });
  check_opencl(code, "memory of the host");
  void* const mapped =
      clEnqueueMapBuffer(static_cast<cl_command_queue>(queue_.get()), static_cast<cl_mem>(buffer.get()),
                         CL_TRUE, CL_MAP_READ | CL_MAP_WRITE, 0, bytes, 0, nullptr, nullptr, &code);
  check_opencl(code, "memory of the host");
  return {mapped, [buffer, queue = queue_](void* p) {
            clEnqueueUnmapMemObject(static_cast<cl_command_queue>(queue.get()),
                                    static_cast<cl_mem>(buffer.get()), p, 0, nullptr, nullptr);
            clFinish(static_cast<cl_command_queue>(queue.get()));
          }};
}

void DeviceLane::reserve(const OpenClDevice& device, const Bytes& bytes) {
  if (!queue_) {
    int code = CL_SUCCESS;
    queue_.reset(
        clCreateCommandQueue(static_cast<cl_context>(device.context_.get()),
                             static_cast<cl_device_id>(device.device_), CL_QUEUE_PROFILING_ENABLE, &code),
        [](void* p) {
          if (p != nullptr) clReleaseCommandQueue(static_cast<cl_command_queue>(p));
        });
    check_opencl(code, "command queue");
  }
  if (host_.in < bytes.in) {
    device_in_ = device.allocate(bytes.in);
    in_ = host_memory(device, bytes.in);
    host_.in = bytes.in;
  }
  if (host_.out < bytes.out) {
    device_out_ = device.allocate(bytes.out);
    out_ = host_memory(device, bytes.out);
    host_.out = bytes.out;
  }
  if (host_.scratch < bytes.scratch) {
    scratch_ = device.allocate(bytes.scratch);
    host_.scratch = bytes.scratch;
  }
}

void DeviceLane::start(DeviceKernel& kernel, unsigned first_argument, std::size_t count, std::size_t in_bytes,
                       std::size_t out_bytes) {
  kernel.set(first_argument, device_in_);
  kernel.set(first_argument + 1, device_out_);
  kernel.set(first_argument + 2, static_cast<int>(count));
  if (host_.scratch > 0) kernel.set(first_argument + 3, scratch_);
  auto* const queue = static_cast<cl_command_queue>(queue_.get());
  check_opencl(clEnqueueWriteBuffer(queue, static_cast<cl_mem>(device_in_.memory_.get()), CL_FALSE, 0,
                                    in_bytes, in_.get(), 0, nullptr, nullptr),
               "write");
  const std::size_t items = (count + kDeviceGroup - 1) / kDeviceGroup * kDeviceGroup;
  cl_event computed = nullptr;
  check_opencl(clEnqueueNDRangeKernel(queue, static_cast<cl_kernel>(kernel.kernel_.get()), 1, nullptr, &items,
                                      &kDeviceGroup, 0, nullptr, &computed),
               "launch");
  computed_ = held(computed);
  cl_event fetched = nullptr;
  check_opencl(clEnqueueReadBuffer(queue, static_cast<cl_mem>(device_out_.memory_.get()), CL_FALSE, 0,
                                   out_bytes, out_.get(), 0, nullptr, &fetched),
               "read");
  fetched_ = held(fetched);
  check_opencl(clFlush(queue), "launch");
}

double DeviceLane::finish() {
  auto* const fetched = static_cast<cl_event>(fetched_.get());
  check_opencl(clWaitForEvents(1, &fetched), "run");
  auto* const computed = static_cast<cl_event>(computed_.get());
  cl_ulong from = 0, to = 0;
  check_opencl(clGetEventProfilingInfo(computed, CL_PROFILING_COMMAND_START, sizeof from, &from, nullptr),
               "time of a kernel");
  check_opencl(clGetEventProfilingInfo(computed, CL_PROFILING_COMMAND_END, sizeof to, &to, nullptr),
               "time of a kernel");
  computed_.reset();
  fetched_.reset();
  return static_cast<double>(to - from) * 1e-9;
}

void DeviceLane::abandon() noexcept {
  if (queue_) clFinish(static_cast<cl_command_queue>(queue_.get()));
  computed_.reset();
  fetched_.reset();
}

}  // namespace hotblade::gpu

#include "gpu/backend/opencl_device.hpp"

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <limits>

namespace hotblade::gpu {
namespace {

struct CodeText {
  int code;
  const char* text;
};
constexpr CodeText kTexts[] = {
    {CL_DEVICE_NOT_FOUND, "no device"},
    {CL_DEVICE_NOT_AVAILABLE, "the device is not available"},
    {CL_COMPILER_NOT_AVAILABLE, "the driver has no compiler"},
    {CL_MEM_OBJECT_ALLOCATION_FAILURE, "out of device memory"},
    {CL_OUT_OF_RESOURCES, "out of device resources, a time-out or a lost device"},
    {CL_OUT_OF_HOST_MEMORY, "out of host memory"},
    {CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST, "its work failed, a time-out or a lost device"},
    {CL_BUILD_PROGRAM_FAILURE, "the program does not build"},
    {CL_INVALID_BUFFER_SIZE, "more memory than the device gives to one buffer"},
    {CL_INVALID_COMMAND_QUEUE, "the device's queue is gone, a time-out or a lost device"},
    {-1001, "no OpenCL driver is installed"},
};

std::string text_of(cl_device_id device, cl_device_info what) {
  std::size_t size = 0;
  check_opencl(clGetDeviceInfo(device, what, 0, nullptr, &size), "device facts");
  std::string text(size, '\0');
  check_opencl(clGetDeviceInfo(device, what, size, text.data(), nullptr), "device facts");
  while (!text.empty() && (text.back() == '\0' || text.back() == ' ')) text.pop_back();
  return text;
}

template <typename T>
T value_of(cl_device_id device, cl_device_info what) {
  T value{};
  check_opencl(clGetDeviceInfo(device, what, sizeof value, &value, nullptr), "device facts");
  return value;
}

std::vector<cl_device_id> devices() {
  cl_uint count = 0;
  const int code = clGetPlatformIDs(0, nullptr, &count);
  if (code != CL_SUCCESS || count == 0) throw DeviceError("OpenCL: no OpenCL driver is installed");
  std::vector<cl_platform_id> platforms(count);
  check_opencl(clGetPlatformIDs(count, platforms.data(), nullptr), "platforms");
  std::vector<cl_device_id> all;
  for (cl_platform_id platform : platforms) {
    cl_uint found = 0;
    if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 0, nullptr, &found) != CL_SUCCESS || found == 0)
      continue;
    std::vector<cl_device_id> of_platform(found);
    check_opencl(clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, found, of_platform.data(), nullptr), "devices");
    all.insert(all.end(), of_platform.begin(), of_platform.end());
  }
  return all;
}

int rank(cl_device_id device) {
  const auto type = value_of<cl_device_type>(device, CL_DEVICE_TYPE);
  if ((type & CL_DEVICE_TYPE_GPU) != 0) return 0;
  return (type & CL_DEVICE_TYPE_ACCELERATOR) != 0 ? 1 : 2;
}

// Empty when nobody asked for one.
std::string_view wanted_device() {
  const char* name = std::getenv("HOTBLADE_OPENCL_DEVICE");
  return name == nullptr ? "" : name;
}

cl_device_id choose_device() {
  std::vector<cl_device_id> all = devices();
  if (const std::string_view wanted = wanted_device(); !wanted.empty()) {
    std::erase_if(all, [wanted](cl_device_id device) {
      return text_of(device, CL_DEVICE_NAME).find(wanted) == std::string::npos;
    });
    if (all.empty()) {
      throw DeviceError(std::string("OpenCL: no device is named like HOTBLADE_OPENCL_DEVICE (") +
                        std::string(wanted) + ")");
    }
  }
  std::erase_if(all, [](cl_device_id device) {
    return value_of<cl_bool>(device, CL_DEVICE_AVAILABLE) == CL_FALSE ||
           value_of<cl_bool>(device, CL_DEVICE_COMPILER_AVAILABLE) == CL_FALSE;
  });
  if (all.empty()) throw DeviceError("OpenCL: no device");
  return *std::min_element(all.begin(), all.end(),
                           [](cl_device_id a, cl_device_id b) { return rank(a) < rank(b); });
}

// Bytes of device memory that may be used, of the whole.
std::size_t allowed_memory(std::size_t bytes) {
  const char* const text = std::getenv("HOTBLADE_OPENCL_MEMORY_MIB");
  if (text == nullptr) return bytes;
  std::size_t mib = 0;
  const char* const end = text + std::char_traits<char>::length(text);
  const auto [last, error] = std::from_chars(text, end, mib);
  if (error != std::errc() || last != end || mib == 0 ||
      mib > (std::numeric_limits<std::size_t>::max() >> 20)) {
    throw DeviceError(std::string("OpenCL: HOTBLADE_OPENCL_MEMORY_MIB (") + text +
                      ", a whole number above 0): set it to the MiB that may be used");
  }
  return std::min(bytes, mib << 20);
}

DeviceFacts facts_of(cl_device_id device) {
  DeviceFacts facts;
  facts.name = text_of(device, CL_DEVICE_NAME);
  facts.vendor = text_of(device, CL_DEVICE_VENDOR);
  facts.driver = text_of(device, CL_DRIVER_VERSION);
  facts.has_fp64 = text_of(device, CL_DEVICE_EXTENSIONS).find("cl_khr_fp64") != std::string::npos;
  facts.is_cpu = (value_of<cl_device_type>(device, CL_DEVICE_TYPE) & CL_DEVICE_TYPE_CPU) != 0;
  facts.little_endian = value_of<cl_bool>(device, CL_DEVICE_ENDIAN_LITTLE) != CL_FALSE;
  facts.asked_for = !wanted_device().empty();
  facts.memory_bytes = allowed_memory(value_of<cl_ulong>(device, CL_DEVICE_GLOBAL_MEM_SIZE));
  facts.largest_buffer_bytes =
      std::min<std::size_t>(value_of<cl_ulong>(device, CL_DEVICE_MAX_MEM_ALLOC_SIZE), facts.memory_bytes);
  return facts;
}

std::string build_log(cl_program program, cl_device_id device) {
  std::size_t size = 0;
  clGetProgramBuildInfo(program, device, CL_PROGRAM_BUILD_LOG, 0, nullptr, &size);
  std::string log(size, '\0');
  clGetProgramBuildInfo(program, device, CL_PROGRAM_BUILD_LOG, size, log.data(), nullptr);
  constexpr std::size_t kShown = 400;
  return log.substr(0, kShown);
}

}  // namespace

void check_opencl(int code, const char* what) {
  if (code != CL_SUCCESS) throw DeviceError(std::string("OpenCL: ") + what + ": " + opencl_error_text(code));
}

std::string opencl_error_text(int code) {
  for (const CodeText& known : kTexts) {
    if (known.code == code) return std::string(known.text) + " (code " + std::to_string(code) + ")";
  }
  return "code " + std::to_string(code);
}

void DeviceKernel::set_bytes(unsigned index, const void* value, std::size_t size) {
  check_opencl(clSetKernelArg(static_cast<cl_kernel>(kernel_.get()), index, size, value), "kernel argument");
}

void DeviceKernel::set(unsigned index, const DeviceBuffer& buffer) {
  auto* memory = static_cast<cl_mem>(buffer.memory_.get());
  set_bytes(index, &memory, sizeof memory);
}

DeviceFacts find_opencl_device() {
  return facts_of(choose_device());
}

OpenClDevice::OpenClDevice() {
  cl_device_id device = choose_device();
  device_ = device;
  facts_ = facts_of(device);
  if (!facts_.little_endian)
    throw DeviceError("OpenCL: " + facts_.name + ": the device's byte order is not ours");
  int code = CL_SUCCESS;
  context_.reset(clCreateContext(nullptr, 1, &device, nullptr, nullptr, &code),
                 [](void* p) { clReleaseContext(static_cast<cl_context>(p)); });
  check_opencl(code, "context");
  queue_.reset(clCreateCommandQueue(static_cast<cl_context>(context_.get()), device, 0, &code),
               [](void* p) { clReleaseCommandQueue(static_cast<cl_command_queue>(p)); });
  check_opencl(code, "command queue");
}

void OpenClDevice::require_fp64() const {
  if (!facts_.has_fp64) throw DeviceError("OpenCL: " + facts_.name + ": no double precision (cl_khr_fp64)");
}

std::shared_ptr<void> OpenClDevice::program(std::string_view source, const std::string& name) const {
  const std::lock_guard lock(programs_turn_);
  if (const auto known = programs_.find(source); known != programs_.end()) return known->second;
  int code = CL_SUCCESS;
  const char* text = source.data();
  const std::size_t length = source.size();
  const std::shared_ptr<void> program(
      clCreateProgramWithSource(static_cast<cl_context>(context_.get()), 1, &text, &length, &code),
      [](void* p) { clReleaseProgram(static_cast<cl_program>(p)); });
  check_opencl(code, "program");
  auto* device = static_cast<cl_device_id>(device_);
  auto* built = static_cast<cl_program>(program.get());
  if (code = clBuildProgram(built, 1, &device, "-cl-std=CL1.2", nullptr, nullptr); code != CL_SUCCESS) {
    throw DeviceError("OpenCL: " + name + ": " + opencl_error_text(code) + ": " + build_log(built, device));
  }
  programs_.emplace(source, program);
  return program;
}

DeviceKernel OpenClDevice::kernel(std::string_view source, const std::string& name) const {
  const std::shared_ptr<void> built = program(source, name);
  int code = CL_SUCCESS;
  DeviceKernel kernel;
  kernel.kernel_.reset(clCreateKernel(static_cast<cl_program>(built.get()), name.c_str(), &code),
                       [](void* p) { clReleaseKernel(static_cast<cl_kernel>(p)); });
  check_opencl(code, "kernel");
  return kernel;
}

DeviceBuffer OpenClDevice::allocate(std::size_t bytes) const {
  if (bytes > facts_.largest_buffer_bytes) check_opencl(CL_INVALID_BUFFER_SIZE, "memory");
  DeviceBuffer buffer;
  int code = CL_SUCCESS;
  buffer.bytes_ = std::max<std::size_t>(bytes, 1);
  buffer.memory_.reset(clCreateBuffer(static_cast<cl_context>(context_.get()), CL_MEM_READ_WRITE,
                                      buffer.bytes_, nullptr, &code),
                       [](void* p) { clReleaseMemObject(static_cast<cl_mem>(p)); });
  check_opencl(code, "memory");
  return buffer;
}

DeviceBuffer OpenClDevice::upload(const void* data, std::size_t bytes) const {
  DeviceBuffer buffer = allocate(bytes);
  write(buffer, data, bytes);
  return buffer;
}

void OpenClDevice::write(const DeviceBuffer& buffer, const void* data, std::size_t bytes) const {
  if (bytes == 0) return;
  check_opencl(clEnqueueWriteBuffer(static_cast<cl_command_queue>(queue_.get()),
                                    static_cast<cl_mem>(buffer.memory_.get()), CL_TRUE, 0, bytes, data, 0,
                                    nullptr, nullptr),
               "write");
}

void OpenClDevice::read(const DeviceBuffer& buffer, void* data, std::size_t bytes) const {
  if (bytes == 0) return;
  check_opencl(clEnqueueReadBuffer(static_cast<cl_command_queue>(queue_.get()),
                                   static_cast<cl_mem>(buffer.memory_.get()), CL_TRUE, 0, bytes, data, 0,
                                   nullptr, nullptr),
               "read");
}

void OpenClDevice::run(const DeviceKernel& kernel, std::size_t count) const {
  if (count == 0) return;
  const std::size_t items = (count + kDeviceGroup - 1) / kDeviceGroup * kDeviceGroup;
  check_opencl(clEnqueueNDRangeKernel(static_cast<cl_command_queue>(queue_.get()),
                                      static_cast<cl_kernel>(kernel.kernel_.get()), 1, nullptr, &items,
                                      &kDeviceGroup, 0, nullptr, nullptr),
               "launch");
  check_opencl(clFinish(static_cast<cl_command_queue>(queue_.get())), "run");
}

namespace {

struct Shared {
  std::mutex turn;
  std::weak_ptr<const OpenClDevice> device;
  std::string asked_for;  // device and memory, which a caller may have changed since
};
Shared& shared() {
  static Shared instance;
  return instance;
}

std::string environment() {
  const char* const memory = std::getenv("HOTBLADE_OPENCL_MEMORY_MIB");
  return std::string(wanted_device()) + '\n' + (memory == nullptr ? "" : memory);
}

}  // namespace

std::shared_ptr<const OpenClDevice> shared_opencl_device() {
  Shared& s = shared();
  const std::lock_guard lock(s.turn);
  if (auto device = s.device.lock(); device && s.asked_for == environment()) return device;
  auto device = std::make_shared<const OpenClDevice>();
  s.device = device;
  s.asked_for = environment();
  return device;
}

void forget_opencl_device() {
  Shared& s = shared();
  const std::lock_guard lock(s.turn);
  s.device.reset();
}

}  // namespace hotblade::gpu

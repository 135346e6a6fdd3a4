// Names where distances are computed, and what computed them in the end.
#pragma once

#include <string>

namespace hotblade::gpu {

enum class Backend {
  kAuto,    // whichever is measured to be faster on the work at hand
  kCpu,     // the processor's vector units
  kOpenCl,  // an OpenCL device; the CPU, with a message, when there is none or it fails
};

// Says what answered in the end, and why; messages and run.json show it. Values do not depend on it.
struct BackendUse {
  Backend backend = Backend::kCpu;  // kCpu or kOpenCl
  std::string name = "cpu";         // "cpu", or "opencl" and the device's name
  std::string reason;               // one line; empty when the backend asked for answered
};

}  // namespace hotblade::gpu

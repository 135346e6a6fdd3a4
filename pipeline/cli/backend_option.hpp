// --backend: where distances are computed, for every command that measures some.
#pragma once

#include <string>

#include "gpu/backend/backend.hpp"
#include "pipeline/verify/verify.hpp"

namespace CLI {
class App;
}

namespace hotblade::pipeline {

struct Console;

// Adds --backend auto|cpu|opencl; `name` keeps what is chosen and its value is the default.
void add_backend_option(CLI::App& command, std::string& name);

[[nodiscard]] gpu::Backend backend_named(const std::string& name);

// The backend that answered: "cpu", or the device's name with "opencl" before it; both when the two ways
// were computed by different ones.
[[nodiscard]] std::string backend_text(const VerifyReport& report);

// Says what auto picked and why (with -v), or why the backend asked for did not answer (a warning).
void tell_backend(const VerifyReport& report, gpu::Backend wanted, const Console& console);

}  // namespace hotblade::pipeline

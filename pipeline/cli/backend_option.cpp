#include "pipeline/cli/backend_option.hpp"

#include <CLI/CLI.hpp>

#include "pipeline/cli/command.hpp"

namespace hotblade::pipeline {

void add_backend_option(CLI::App& command, std::string& name) {
  command
      .add_option("--backend", name,
                  "Where distances are computed; auto measures, opencl falls back to the CPU; same results")
      ->check(CLI::IsMember({"auto", "cpu", "opencl"}))
      ->type_name("auto|cpu|opencl");
}

gpu::Backend backend_named(const std::string& name) {
  if (name == "opencl") return gpu::Backend::kOpenCl;
  return name == "cpu" ? gpu::Backend::kCpu : gpu::Backend::kAuto;
}

std::string backend_text(const VerifyReport& report) {
  if (report.to_cut.name == report.to_design.name) return report.to_design.name;
  return report.to_design.name + ", " + report.to_cut.name;
}

void tell_backend(const VerifyReport& report, gpu::Backend wanted, const Console& console) {
  if (wanted == gpu::Backend::kCpu) return;
  const auto tell = [&](const std::string& way, const gpu::BackendUse& use) {
    const std::string line = way + ": " + use.name + (use.reason.empty() ? "" : " (" + use.reason + ")");
    if (wanted == gpu::Backend::kOpenCl && use.backend != wanted && !use.reason.empty()) {
      console.warn("warning: " + line);
    } else {
      console.detail(line);
    }
  };
  tell("distances to the design", report.to_design);
  tell("distances to the cut", report.to_cut);
  if (report.ribs.ribs > 0) tell("distances of the ribs", report.ribs.used);
}

}  // namespace hotblade::pipeline

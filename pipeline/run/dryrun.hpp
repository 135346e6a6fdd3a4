// The dry run: a program streamed over Modbus TCP to a controller simulator on this host, and the proof that
// what it executed is what was planned.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pipeline/program/strip_jobs.hpp"
#include "robot/blade/blade_check.hpp"
#include "robot/client/client.hpp"
#include "robot/controller/arm_scene.hpp"
#include "robot/controller/execution_log.hpp"

namespace hotblade::pipeline {

struct DryRunOptions {
  std::filesystem::path log_file;  // appended to by the simulator; a new file
  robot::MotionLimits limits;
  robot::BladeCheckOptions blade;
  std::shared_ptr<const robot::ArmCell> arms;                               // null: arms are not checked
  std::function<void(const std::string& strip, double fraction)> progress;  // of the whole run
  std::function<bool()> interrupted;
};

// How one strip was streamed, and the proof of what was executed of it.
struct StripDryRun {
  std::string strip;
  double planned_s = 0;
  robot::StreamReport stream;
  robot::ExecutionProof proof;
  [[nodiscard]] bool holds() const { return stream.outcome == robot::StreamOutcome::kDone && proof.holds(); }
};

struct DryRunReport {
  std::vector<StripDryRun> strips;  // those that were streamed; ends with the first that failed
  std::size_t planned_strips = 0;
  bool interrupted = false;
  [[nodiscard]] bool holds() const;
};

// Streams one strip after the other, as fast as data comes, and returns the comparison of the log with the
// plan. Throws Error (kFile) when the log cannot be written, kController when the simulator cannot be
// started.
[[nodiscard]] DryRunReport dry_run(const std::vector<robot::Job>& jobs, const DryRunOptions& options);

}  // namespace hotblade::pipeline

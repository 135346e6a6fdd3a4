// A program that a simulated controller has executed.
#pragma once

#include <gtest/gtest.h>

#include <fstream>

#include "pipeline/program/program.hpp"
#include "pipeline/program/strip_jobs.hpp"
#include "pipeline/run/dryrun.hpp"
#include "tests/pipeline/temporary_directory.hpp"

namespace hotblade::pipeline::testing {

// A program as a simulator executed it.
struct Executed {
  TemporaryDirectory directory;
  StripJobs work;
  std::filesystem::path log;

  explicit Executed(Program program) : log(directory / "execution.jsonl") {
    const auto file = directory / "program.json";
    std::ofstream(file) << to_json(program);
    work = read_strip_jobs(file, true);
    DryRunOptions options;
    options.log_file = log;
    options.limits = planned_limits(work.program);
    options.blade = planned_blade(work.program);
    const DryRunReport report = dry_run(work.jobs, options);
    EXPECT_TRUE(report.holds()) << report.strips.back().stream.message;
  }
};

}  // namespace hotblade::pipeline::testing

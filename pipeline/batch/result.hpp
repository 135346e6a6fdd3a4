// The result of one plan: a directory that is there whole or not at all, with result.json beside the plan's
// own files.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/batch/batch.hpp"

namespace hotblade::pipeline::batch {

// The verdict of a plan that passed, and the colour of one whose error budget is over its tolerance.
inline constexpr const char *kPassed = "passed", *kAmber = "amber";

inline constexpr const char* kReportFile = "report.json";

struct ResultFile {
  std::string name;  // from the directory
  std::uintmax_t bytes = 0;
  std::string sha256;
};

struct Result {
  std::size_t job = 0;  // the first of its key when it was planned
  std::string panel, key;
  int exit = 0;                  // of the plan
  std::string verdict, message;  // the message says why it is not passed
  int attempts = 1;
  double seconds = 0, cpu_s = 0, peak_mb = 0;
  std::string node{}, engine_job{};  // where it ran, and the scheduler's job
  std::string version{}, simd{};
  std::string started{}, finished{};  // UTC
  std::string color{};                // of the plan's verdict: green, amber or red; empty: not known
  std::vector<ResultFile> files{};
};

// Returns the verdict of a plan that ended with this exit code: passed, refused, over tolerance or bad input;
// absent where it has no result but failed.
[[nodiscard]] std::optional<std::string> verdict_of_exit(int exit_code);

[[nodiscard]] std::string result_text(const Result& result);

// Returns the result of a directory. Throws Error: kFile when it cannot be read, kBadInput when it is none.
[[nodiscard]] Result read_result(const std::filesystem::path& directory);

// Returns whether the key has a result: one that can be read, with its report, and no file of another size
// than it had. What a damaged disk or an interrupted copy left is none, and is planned again.
[[nodiscard]] bool has_result(const BatchDirectory& directory, const std::string& key);

// Returns the time now as 2026-01-31T12:00:00Z.
[[nodiscard]] std::string utc_now();

}  // namespace hotblade::pipeline::batch

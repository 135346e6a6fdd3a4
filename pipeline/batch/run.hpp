// Plans the jobs of chunks, each as a process of its own. Whatever stops it, a result is there whole or not
// at all, and the same call goes on with what is missing; two runners of one chunk share it.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "pipeline/batch/batch.hpp"

namespace hotblade::pipeline::batch {

struct RunOptions {
  int jobs = 1;  // processes at once
  double limit_s = 1800;
  int limit_mb = 4000;
  std::filesystem::path program;  // that plans: hotblade
};

// A job that has no result after three tries.
struct Failure {
  std::size_t job = 0;
  std::string panel, key;
  int attempts = 0;
  std::string why;                      // exit code 1, signal 11, over its 1800 s
  std::vector<std::string> last_lines;  // of its stderr
};

struct RunReport {
  std::size_t plans = 0, there = 0, planned = 0;  // of the chunks; with a result before; planned now
  std::vector<Failure> failures;
};

struct RunHooks {
  std::function<void(std::size_t done, std::size_t all)> progress = nullptr;
  std::function<void(const Failure&)> failed = nullptr;
  std::function<bool()> stop = nullptr;  // asked twice a second
};

// Plans what has no result in these chunks, and stamps each chunk all of whose jobs have one; the jobs that
// failed stand in its failures. The caller has to be the process's only thread but for sleeping ones. Throws
// Error: kFile (a full disk among them); kBadInput when the directory is not as `batch init` left it or is of
// another version of this program; kBadSettings when this machine lacks its instruction set; kInterrupted.
[[nodiscard]] RunReport run_chunks(const BatchDirectory& directory, const std::vector<int>& chunks,
                                   const RunOptions& options, const RunHooks& hooks);

// Returns the failures of a chunk that were left by the last run of it. Throws Error as read_csv() does.
[[nodiscard]] std::vector<Failure> read_failures(const BatchDirectory& directory, int chunk);

}  // namespace hotblade::pipeline::batch

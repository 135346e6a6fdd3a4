// The files of a batch in its directory: what was asked, every job with its key, the chunks that they are
// planned in, and where the results go. A job is a panel in one case of the sweeps; jobs of the same key are
// one plan.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/batch/asked.hpp"

namespace hotblade::pipeline::batch {

struct Batch {
  Asked asked;
  std::string version, commit, simd;                         // of the plans, part of every key
  std::size_t panels = 0, designs = 0, jobs = 0, plans = 0;  // designs and plans: those that differ
  double estimate_s = 0;                                     // of a plan on a core of its own
  int chunks = 1;
  int threads = 1, mem_mb = 0, minutes = 0;  // what a chunk asks a cluster for
  std::string jobs_sha256{};                 // of jobs.csv
};

struct Job {
  std::size_t number = 0;  // from 1
  std::string panel, key;
  int chunk = 0;
  std::vector<std::string> values;  // of JobTable::keys
};
struct JobTable {
  std::vector<std::string> keys;  // settings that change from job to job
  std::vector<Job> jobs;
};

// One line of a chunk's list. It says nothing of names and numbers of jobs, so that it stays the same when
// others change.
struct PlannedKey {
  std::string key, design_sha256, settings_sha256;
};

class BatchDirectory {
 public:
  explicit BatchDirectory(std::filesystem::path directory) : directory_(std::move(directory)) {}

  [[nodiscard]] const std::filesystem::path& path() const { return directory_; }
  [[nodiscard]] std::filesystem::path batch() const { return directory_ / "batch.json"; }
  [[nodiscard]] std::filesystem::path jobs() const { return directory_ / "jobs.csv"; }
  [[nodiscard]] std::filesystem::path design(const std::string& sha256) const;
  [[nodiscard]] std::filesystem::path settings(const std::string& sha256) const;
  [[nodiscard]] std::filesystem::path chunk(int number) const;
  [[nodiscard]] std::filesystem::path stamp(int number) const;  // of a chunk all of whose jobs have results
  [[nodiscard]] std::filesystem::path failures(
      int number) const;  // of a chunk, a line a job that was given up
  [[nodiscard]] std::filesystem::path results() const { return directory_ / "results"; }
  [[nodiscard]] std::filesystem::path result(const std::string& key) const;

 private:
  std::filesystem::path directory_;
};

// Returns what is in the directory. Throw Error: kFile when it is missing or cannot be read, kBadInput when
// it is not as `batch init` left it.
[[nodiscard]] Batch read_batch(const BatchDirectory& directory);
[[nodiscard]] JobTable read_jobs(const BatchDirectory& directory, const Batch& batch);
[[nodiscard]] std::vector<PlannedKey> read_chunk(const BatchDirectory& directory, int number);

// Returns the same, as they have to be for these jobs. Throws Error (kBadInput) besides where a key of a job
// of the chunk is missing.
[[nodiscard]] std::vector<PlannedKey> read_chunk(const BatchDirectory& directory, int number,
                                                 const JobTable& table);

// Return the texts of these files.
[[nodiscard]] std::string batch_text(const Batch& batch);
[[nodiscard]] std::string jobs_text(const JobTable& table);
[[nodiscard]] std::string chunk_text(const std::vector<PlannedKey>& keys);

}  // namespace hotblade::pipeline::batch

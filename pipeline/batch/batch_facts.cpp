#include "pipeline/batch/batch_facts.hpp"

#include <fmt/format.h>

#include <utility>

#include "pipeline/batch/result.hpp"
#include "pipeline/batch/run.hpp"
#include "pipeline/settings/error.hpp"

namespace hotblade::pipeline::batch {
namespace {

[[noreturn]] void fail_missing(const BatchDirectory& directory, const Job& job) {
  throw Error(ErrorKind::kFile,
              fmt::format("{}: job {} (panel {}) has no result: run chunk {}, or ask again with --partial",
                          directory.path().string(), job.number, job.panel, job.chunk));
}

}  // namespace

std::vector<JobFacts> BatchFacts::rows() const {
  std::vector<JobFacts> rows;
  rows.reserve(table.jobs.size());
  for (const Job& job : table.jobs) rows.push_back({&job, &of_key.at(job.key)});
  return rows;
}

BatchFacts read_facts(const BatchDirectory& directory, bool partial, const GatherHooks& hooks) {
  BatchFacts all;
  all.batch = read_batch(directory);
  all.table = read_jobs(directory, all.batch);
  std::map<std::string, Failure> failures;  // by key
  for (int chunk = 0; chunk < all.batch.chunks; ++chunk) {
    for (PlannedKey& planned : read_chunk(directory, chunk, all.table)) {
      const std::string key = planned.key;
      all.planned.emplace(key, std::move(planned));
    }
    for (Failure& failure : read_failures(directory, chunk)) {
      const std::string key = failure.key;
      failures.insert_or_assign(key, std::move(failure));
    }
  }
  double read = 0;
  for (const Job& job : all.table.jobs) {
    if (hooks.stop && hooks.stop()) throw Error(ErrorKind::kInterrupted, "interrupted: nothing was written");
    if (hooks.progress) hooks.progress(++read / static_cast<double>(all.table.jobs.size()));
    const bool there = has_result(directory, job.key);
    all.missing += there ? 0U : 1U;
    if (all.of_key.contains(job.key)) continue;
    if (!there && !partial) fail_missing(directory, job);
    const auto failure = failures.find(job.key);
    all.of_key.emplace(job.key,
                       there ? facts_of(directory, job.key)
                             : facts_of_failure(failure != failures.end() ? &failure->second : nullptr));
  }
  return all;
}

}  // namespace hotblade::pipeline::batch

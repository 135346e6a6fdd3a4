#include "pipeline/batch/status.hpp"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "pipeline/batch/measured.hpp"
#include "pipeline/batch/result.hpp"

namespace hotblade::pipeline::batch {
BatchStatus status_of(const BatchDirectory& directory) {
  BatchStatus status;
  status.batch = read_batch(directory);
  std::vector<double> seconds;
  for (int chunk = 0; chunk < status.batch.chunks; ++chunk) {
    std::error_code ignored;
    status.chunks_done += std::filesystem::exists(directory.stamp(chunk), ignored) ? 1 : 0;
    for (const PlannedKey& planned : read_chunk(directory, chunk)) {
      if (!has_result(directory, planned.key)) continue;
      const Result result = read_result(directory.result(planned.key));
      ++status.results;
      ++status.verdicts[result.verdict];
      if (result.verdict == kPassed && !result.color.empty()) ++status.colors[result.color];
      seconds.push_back(result.seconds);
    }
    for (Failure& failure : read_failures(directory, chunk)) {
      if (!has_result(directory, failure.key)) status.failures.push_back(std::move(failure));
    }
  }
  const double each = seconds.empty() ? status.batch.estimate_s : median_of(seconds);
  status.left_s = each * static_cast<double>(status.batch.plans - status.results);
  return status;
}

nlohmann::ordered_json to_json(const BatchStatus& status) {
  nlohmann::ordered_json json{{"jobs", status.batch.jobs},     {"plans", status.batch.plans},
                              {"results", status.results},     {"verdicts", status.verdicts},
                              {"chunks", status.batch.chunks}, {"chunks_done", status.chunks_done},
                              {"left_s", status.left_s},       {"failed", nlohmann::ordered_json::array()},
                              {"colors", status.colors}};
  for (const Failure& f : status.failures) {
    json["failed"].push_back(
        {{"job", f.job}, {"panel", f.panel}, {"key", f.key}, {"attempts", f.attempts}, {"why", f.why}});
  }
  return json;
}

}  // namespace hotblade::pipeline::batch

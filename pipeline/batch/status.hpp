// How far a batch is.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "pipeline/batch/batch.hpp"
#include "pipeline/batch/run.hpp"

namespace hotblade::pipeline::batch {

struct BatchStatus {
  Batch batch;
  std::size_t results = 0;                      // of Batch::plans
  std::map<std::string, std::size_t> verdicts;  // of the results
  std::map<std::string, std::size_t> colors;    // of the plans that passed: green, amber
  int chunks_done = 0;
  std::vector<Failure> failures;  // of the last run of each chunk, without a result since
  double left_s = 0;              // one plan after another, by the median of the results or by estimate
};

// Throws Error as read_batch() does.
[[nodiscard]] BatchStatus status_of(const BatchDirectory& directory);

// Returns it as `batch status --json` has it.
[[nodiscard]] nlohmann::ordered_json to_json(const BatchStatus& status);

}  // namespace hotblade::pipeline::batch

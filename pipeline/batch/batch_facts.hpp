// What is known of every job of a batch: the facts of its plan, or of how it failed.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "pipeline/batch/batch.hpp"
#include "pipeline/batch/plan_facts.hpp"

namespace hotblade::pipeline::batch {

struct GatherHooks {
  std::function<void(double share)> progress = nullptr;
  std::function<bool()> stop = nullptr;
};

// A job with the facts of its plan, which other jobs may share.
struct JobFacts {
  const Job* job = nullptr;
  const PlanFacts* facts = nullptr;
};

struct BatchFacts {
  Batch batch;
  JobTable table;
  std::map<std::string, PlannedKey> planned;  // by key
  std::map<std::string, PlanFacts> of_key;    // by key
  std::size_t missing = 0;                    // jobs without a result

  // Returns every job with its facts, in the order of the jobs. They point into this object.
  [[nodiscard]] std::vector<JobFacts> rows() const;
};

// Reads all results. A job without one is an error, unless `partial`: then it has the verdict `failed` with
// what is known of it, or `missing`. Throws Error: kFile for a missing result, kBadInput for a result that
// cannot be read, kInterrupted.
[[nodiscard]] BatchFacts read_facts(const BatchDirectory& directory, bool partial, const GatherHooks& hooks);

}  // namespace hotblade::pipeline::batch

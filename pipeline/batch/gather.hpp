// All results of a batch in three files: results.csv, results.sqlite and index.html, each written whole.
#pragma once

#include <functional>

#include "pipeline/batch/batch.hpp"

namespace hotblade::pipeline::batch {

struct GatherReport {
  std::size_t jobs = 0, missing = 0;  // missing: without a result
};

struct GatherHooks {
  std::function<void(double share)> progress = nullptr;
  std::function<bool()> stop = nullptr;
};

// Gathers all results. A job without one is an error, unless `partial`: then it has the verdict `failed` with
// what is known of it, or `missing`. Throws Error: kFile for a missing result or a file that cannot be
// written, kBadInput for a result that cannot be read, kInterrupted.
[[nodiscard]] GatherReport gather(const BatchDirectory& directory, bool partial, const GatherHooks& hooks);

}  // namespace hotblade::pipeline::batch

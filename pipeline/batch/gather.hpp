// All results of a batch in files: results.csv, results.sqlite, index.html, and the blocks that are cut in
// cut_list.csv and cut_list.html, and the foam they are sawn out of in foam.csv and foam.html. Each is
// written whole.
#pragma once

#include "pipeline/batch/batch_facts.hpp"
#include "pipeline/batch/cut_list.hpp"
#include "pipeline/batch/foam_list.hpp"

namespace hotblade::pipeline::batch {

struct GatherReport {
  std::size_t jobs = 0, missing = 0;  // missing: without a result
};

// Gathers all results into these files; those of the foam where the settings of a plan say what is sold
// (stock.sizes_mm), and where none does no earlier ones are left. Throws Error as read_facts() does, and
// kFile for a file that cannot be written.
[[nodiscard]] GatherReport gather(const BatchDirectory& directory, bool partial, const GatherHooks& hooks);

struct StockReport {
  CutList list;
  FoamList foam;
  std::size_t missing = 0;  // jobs without a result
};

// Writes the cut list and the foam alone, blocks' sizes to the next whole `step_mm`, and returns them. Throws
// as gather() does.
[[nodiscard]] StockReport list_stock(const BatchDirectory& directory, bool partial, double step_mm,
                                     const GatherHooks& hooks);

}  // namespace hotblade::pipeline::batch

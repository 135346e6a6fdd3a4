// index.html of a batch: one page with totals and a table of all jobs that sorts and filters, without
// network.
#pragma once

#include <string>
#include <vector>

#include "pipeline/batch/batch_facts.hpp"

namespace hotblade::pipeline::batch {

// Returns the page; what has failed or did not pass comes first. `name` is the batch's.
[[nodiscard]] std::string index_page(const std::string& name, const JobTable& table,
                                     const std::vector<JobFacts>& rows);

}  // namespace hotblade::pipeline::batch

// The cut list as a page to print.
#pragma once

#include <string>

#include "pipeline/batch/cut_list.hpp"

namespace hotblade::pipeline::batch {

// Returns cut_list.html: foam and machine hours, the blades, the blocks by size, and a line to tick off for
// each block in the order of cutting, with a heading wherever the blade is changed. `name` is the batch's.
// It needs no network and no script.
[[nodiscard]] std::string cut_page(const std::string& name, const CutList& list);

}  // namespace hotblade::pipeline::batch

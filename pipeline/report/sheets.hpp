// sheets.html: what the floor works from, on paper. A page with the job's parts list, one with all blocks in
// their places, and one for each block: its size, how it stands, its name and where to write it, its datum
// edges, the blade to mount, where it enters and leaves, order, minutes, templates and neighbours. One
// self-contained page without a script, A4 in print, in the language of job.language.
#pragma once

#include <string>

#include "pipeline/plan/plan.hpp"

namespace hotblade::pipeline {

// Returns the page's text, which depends on the arguments alone. `program_sha256` is that of the program.json
// beside it: its first letters stand on every sheet.
[[nodiscard]] std::string sheets_html(const PlanResult& result, const std::string& program_sha256);

}  // namespace hotblade::pipeline

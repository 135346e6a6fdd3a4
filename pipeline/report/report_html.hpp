// report.html: one self-contained page (no script, no network) that says whether a design can be cut, how
// well, and why not. Its figures are those of report.json.
#pragma once

#include <string>
#include <vector>

#include "pipeline/plan/plan.hpp"

namespace hotblade::pipeline {

struct ReportPicture {
  std::string caption;
  std::string png;  // bytes of a PNG file
};

// The page's text, which depends on the arguments alone. `picture_note` says why there are no pictures,
// where there are none; `program_sha256` is that of the program.json beside the page, empty where there is
// none.
[[nodiscard]] std::string report_html(const PlanResult& result, const std::vector<ReportPicture>& pictures,
                                      const std::string& picture_note,
                                      const std::string& program_sha256 = "");

}  // namespace hotblade::pipeline

// report.html: one self-contained page (no other file, no network) that says whether a design can be cut, how
// well, and why not. Its figures are those of report.json; without a script it reads whole.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/plan/plan.hpp"
#include "pipeline/report/viewer_scene.hpp"

namespace hotblade::pipeline {

struct ReportPicture {
  std::string caption;
  std::string png;  // bytes of a PNG file
};

// The page's text, which depends on the arguments alone. `picture_note` says why there are no pictures,
// where there are none; `program_sha256` is that of the program.json beside the page, empty where there is
// none; `view` is the scene of the interactive view, absent where there is to be none.
[[nodiscard]] std::string report_html(const PlanResult& result, const std::vector<ReportPicture>& pictures,
                                      const std::string& picture_note, const std::string& program_sha256 = "",
                                      const std::optional<ViewerScene>& view = {});

}  // namespace hotblade::pipeline

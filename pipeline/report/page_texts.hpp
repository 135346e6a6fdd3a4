// The script of report.html and the styles of the pages, as the build embeds them from the files beside this
// one.
#pragma once

#include <string_view>

namespace hotblade::pipeline {

[[nodiscard]] std::string_view viewer_script();  // viewer.js
[[nodiscard]] std::string_view page_style();     // page.css
[[nodiscard]] std::string_view sheets_style();   // sheets.css

}  // namespace hotblade::pipeline

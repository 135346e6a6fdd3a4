// The script and the style of report.html, as the build embeds them from the files beside this one.
#pragma once

#include <string_view>

namespace hotblade::pipeline {

[[nodiscard]] std::string_view viewer_script();  // viewer.js
[[nodiscard]] std::string_view page_style();     // page.css

}  // namespace hotblade::pipeline

// The view of report.html: its controls, its scene and the script that draws it, around the still picture
// that stands in for it.
#pragma once

#include <string>

#include "pipeline/report/viewer_scene.hpp"
#include "pipeline/report/words.hpp"

namespace hotblade::pipeline {

// Returns the view around `still`, the HTML of the picture that print, a browser without script and one
// without WebGL 2 show in its place.
[[nodiscard]] std::string viewer_html(const ViewerScene& scene, const std::string& still, const Words& w);

}  // namespace hotblade::pipeline

// The pictures of a report: what is cut, from three sides.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/plan/plan.hpp"
#include "pipeline/program/refused_plan.hpp"
#include "pipeline/report/report_html.hpp"
#include "pipeline/report/words.hpp"
#include "surface/read/design_surface.hpp"

namespace hotblade::pipeline {

struct ReportPictures {
  std::vector<ReportPicture> pictures;
  std::string note;        // why there are none
  std::string scene_gltf;  // the same scene for viewers; empty: not asked for
  std::optional<ViewerScene> view{};
};

// Returns why a plan is refused, in the words and with the places.
[[nodiscard]] std::vector<RefusedReason> refused_reasons(const PlanResult& result, const Words& w);

// What `plan --pictures` says: none, the first alone of 320 x 180 pixels and no scene.gltf (of thousands of
// plans it is what is looked at), or all of them.
enum class Pictures { kNone, kThumb, kFull };
[[nodiscard]] std::optional<Pictures> pictures_named(const std::string& name);

// Returns the pictures of a plan, drawn without a display, and the scene of its view. A machine that cannot
// draw gets no pictures and a note, never an error: the figures do not depend on pictures, and the view is
// drawn where it is looked at. `progress` is told the share that is done.
[[nodiscard]] ReportPictures take_pictures(
    const PlanResult& result, const surface::DesignSurface& design, Pictures pictures = Pictures::kFull,
    Viewer viewer = Viewer::kNone, const std::function<void(double)>& progress = [](double) {});

}  // namespace hotblade::pipeline

// The pictures of a report: what is cut, from three sides.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "pipeline/plan/plan.hpp"
#include "pipeline/program/refused_plan.hpp"
#include "pipeline/report/report_html.hpp"
#include "surface/read/design_surface.hpp"

namespace hotblade::pipeline {

struct ReportPictures {
  std::vector<ReportPicture> pictures;
  std::string note;        // why there are none
  std::string scene_gltf;  // the same scene for viewers; empty: not asked for
};

// Returns why a plan is refused, in words and with the places.
[[nodiscard]] std::vector<RefusedReason> refused_reasons(const PlanResult& result);

// The pictures of a plan, drawn without a display. A machine that cannot draw gets none and a note, never an
// error: the figures do not depend on pictures. `progress` is told the share that is done.
[[nodiscard]] ReportPictures take_pictures(
    const PlanResult& result, const surface::DesignSurface& design,
    const std::function<void(double)>& progress = [](double) {});

// The first of them alone, of 320 x 180 pixels, and no scene: of thousands of plans it is what is looked at.
[[nodiscard]] ReportPictures take_thumbnail(const PlanResult& result, const surface::DesignSurface& design);

}  // namespace hotblade::pipeline

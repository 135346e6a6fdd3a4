// A strip as it is handed out: each rib in its own frame, with the Beziers that stand for it.
#pragma once

#include <vector>

#include "pipeline/plan/ribs/strip_plan.hpp"
#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

// Returns the strip with its poses. A rib's Bezier is the fit's where that lies within kBezierShare of the
// tolerance of the elastica, as few cubics as do where it does not (elastica/fit/bezier_spline.hpp).
[[nodiscard]] Strip make_strip(const StripPlan& plan, std::vector<BladePose> poses, double tolerance_mm);

}  // namespace hotblade::pipeline

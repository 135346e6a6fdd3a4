// What the commands `check` and `plan` and the Python module share: what is said of a design before it is
// planned, plans held against a cell, and plans with other settings.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/advice/advice.hpp"
#include "pipeline/plan/forecast.hpp"
#include "pipeline/plan/plan.hpp"
#include "robot/arm/cell.hpp"
#include "surface/read/design_surface.hpp"

namespace hotblade::pipeline {

// Throws Error (kBadInput) where the design cannot be sliced.
void refuse_blocked(const surface::DesignSurface& design, const std::string& file);

// Returns the forecast; absent for a design that cannot be sliced or has no area. A size of which hardly
// anything could be cut, and planes given in which most is lost, are added to the design's warnings. Throws
// surface::FanError as forecast() does.
[[nodiscard]] std::optional<Forecast> forecast_of(surface::DesignSurface& design, const Settings& settings);

// Returns what a plan begins with, in the same way; nothing where there would be no forecast.
[[nodiscard]] FirstLook first_look_of(surface::DesignSurface& design, const Settings& settings);

// Returns what of a size is a warning: that hardly anything could be cut.
[[nodiscard]] std::optional<std::string> warning_of(const std::optional<OddSize>& odd);

// With --strict a warning is as good as a limit.
void refuse_warnings(PlanResult& result);

// Gives a plan its arms, or refuses it by what stands in their way. A plan that is refused already keeps its
// own reasons.
void hold_in_cell(const surface::DesignSurface& design, const robot::Cell& cell, gpu::Backend backend,
                  PlanResult& result);

// Reads the design again as other settings say.
using ReadAgain = std::function<surface::DesignSurface(const DesignSettings&)>;
// Judges a plan of a design beyond what the planner does.
using JudgeAgain = std::function<void(const surface::DesignSurface&, PlanResult&)>;

// Reads the design and plans it with other settings, judged alike: by `judge` too, before warnings are.
[[nodiscard]] PlanResult plan_again(
    const ReadAgain& read, const Settings& settings, const PlanHooks& hooks, bool strict,
    const JudgeAgain& judge = [](const surface::DesignSurface&, PlanResult&) {});

// Returns lines that say which changes were tried and passed, or that none did.
[[nodiscard]] std::vector<std::string> tried_lines(const std::vector<TriedRemedy>& remedies);

// Said where changes were not tried.
inline constexpr const char* kAdviseHint =
    "--advise plans the job again with what may help, and says what passed";

}  // namespace hotblade::pipeline

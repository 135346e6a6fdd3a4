// The cell that a simulated controller checks its arms by.
#pragma once

#include <memory>
#include <string>

#include "pipeline/program/strip_jobs.hpp"
#include "pipeline/settings/settings.hpp"
#include "robot/controller/arm_scene.hpp"

namespace hotblade::pipeline {

// Returns what a controller knows of the arms of a cell's file or name, with the blocks of jobs where they
// are at hand; null for an empty name. Throws as read_cell does.
[[nodiscard]] std::shared_ptr<const robot::ArmCell> controller_cell(const std::string& file_or_name,
                                                                    const MotionSettings& motion,
                                                                    const StripJobs* work);

}  // namespace hotblade::pipeline

// Where each block is: in the design, and on the table.
#pragma once

#include <Eigen/Core>
#include <string>

#include "pipeline/plan/plan.hpp"
#include "pipeline/report/block_stand.hpp"
#include "pipeline/report/words.hpp"

namespace hotblade::pipeline {

// Returns the middle of a block.
[[nodiscard]] Eigen::Vector3d middle_of(const Block& block);

// Returns a place or a size in whole mm: "12, -3, 40" or "12 x 3 x 40".
[[nodiscard]] std::string place_text(const Eigen::Vector3d& mm);
[[nodiscard]] std::string size_text(const Eigen::Vector3d& mm);

// Returns where the left front lower corner of a block is on the table, and how it is turned about it, where
// it is: "-160, -45, 250, turned about it by 15.0°, clockwise as seen from above".
[[nodiscard]] std::string corner_text(const BlockStand& stand, const Words& w);

// Returns the page's section as HTML, a row a block, with links to the sheets where there are some; empty
// when there are no strips.
[[nodiscard]] std::string places_section(const PlanResult& result, const Words& w, bool with_sheets);

}  // namespace hotblade::pipeline

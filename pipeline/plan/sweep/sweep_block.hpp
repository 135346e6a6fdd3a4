// The block of a swept strip, before there is a strip: its size, and what the planes see of it.
#pragma once

#include <Eigen/Core>

#include "pipeline/plan/sweep/sweep_fit.hpp"
#include "pipeline/plan/sweep/sweep_sections.hpp"
#include "pipeline/settings/settings.hpp"

namespace hotblade::pipeline {

// A family goes on by so much past the ends of a design.
inline constexpr double kOverMm = 4;

// Returns how far that is at an end; at a seam it goes as far as its samples do.
[[nodiscard]] double over_first_mm(const SweepData& data);
[[nodiscard]] double over_last_mm(const SweepData& data);

// Returns the block's edges, ascending.
[[nodiscard]] Eigen::Vector3d stock_for(const SweepData& data, const StockSettings& stock);

// Returns a box that holds the block and `clear_mm` beyond its border in every plane, on the planes' axes. A
// fan's planes cut the block askew, the first and the last one the most.
[[nodiscard]] SweepFitOptions::Box block_in_planes(const SweepData& data, const StockSettings& stock,
                                                   double clear_mm);

}  // namespace hotblade::pipeline

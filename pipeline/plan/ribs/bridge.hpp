// Ribs that go on across windows and notches: what the blade is to follow where there is no design.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

namespace hotblade::pipeline {

// Points in mm, in order, strictly between the last of `before` and the first of `after`, each of at least
// two different points: the curve of sixth degree over the gap's chord that passes through both of these and
// nearest, by least squares, to what lies within half the gap's width of it on either side, with a slight
// pull to lower degrees where that says little. Facets hardly show in it, as tangents of single edges would.
// Off a circle across an angle of 0.2, 0.4 and 0.6 rad by 3e-7, 2e-5 and 2e-4 of its radius. Nothing when the
// pieces turn by a right angle or more from the gap's chord there.
[[nodiscard]] std::optional<std::vector<Eigen::Vector2d>> fill_gap(std::span<const Eigen::Vector2d> before,
                                                                   std::span<const Eigen::Vector2d> after);

}  // namespace hotblade::pipeline

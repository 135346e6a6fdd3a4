// Points of a polyline as fits want them.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace hotblade::elastica {

// Fewer points say too little of a curve for a fit.
inline constexpr std::size_t kFewestFitPoints = 8;

// Returns n >= 2 points evenly spaced by arc length along a line of at least two points.
[[nodiscard]] std::vector<Eigen::Vector2d> evenly_spaced(std::span<const Eigen::Vector2d> line, int n);

// Returns 129 points evenly spaced by the polyline's length; those that already are, up to 1025 of them, come
// back as they are, since samples of a curve say more than their chords. Empty where all points are the same.
[[nodiscard]] std::vector<Eigen::Vector2d> even_points(const std::vector<Eigen::Vector2d>& points);

}  // namespace hotblade::elastica

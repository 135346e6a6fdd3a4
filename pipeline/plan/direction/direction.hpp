// Which way the rib planes face: directions along the design's straight borders, over the hemisphere of its
// own axes and across its least steep way, and fans about axes that the design itself has
// (pipeline/plan/direction/fan_axes.hpp), in one ranking.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "pipeline/plan/direction/direction_score.hpp"

namespace hotblade::pipeline {

// Which candidates are planned coarsely: kBounded leaves out those that a bound says cannot be the best, kAll
// leaves out none, for checks of the search itself.
enum class DirectionSearch { kBounded, kAll };

// Told before every direction that is tried, from all threads; what it throws ends the search at once.
using WatchDirections = std::function<void()>;

// Returns the ranking, best first: those planned coarsely, then those whose bound was no better than the best
// plan. Scores that differ by 0.05 at most are equal; of equals the one named first is taken. The best
// direction is then refined in its neighbourhood. With slice.direction or slice.fan_axis set that one alone
// is scored. Throws surface::FanError for a slice.fan_axis that does not go with the design. Candidates are
// the body's own, so turning the input turns the answer; where its axes are not told apart by the area (a
// square, a circle) the farthest vertex does. n and -n are one direction: the sense is that of the area's
// skewness.
[[nodiscard]] std::vector<DirectionScore> rank_directions(
    const surface::DesignSurface& design, const Settings& settings,
    DirectionSearch search = DirectionSearch::kBounded, const WatchDirections& watch = [] {});

// Returns the index in a ranking of the best of those planned coarsely that is not nearly one that was
// refused.
[[nodiscard]] std::optional<std::size_t> next_direction(const std::vector<DirectionScore>& ranking);

}  // namespace hotblade::pipeline

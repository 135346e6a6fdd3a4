// How a blade goes on at its own places, where the part of it that is in foam slides along it: at a border
// that lies at a small angle to the ribs, places at equal shares of that part move along the blade by far
// more than across it, and what they move across is no larger than what clamps are told in.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

// At even places of a blade's part in foam, what the same places of the blade do about its pose.
struct RowWay {
  std::vector<Eigen::Vector3d> sweep;  // the direction in which they go, of any length
  // Over a step of the way, mm, the unit normal of the surface that they pass turns by `turn`, and the normal
  // of the blade's plane by `width_turn`.
  std::vector<Eigen::Vector3d> step, turn;
  Eigen::Vector3d width_turn{0, 0, 0};
};

// Returns that of one of some poses of a strip in order, all in foam, by those before and behind whose blades
// are about `apart_mm` away across it; nothing where there are none.
[[nodiscard]] std::optional<RowWay> row_way(std::span<const BladePose* const> poses, std::size_t row,
                                            std::size_t columns, double apart_mm);

// The direction of a curve through three points at the first of them, of any length: that of the parabola
// through them. `before` and `behind` are its neighbours, or the next two on one side.
[[nodiscard]] Eigen::Vector3d direction_at(const Eigen::Vector3d& p, const Eigen::Vector3d& before,
                                           const Eigen::Vector3d& behind, bool between);

}  // namespace hotblade::pipeline

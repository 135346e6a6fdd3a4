// Time along a path: as fast as the limits allow at every place of it, at rest at both ends.
//
// The path is given by dense samples. Speeds and the feed cap the path's rate at each; each clamp's
// acceleration, p'' rate^2 + p' path acceleration, allows an interval of path accelerations at a given rate.
// A backward pass finds the largest rate at each sample from which the rest of the path can still be held, a
// forward pass the fastest law below it: path acceleration is constant from sample to sample. Jerk is not
// limited.
#pragma once

#include <array>
#include <vector>

#include "pipeline/settings/settings.hpp"
#include "robot/pose/pose.hpp"

namespace hotblade::pipeline {

// What a path sample is limited by.
struct PathSample {
  robot::Pose a, b;                      // clamps, mm
  std::vector<Eigen::Vector3d> in_foam;  // points of the rib, whose speed the feed limits; empty in air
  // Points all along the blade, and from where to where it is in the block, counted in these: beside the rib
  // it cuts what is left of the block there. Nowhere: the end is before the beginning.
  std::vector<Eigen::Vector3d> along;
  double block_from = 0, block_to = -1;
};

// What of both clamps has a limit of acceleration of its own: each clamp's place and each clamp's turn.
enum Track : std::size_t { kPlaceA, kPlaceB, kTurnA, kTurnB, kTracks };

// How far a law stays below the limits at each sample, in (0, 1].
struct LawShares {
  std::vector<double> rate2;                       // of the squared path rate that speeds and feed allow
  std::array<std::vector<double>, kTracks> accel;  // of the limit of acceleration
};

// Returns the shares to begin with: what the samples of a path and the steps of its waypoints may hide is
// left.
[[nodiscard]] LawShares first_shares(const std::vector<PathSample>& samples);

// Path parameters in [0, 1] at even times, first 0, last 1. `step_s` is a whole number of microseconds, as
// waypoints count time, at most motion.waypoint_s and at least what a controller takes.
struct TimeLaw {
  double duration_s = 0, step_s = 0;
  std::vector<double> sigma;
};

// Returns the fastest law for samples at even path parameters, at least 3, with one share of each kind for
// each (std::logic_error). A path that does not move gives duration 0 and sigma {0, 1}.
[[nodiscard]] TimeLaw fastest_time_law(const std::vector<PathSample>& samples, const MotionSettings& limits,
                                       const LawShares& shares);

}  // namespace hotblade::pipeline

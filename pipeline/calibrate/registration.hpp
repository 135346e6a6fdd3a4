// Where a scan lies against a cut: found from any place and direction it was taken in.
//
// Starts turned every 15 degrees about the scan's own flattest axis, both sides up, its middle over nine
// places of the cut, are drawn to the surface by a few rounds of least squares on distances to its planes
// (Chen and Medioni, Object modelling by registration of multiple range images, 1992); the best of them go on
// with all points, far ones without a vote.
#pragma once

#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "pipeline/calibrate/cut_mesh.hpp"

namespace hotblade::pipeline {

struct Placement {
  Eigen::Isometry3d scan_to_design = Eigen::Isometry3d::Identity();
  double misfit_mm = 0;  // root of the mean square distance of all points, far ones counted as kFarMm
};

// A distance that counts no more than this: what is not of the cut.
inline constexpr double kFarMm = 5;
// Points farther off than so many times the noise have no say (Tukey's biweight).
inline constexpr double kTukey = 4.685;

// Draws a scan from a placement near its own to the surface, in at most `rounds` rounds.
[[nodiscard]] Placement drawn_to(const CutMesh& cut, std::span<const Eigen::Vector3d> points,
                                 const Eigen::Isometry3d& from, int rounds);

// Returns the placements that fit, best first and no two of them within 12 degrees and 20 mm of each other:
// more than one where the cut looks much the same from several sides. Those that misfit by more than twice
// the best and half a millimetre are left out. Throws std::logic_error without points.
[[nodiscard]] std::vector<Placement> placements(const CutMesh& cut, std::span<const Eigen::Vector3d> points);

// Returns the change from one placement to another in words: "turned by 180 degrees about (0.00,
// 0.00, 1.00)".
[[nodiscard]] std::string turn_between(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to);

// Returns every n-th of the points, at most so many.
[[nodiscard]] std::vector<Eigen::Vector3d> some_of(std::span<const Eigen::Vector3d> points, std::size_t most);

// The rotation and shift of a small step (turn, shift) about a point.
[[nodiscard]] Eigen::Isometry3d step_about(const Eigen::Vector3d& centre,
                                           const Eigen::Matrix<double, 6, 1>& step);

}  // namespace hotblade::pipeline

// The fit of a strip: one family of elastica near all samples of the design at once.
//
// Unknown are five functions of the sweep, the state of the blade at its middle (SweepFamily). Each section
// of the data is followed by one elastica of the family; a sample's residual is its distance from that curve
// along the curve's normal, times the cosine of the slope. Where there is no design there is no residual. A
// section meets only four coefficients of each function, so the normal equations are banded, and one
// integration of the curve and its variations serves all samples of a section.
//
// What the blade must keep to is part of the fit, along the whole blade with its free ends: its radius, where
// its clamps are, and how far its ends turn.
#pragma once

#include <optional>
#include <vector>

#include "pipeline/plan/sweep/sweep_family.hpp"
#include "pipeline/plan/sweep/sweep_sections.hpp"

namespace hotblade::pipeline {

// What the clamps err by, and the weight of a mm that this moves the blade by against a mm of the fit; 0:
// none.
struct ClampPull {
  double position_mm = 0, angle_rad = 0;
  double weight = 0;
};

struct SweepFitOptions {
  int coefficients = 7;        // of each function; at least 4
  double blade_length_mm = 0;  // free length, its middle on the family's x; the limits below hold on it
  double smallest_radius_mm = 75;
  double largest_turn_rad = 1.4;  // of the blade's ends against x
  // Box that both clamps stay out of, on the frame's axes: the block and the clearance; none: anywhere.
  struct Box {
    Eigen::Vector2d low{0, 0}, high{0, 0};
  };
  std::optional<Box> block;
  double over_first_mm = 4, over_last_mm = 4;  // the family goes on past the first and last section
  ClampPull clamp_pull{};
  double calm = 1;           // factor of the pull towards few and smooth tensions
  int most_iterations = 40;  // of each stage
  bool turn_planes = false;  // whether the report says what turning the planes would do
  std::vector<int> exponents{
      2};  // even, of the mean that is made small, stage by stage; the last ones near the maximum
};

// How the last stage's mean changes as the planes turn, by rad about x and y of the sweep's axes, while the
// family follows as it can: gradient and Gauss and Newton's matrix, a distance of scale_mm counting as its
// square. The terms of several parts that share their planes add up, where they are brought to one scale.
struct PlaneTurn {
  Eigen::Vector2d gradient{0, 0};
  Eigen::Matrix2d matrix = Eigen::Matrix2d::Zero();
  int exponent = 2;
  double scale_mm = 1;

  [[nodiscard]] PlaneTurn at_scale(double mm) const;
};

struct SweepFitReport {
  SweepFamily family;
  double rms_mm = 0, max_mm = 0;           // over the samples, in space
  double max_offset_mm = 0;                // where: along the sweep
  Eigen::Vector2d max_q{0, 0};             // and in the plane there
  double arc_low_mm = 0, arc_high_mm = 0;  // arc lengths from the middle that the samples lie between
  double smallest_radius_mm = 0;           // of the whole blade at the sections
  double largest_turn_rad = 0;             // of its ends
  double clamp_depth_mm = 0;               // of the deeper clamp in the box; 0: both outside
  PlaneTurn turn;                          // where it is asked for; parallel planes only
  int iterations = 0;
  bool converged = false;  // the last stage ended by itself
};

// From flat blades at the design's mean height, or from `start`. At least one section, finite samples, a
// positive blade length, even exponents (std::logic_error). The same input gives the same bytes.
[[nodiscard]] SweepFitReport fit_sweep(const SweepData& data, const SweepFitOptions& options,
                                       const SweepFamily* start = nullptr);

// Returns what a fit's report says of a family that was not fitted.
[[nodiscard]] SweepFitReport measured_family(const SweepData& data, const SweepFitOptions& options,
                                             const SweepFamily& family);

}  // namespace hotblade::pipeline

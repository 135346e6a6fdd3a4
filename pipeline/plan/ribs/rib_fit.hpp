// The fit stage: a cubic Bezier and a true elastica for each rib of a strip.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "elastica/bezier/bezier.hpp"
#include "elastica/fit/fit.hpp"
#include "elastica/fit/fit_clamped.hpp"
#include "pipeline/plan/ribs/target.hpp"

namespace hotblade::pipeline {

struct RibFit {
  double offset_mm = 0;
  double max_slope_rad = 0;             // of the design against the rib plane
  std::vector<Eigen::Vector2d> target;  // evenly spaced, chain axes; empty where the design says nothing
  // Of a rib that goes on past the design's border: all of it, evenly spaced, what each point of it counts
  // (sum 1), and the target's share of it.
  std::vector<Eigen::Vector2d> course;
  std::vector<double> weights;
  DesignPart own;
  std::vector<Eigen::Vector2d>
      beside;               // ends of the sections between this rib and the next ones, for the block
  elastica::Bezier bezier;  // after projection where its lambda-residual was above the threshold
  double lambda_residual = 0;
  bool projected = false;
  double bezier_deviation_mm = 0;  // Bezier before projection against target
  elastica::Elastica elastica;
  double deviation_mm = 0;  // elastica against target
  bool converged = false;
  // Ends shared with the neighbouring strip's rib: kept exactly by every further fit.
  std::optional<elastica::PlanarPose> clamp_start, clamp_end;

  // The points that the elastica is fitted to.
  [[nodiscard]] const std::vector<Eigen::Vector2d>& followed() const {
    return course.empty() ? target : course;
  }
  // Deviation of an elastica from what the design says.
  [[nodiscard]] double deviation_of(const elastica::Elastica& elastica) const;
};

inline constexpr int kRibSamples = 65;
// Of a blade (elastica::turns_at_most): one that winds faster has snapped or yielded long before, and is not
// worth evaluating.
inline constexpr double kMostTurnsRad = 100;
// Whether a blade of this length through a rib's state does so.
[[nodiscard]] bool winds_up(const elastica::MidState& rib, double length_mm);
// Of fit_ribs: decides only what the points leave open.
inline constexpr double kLeastTensionWeight = 1e-6;

// Fits shares [u0, u1] of every rib as closely as an elastica can. Ribs are independent of each other here;
// runs on all cores allowed.
[[nodiscard]] std::vector<RibFit> fit_ribs(std::span<const RibTarget> ribs, double u0, double u1,
                                           const FitSettings& settings);

// The Bezier of a rib that runs along these evenly spaced points: near them, and projected where its
// lambda-residual is above the threshold.
void give_bezier(RibFit& fit, std::span<const Eigen::Vector2d> points, const FitSettings& settings);

// Takes the elastica of this state and measures it. A rib with shared ends is fitted to them again, pulled to
// the state's curvature and tensions.
void settle(RibFit& rib, const elastica::MidState& state);

// Calmer fits: the tensions of all ribs pulled to zero with one weight (elastica/fit/fit.hpp). The blade goes
// on along the rib's elastica on both sides, and what little a rib says about the tensions would otherwise
// curl it up there. Deviations grow with the weight. Clamped ends are kept; a rib that cannot keep them
// deviates by infinity.
[[nodiscard]] std::vector<RibFit> calmed(const std::vector<RibFit>& ribs, double tension_weight);

// Refits each rib with a weak pull towards its neighbours' curvature and tensions, which decides only what
// the points leave open: the blade beyond a rib's ends then moves smoothly from rib to rib. Ribs whose
// deviation would grow by more than `allowance_mm`, or beyond `most_mm`, stay as they are. `tension_weight`
// as the ribs were fitted with.
void smooth_ribs(std::vector<RibFit>& ribs, double tension_weight, double allowance_mm, double most_mm);

}  // namespace hotblade::pipeline

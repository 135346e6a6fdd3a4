// The work of a fit that many curves and many samples share, eight at a time (elastica/kernels/lanes.hpp).
// What comes out is, to the bit, what SweepCurve and sample_term say of one.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "pipeline/plan/sweep/sweep_terms.hpp"

namespace hotblade::pipeline {

// The mean of |distance|^exponent, a distance of `scale_mm` counting as its square.
struct DistancePower {
  int exponent = 2;  // even
  double scale_mm = 1, samples = 1;

  struct Weight {
    double value = 0, first = 0, second = 0;  // of a distance, and of its first two derivatives
  };
  [[nodiscard]] Weight of(double away_mm) const;
};

// What a section's samples add to a mean: its value, and gradient and Gauss and Newton's matrix by the
// state's five numbers.
struct DistanceSums {
  double value = 0;
  ByState gradient = ByState::Zero();
  Eigen::Matrix<double, 5, 5> matrix = Eigen::Matrix<double, 5, 5>::Zero();
  double max_mm = 0;
};

// Returns the sums of a section whose curve this is. `feet_mm` has each sample's foot, sought from what it
// was before; `away_mm` gets the distances (SampleTerm).
[[nodiscard]] DistanceSums distance_sums(std::span<const SweepSample> samples, const SweepState& state,
                                         const SweepCurve& curve, double x_mm, const DistancePower& power,
                                         std::span<double> feet_mm, std::span<double> away_mm,
                                         elastica::Simd simd = elastica::best_simd());

// Returns the samples' terms (sample_term), their feet sought from `feet_mm`.
void sample_terms(std::span<const SweepSample> samples, const SweepState& state, const SweepCurve& curve,
                  double x_mm, std::span<const double> feet_mm, std::span<SampleTerm> terms,
                  elastica::Simd simd = elastica::best_simd());

// A sample whose curve no other one needs, of this reach.
struct LoneSample {
  const SweepSample* sample = nullptr;
  SweepState state;
  double reach_mm = 0, x_mm = 0, foot_mm = 0;
};
// Returns the terms of such samples, their curves walked side by side and no farther than each sample is.
[[nodiscard]] std::vector<SampleTerm> lone_terms(std::span<const LoneSample> samples);

}  // namespace hotblade::pipeline

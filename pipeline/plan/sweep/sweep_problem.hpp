// The least-squares problem of a swept family (sweep_fit.hpp): its unknowns, its value, gradient and normal
// matrix.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "pipeline/plan/sweep/sweep_lanes.hpp"

namespace hotblade::pipeline {

struct SweepEvaluation {
  double value = 0;
  Eigen::VectorXd gradient;
  Eigen::MatrixXd hessian;      // Gauss and Newton's; banded by 20 unknowns
  std::vector<double> feet;     // arc length of each sample's nearest point
  std::vector<double> away_mm;  // signed distance of each sample in space
  double max_mm = 0;
};

class SweepProblem {
 public:
  // The range and the x of `family` stay.
  SweepProblem(const SweepData& data, const SweepFitOptions& options, const SweepFamily& family);

  // The mean of |distance|^exponent, scaled so that a distance of `scale_mm` counts as its square.
  void set_exponent(int exponent, double scale_mm);

  // Unknowns are coefficients in mm of what they do at half a rib's distance from the middle: one column of
  // the family after the other.
  [[nodiscard]] Eigen::VectorXd pack(const SweepFamily& family) const;
  [[nodiscard]] SweepFamily unpack(const Eigen::VectorXd& unknowns) const;

  [[nodiscard]] std::vector<double> first_feet() const;
  [[nodiscard]] SweepEvaluation evaluate(const Eigen::VectorXd& unknowns,
                                         const std::vector<double>& feet) const;
  // At a fit of parallel planes. Samples move as the planes turn about the middle of the sweep, and their
  // sections with them; the family stays on the planes and then follows, which its unknowns are eliminated
  // for (Schur's complement).
  [[nodiscard]] PlaneTurn turn(const Eigen::VectorXd& unknowns, const SweepEvaluation& at) const;
  // The facts of a report but its counts.
  void measure(const SweepEvaluation& evaluation, SweepFitReport& report) const;

 private:
  using Vector5 = ByState;
  using Matrix5 = Eigen::Matrix<double, 5, 5>;
  struct Normal;  // value, gradient and matrix in a section's own five unknowns

  [[nodiscard]] SweepState state_at(const Eigen::VectorXd& unknowns, const BasisValues& basis) const;
  [[nodiscard]] std::vector<SweepState> states_at(const Eigen::VectorXd& unknowns) const;
  [[nodiscard]] std::vector<SweepCurve> curves_of(std::span<const SweepState> states) const;
  void add_limits(std::size_t section, const SweepState& state, const SweepCurve& curve,
                  Normal& normal) const;
  void add_smoothness(const Eigen::VectorXd& unknowns, SweepEvaluation& all) const;

  const SweepData& data_;
  const SweepFitOptions& options_;
  SweepFamily family_;
  SweepBasis basis_;
  std::vector<BasisValues> at_;  // of each section
  Vector5 scale_;                // of the family's coefficients for one unit of an unknown
  DistancePower power_;
};

}  // namespace hotblade::pipeline

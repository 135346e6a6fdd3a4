#include "pipeline/plan/sweep/sweep_fit.hpp"

#include "gpu/backend/stop.hpp"
#include "pipeline/plan/sweep/sweep_problem.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace hotblade::pipeline {

namespace {

// Coefficients of flat blades at the mean height of the samples.
SweepFamily flat_family(const SweepData& data, const SweepFitOptions& options) {
  SweepFamily family;
  family.first_mm = data.sections.front().offset_mm - options.over_first_mm;
  family.last_mm = data.sections.back().offset_mm + options.over_last_mm;
  double low = data.sections.front().samples.front().q.x(), high = low, y = 0, count = 0;
  for (const SweepSection& section : data.sections) {
    low = std::min(low, section.samples.front().q.x());
    high = std::max(high, section.samples.back().q.x());
    for (const SweepSample& sample : section.samples) y += sample.q.y();
    count += static_cast<double>(section.samples.size());
  }
  family.x_mm = 0.5 * (low + high);
  family.coefficients.setZero(5, options.coefficients);
  family.coefficients.row(0).setConstant(y / count);
  return family;
}

// Levenberg's and Marquardt's steps on one objective.
struct Descent {
  int iterations = 0;
  bool converged = false;
};

Descent descend(const SweepProblem& problem, int most, Eigen::VectorXd& unknowns, SweepEvaluation& now) {
  constexpr double kEnough = 1e-4;  // twice in a row
  constexpr double kLeastDamping = 1e-9, kMostDamping = 1e9;
  double damping = 1e-4;
  int small = 0;
  Descent descent;
  while (descent.iterations < most) {
    gpu::stop_point();
    ++descent.iterations;
    Eigen::MatrixXd damped = now.hessian;
    damped.diagonal() *= 1 + damping;
    const Eigen::VectorXd step = -damped.ldlt().solve(now.gradient);
    SweepEvaluation next;
    const bool whole = step.allFinite();
    if (whole) next = problem.evaluate(unknowns + step, now.feet);
    if (!whole || !(next.value < now.value)) {
      damping *= 10;
      if (damping > kMostDamping) {
        descent.converged = true;
        return descent;
      }
      continue;
    }
    small = now.value - next.value <= kEnough * now.value ? small + 1 : 0;
    unknowns += step;
    now = std::move(next);
    damping = std::max(kLeastDamping, damping / 10);
    if (small == 2) {
      descent.converged = true;
      return descent;
    }
  }
  return descent;
}

void check(const SweepData& data, const SweepFitOptions& options) {
  if (data.sections.empty()) throw std::logic_error("a sweep needs a section");
  if (!(options.blade_length_mm > 0)) throw std::logic_error("a sweep needs a blade");
  for (const int exponent : options.exponents)
    if (exponent < 2 || exponent % 2 != 0) throw std::logic_error("a sweep's exponents must be even");
  for (const SweepSection& section : data.sections) {
    if (section.samples.empty()) throw std::logic_error("a section needs a sample");
    for (const SweepSample& sample : section.samples) {
      if (!sample.q.allFinite()) throw std::logic_error("samples must be finite");
    }
  }
}

}  // namespace

PlaneTurn PlaneTurn::at_scale(double mm) const {
  const double factor = std::pow(scale_mm / mm, exponent - 2);
  return {factor * gradient, factor * matrix, exponent, mm};
}

SweepFitReport fit_sweep(const SweepData& data, const SweepFitOptions& options, const SweepFamily* start) {
  check(data, options);
  SweepFitReport report;
  report.family = flat_family(data, options);
  if (start) report.family.coefficients = with_coefficients(*start, options.coefficients).coefficients;
  SweepProblem problem(data, options, report.family);
  Eigen::VectorXd unknowns = problem.pack(report.family);
  SweepEvaluation now;
  std::vector<double> feet = problem.first_feet();
  for (const int exponent : options.exponents) {
    problem.set_exponent(exponent, now.max_mm);
    now = problem.evaluate(unknowns, feet);
    const Descent descent = descend(problem, options.most_iterations, unknowns, now);
    feet = now.feet;
    report.iterations += descent.iterations;
    report.converged = descent.converged;
  }
  report.family = problem.unpack(unknowns);
  if (options.turn_planes) report.turn = problem.turn(unknowns, now);
  problem.measure(now, report);
  return report;
}

SweepFitReport measured_family(const SweepData& data, const SweepFitOptions& options,
                               const SweepFamily& family) {
  SweepFitReport report;
  report.family = family;
  const SweepProblem problem(data, options, family);
  problem.measure(problem.evaluate(problem.pack(family), problem.first_feet()), report);
  return report;
}

}  // namespace hotblade::pipeline

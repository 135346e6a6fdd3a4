#include "pipeline/plan/sweep/sweep_problem.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "elastica/kernels/lanes.hpp"
#include "surface/read/blocks.hpp"

namespace hotblade::pipeline {

struct SweepProblem::Normal {
  double value = 0;
  Vector5 gradient = Vector5::Zero();
  Matrix5 matrix = Matrix5::Zero();

  void add(const LimitTerm& term) {
    if (!(term.over > 0)) return;
    value += term.over * term.over;
    gradient += 2 * term.over * term.by;
    matrix.noalias() += (2 * term.by) * term.by.transpose();
  }
};

SweepProblem::SweepProblem(const SweepData& data, const SweepFitOptions& options, const SweepFamily& family)
    : data_(data), options_(options), family_(family), basis_(options.coefficients) {
  power_.samples = 0;
  for (const SweepSection& section : data.sections) {
    const double share = (section.offset_mm - family.first_mm) / (family.last_mm - family.first_mm);
    at_.push_back(basis_.at(share));
    power_.samples += static_cast<double>(section.samples.size());
  }
  scale_ = unknown_units(data, family.x_mm);
}

void SweepProblem::set_exponent(int exponent, double scale_mm) {
  constexpr double kLeastScale_mm = 1e-6;
  power_.exponent = exponent;
  power_.scale_mm = std::max(scale_mm, kLeastScale_mm);
}

Eigen::VectorXd SweepProblem::pack(const SweepFamily& family) const {
  Eigen::VectorXd unknowns(5 * family.count());
  for (int i = 0; i < family.count(); ++i)
    unknowns.segment<5>(5 * i) = family.coefficients.col(i).cwiseQuotient(scale_);
  return unknowns;
}

SweepFamily SweepProblem::unpack(const Eigen::VectorXd& unknowns) const {
  SweepFamily family = family_;
  family.coefficients.resize(5, basis_.count());
  for (int i = 0; i < basis_.count(); ++i)
    family.coefficients.col(i) = unknowns.segment<5>(5 * i).cwiseProduct(scale_);
  return family;
}

std::vector<double> SweepProblem::first_feet() const {
  std::vector<double> feet;
  for (const SweepSection& section : data_.sections) {
    for (const SweepSample& sample : section.samples) feet.push_back(sample.q.x() - family_.x_mm);
  }
  return feet;
}

SweepState SweepProblem::state_at(const Eigen::VectorXd& unknowns, const BasisValues& basis) const {
  Vector5 v = Vector5::Zero();
  for (int k = 0; k < 4; ++k)
    v += basis.value[static_cast<std::size_t>(k)] * unknowns.segment<5>(5 * (basis.first + k));
  v = v.cwiseProduct(scale_);
  return {v[0], v[1], {v[2], v[3], v[4]}};
}

std::vector<SweepState> SweepProblem::states_at(const Eigen::VectorXd& unknowns) const {
  std::vector<SweepState> states;
  for (const BasisValues& basis : at_) states.push_back(state_at(unknowns, basis));
  return states;
}

std::vector<SweepCurve> SweepProblem::curves_of(std::span<const SweepState> states) const {
  std::vector<SweepCurve::Ask> asked;
  for (const SweepState& state : states) asked.push_back({state.bend, 0.5 * options_.blade_length_mm});
  return SweepCurve::all(asked);
}

SweepEvaluation SweepProblem::evaluate(const Eigen::VectorXd& unknowns,
                                       const std::vector<double>& feet) const {
  SweepEvaluation all;
  all.gradient.setZero(unknowns.size());
  all.hessian.setZero(unknowns.size(), unknowns.size());
  all.feet = feet;
  all.away_mm.resize(feet.size());
  const std::vector<SweepState> states = states_at(unknowns);
  const std::size_t count = data_.sections.size();
  std::vector<std::size_t> first(count, 0);
  for (std::size_t j = 1; j < count; ++j) first[j] = first[j - 1] + data_.sections[j - 1].samples.size();
  // As many at once as lanes walk curves; what they come to is added in one order.
  std::vector<Normal> normals(count);
  std::vector<double> max_mm(count);
  surface::for_blocks(count, elastica::lanes::kLanes, [&](std::size_t from, std::size_t to) {
    const std::vector<SweepCurve> curves = curves_of(std::span(states).subspan(from, to - from));
    for (std::size_t j = from; j < to; ++j) {
      const std::vector<SweepSample>& samples = data_.sections[j].samples;
      const DistanceSums sums = distance_sums(samples, states[j], curves[j - from], family_.x_mm, power_,
                                              std::span(all.feet).subspan(first[j], samples.size()),
                                              std::span(all.away_mm).subspan(first[j], samples.size()));
      max_mm[j] = sums.max_mm;
      normals[j] = {sums.value, sums.gradient, sums.matrix};
      add_limits(j, states[j], curves[j - from], normals[j]);
    }
  });
  for (std::size_t j = 0; j < count; ++j) {
    const BasisValues& basis = at_[j];
    const Normal& normal = normals[j];
    if (!(max_mm[j] <= all.max_mm)) all.max_mm = max_mm[j];
    all.value += normal.value;
    const Vector5 gradient = normal.gradient.cwiseProduct(scale_);
    const Matrix5 matrix = scale_.asDiagonal() * normal.matrix * scale_.asDiagonal();
    for (std::size_t k = 0; k < 4; ++k) {
      const int row = 5 * (basis.first + static_cast<int>(k));
      all.gradient.segment<5>(row) += basis.value[k] * gradient;
      for (std::size_t i = 0; i < 4; ++i)
        all.hessian.block<5, 5>(row, 5 * (basis.first + static_cast<int>(i))) +=
            basis.value[k] * basis.value[i] * matrix;
    }
  }
  add_smoothness(unknowns, all);
  return all;
}

void SweepProblem::add_limits(std::size_t section, const SweepState& state, const SweepCurve& curve,
                              Normal& normal) const {
  Normal limits;
  for (const SweepPoint& node : curve.nodes()) limits.add(radius_term(node, options_));
  for (const SweepPoint* end : {&curve.nodes().front(), &curve.nodes().back()}) {
    limits.add(turn_term(*end, state, options_));
    limits.add(clamp_term(*end, state, family_.x_mm, options_));
  }
  const std::vector<SweepSample>& samples = data_.sections[section].samples;
  limits.add(tension_term(state, curve, options_));
  limits.add(clamp_error_term(state, curve, samples.front().q.x() - family_.x_mm,
                              samples.back().q.x() - family_.x_mm, options_));
  const double share = 1 / static_cast<double>(data_.sections.size());
  normal.value += share * limits.value;
  normal.gradient += share * limits.gradient;
  normal.matrix += share * limits.matrix;
}

void SweepProblem::add_smoothness(const Eigen::VectorXd& unknowns, SweepEvaluation& all) const {
  for (int k = 0; k < 5; ++k) {
    const double weight = std::pow(smooth_weight(k, basis_.count()), 2);
    for (int i = 0; i + 2 < basis_.count(); ++i) {
      const std::array<double, 3> part = basis_.second_difference(i);
      double bend = 0;
      for (int r = 0; r < 3; ++r) bend += part[static_cast<std::size_t>(r)] * unknowns[5 * (i + r) + k];
      all.value += weight * bend * bend;
      for (int r = 0; r < 3; ++r) {
        const double by = part[static_cast<std::size_t>(r)];
        all.gradient[5 * (i + r) + k] += 2 * weight * bend * by;
        for (int c = 0; c < 3; ++c)
          all.hessian(5 * (i + r) + k, 5 * (i + c) + k) +=
              2 * weight * by * part[static_cast<std::size_t>(c)];
      }
    }
    const double calm = std::pow(calm_weight(k, options_.calm), 2);
    for (int i = 0; i < basis_.count(); ++i) {
      const int u = 5 * i + k;
      all.value += calm * unknowns[u] * unknowns[u];
      all.gradient[u] += 2 * calm * unknowns[u];
      all.hessian(u, u) += 2 * calm;
    }
  }
}

PlaneTurn SweepProblem::turn(const Eigen::VectorXd& unknowns, const SweepEvaluation& at) const {
  PlaneTurn turn;
  turn.exponent = power_.exponent;
  turn.scale_mm = power_.scale_mm;
  Eigen::Matrix<double, Eigen::Dynamic, 2> mixed = Eigen::MatrixXd::Zero(unknowns.size(), 2);
  const double length = family_.last_mm - family_.first_mm,
               middle = 0.5 * (family_.first_mm + family_.last_mm);
  const std::vector<SweepState> states = states_at(unknowns);
  const std::vector<SweepCurve> curves = curves_of(states);
  std::vector<SampleTerm> terms;
  std::size_t first = 0;
  for (std::size_t j = 0; j < data_.sections.size(); ++j) {
    const SweepSection& section = data_.sections[j];
    const BasisValues& basis = at_[j];
    const SweepState& state = states[j];
    terms.resize(section.samples.size());
    sample_terms(section.samples, state, curves[j], family_.x_mm, std::span(at.feet).subspan(first), terms);
    first += terms.size();
    Vector5 along = Vector5::Zero();  // of the state, for a mm of the sweep
    for (std::size_t k = 0; k < 4; ++k)
      along += basis.slope[k] / length * unknowns.segment<5>(5 * (basis.first + static_cast<int>(k)));
    along = along.cwiseProduct(scale_);
    const double offset = section.offset_mm - middle;
    for (std::size_t i = 0; i < terms.size(); ++i) {
      const SampleTerm& term = terms[i];
      const double by_offset = term.by.dot(along);
      const Eigen::Vector2d q = section.samples[i].q - Eigen::Vector2d(family_.x_mm, state.y);
      const Eigen::Vector2d by(term.by_point.y() * offset - by_offset * q.y(),
                               by_offset * q.x() - term.by_point.x() * offset);
      const DistancePower::Weight weight = power_.of(term.away_mm);
      turn.gradient += weight.first * by;
      turn.matrix += weight.second * by * by.transpose();
      const Vector5 by_state = weight.second * term.by.cwiseProduct(scale_);
      for (std::size_t k = 0; k < 4; ++k)
        mixed.middleRows<5>(5 * (basis.first + static_cast<int>(k))) +=
            basis.value[k] * by_state * by.transpose();
    }
  }
  const Eigen::LDLT<Eigen::MatrixXd> family(at.hessian);
  turn.gradient -= mixed.transpose() * family.solve(at.gradient);
  turn.matrix -= mixed.transpose() * family.solve(mixed);
  return turn;
}

void SweepProblem::measure(const SweepEvaluation& evaluation, SweepFitReport& report) const {
  double squares = 0, sharpest = 0;
  report.max_mm = evaluation.max_mm;
  const auto [low, high] = std::minmax_element(evaluation.feet.begin(), evaluation.feet.end());
  report.arc_low_mm = *low;
  report.arc_high_mm = *high;
  std::vector<SweepState> states;
  for (const SweepSection& section : data_.sections) states.push_back(report.family.at(section.offset_mm));
  const std::vector<SweepCurve> curves = curves_of(states);
  std::size_t i = 0;
  for (std::size_t j = 0; j < data_.sections.size(); ++j) {
    const SweepSection& section = data_.sections[j];
    for (std::size_t k = 0; k < section.samples.size(); ++k, ++i) {
      squares += evaluation.away_mm[i] * evaluation.away_mm[i];
      if (std::abs(evaluation.away_mm[i]) != evaluation.max_mm) continue;
      report.max_offset_mm = section.offset_mm;
      report.max_q = section.samples[k].q;
    }
    const SweepState& state = states[j];
    const SweepCurve& curve = curves[j];
    for (const SweepPoint& p : curve.nodes()) sharpest = std::max(sharpest, std::abs(p.kappa));
    for (const SweepPoint* end : {&curve.nodes().front(), &curve.nodes().back()}) {
      report.largest_turn_rad = std::max(report.largest_turn_rad, std::abs(state.theta + end->theta));
      report.clamp_depth_mm =
          std::max(report.clamp_depth_mm, clamp_depth_mm(*end, state, family_.x_mm, options_));
    }
  }
  report.rms_mm = std::sqrt(squares / power_.samples);
  report.smallest_radius_mm = sharpest > 0 ? 1 / sharpest : std::numeric_limits<double>::infinity();
}

}  // namespace hotblade::pipeline

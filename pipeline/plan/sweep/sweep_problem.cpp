#include "pipeline/plan/sweep/sweep_problem.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace hotblade::pipeline {

namespace {

using Eigen::Vector2d;

// Second differences of the coefficients, in mm of effect, against the samples' mean square: they decide what
// the samples leave open. More coefficients are closer together and are held more firmly.
constexpr double kSmooth = 5e-4;
constexpr std::array<double, 5> kSmoothOf{0.3, 0.6, 1, 1, 1};
// Tensions are pulled to zero, where the blade is an arc: a short or weakly curved section says nothing of
// them.
constexpr std::array<double, 5> kCalmOf{0, 0, 0, 2e-4, 7e-5};
// A radius of a tenth less than allowed counts as half a mm at each node of a blade; a clamp 10 mm too near
// as 1 mm, an end turned 0.1 rad too far as 1 mm.
constexpr double kRadiusWeight = 5, kClampWeight = 0.1, kTurnWeight = 10;

double smoothness(int coefficients) {
  return kSmooth * std::pow((coefficients - 3) / 3.0, 1.5);
}

// How deep a point lies in a box, and which way is out; nothing outside.
struct Depth {
  double mm = 0;
  Vector2d inwards{0, 0};
};

Depth depth_in(const SweepFitOptions::Box& box, const Vector2d& q) {
  Depth depth{std::numeric_limits<double>::infinity(), {0, 0}};
  for (const int axis : {0, 1}) {
    const double above = q[axis] - box.low[axis], below = box.high[axis] - q[axis];
    if (above < depth.mm) depth = {above, Vector2d::Unit(axis)};
    if (below < depth.mm) depth = {below, -Vector2d::Unit(axis)};
  }
  return depth.mm > 0 ? depth : Depth{};
}

// A point of a section's curve on the frame's axes, and how it moves with y, theta, kappa and the tensions.
struct PlacedPoint {
  Vector2d position;
  Eigen::Matrix<double, 2, 5> by_state;
};

PlacedPoint placed(const SweepPoint& p, const SweepState& state, double x_mm) {
  Eigen::Matrix2d turn;
  turn << std::cos(state.theta), -std::sin(state.theta), std::sin(state.theta), std::cos(state.theta);
  const Vector2d from_middle = turn * p.position;
  PlacedPoint placed{Vector2d(x_mm, state.y) + from_middle, {}};
  placed.by_state.col(0) = Vector2d::UnitY();
  placed.by_state.col(1) = Vector2d(-from_middle.y(), from_middle.x());
  placed.by_state.rightCols<3>() = turn * p.by_bend;
  return placed;
}

}  // namespace

struct SweepProblem::Normal {
  double value = 0;
  Vector5 gradient = Vector5::Zero();
  Matrix5 matrix = Matrix5::Zero();

  // A term by its value, its first two derivatives by one number, and that number's by the unknowns.
  void add(double term, double first, double second, const Vector5& by) {
    value += term;
    gradient += first * by;
    matrix.noalias() += (second * by) * by.transpose();
  }
  void add_square(double number, const Vector5& by) { add(number * number, 2 * number, 2, by); }
};

SweepProblem::SweepProblem(const SweepData& data, const SweepFitOptions& options, const SweepFamily& family)
    : data_(data), options_(options), family_(family), basis_(options.coefficients) {
  double half = 1;
  for (const SweepSection& section : data.sections) {
    const double share = (section.offset_mm - family.first_mm) / (family.last_mm - family.first_mm);
    at_.push_back(basis_.at(share));
    samples_ += static_cast<double>(section.samples.size());
    half = std::max(
        {half, family.x_mm - section.samples.front().q.x(), section.samples.back().q.x() - family.x_mm});
  }
  const double cube = half * half * half;
  scale_ << 1, 1 / half, 2 / (half * half), 12 / cube, 6 / cube;
}

void SweepProblem::set_exponent(double exponent, double scale_mm) {
  constexpr double kLeastScale_mm = 1e-6;
  exponent_ = exponent;
  exponent_scale_mm_ = std::max(scale_mm, kLeastScale_mm);
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

SweepEvaluation SweepProblem::evaluate(const Eigen::VectorXd& unknowns,
                                       const std::vector<double>& feet) const {
  SweepEvaluation all;
  all.gradient.setZero(unknowns.size());
  all.hessian.setZero(unknowns.size(), unknowns.size());
  all.feet = feet;
  all.away_mm.resize(feet.size());
  std::size_t first = 0;
  for (std::size_t j = 0; j < data_.sections.size(); ++j) {
    const BasisValues& basis = at_[j];
    const SweepState state = state_at(unknowns, basis);
    const SweepCurve curve(state.bend, 0.5 * options_.blade_length_mm);
    Normal normal;
    add_samples(j, first, state, curve, all, normal);
    add_limits(state, curve, normal);
    first += data_.sections[j].samples.size();
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

void SweepProblem::add_samples(std::size_t section, std::size_t first, const SweepState& state,
                               const SweepCurve& curve, SweepEvaluation& all, Normal& normal) const {
  const Vector2d middle(family_.x_mm, state.y);
  Eigen::Matrix2d back;
  back << std::cos(state.theta), std::sin(state.theta), -std::sin(state.theta), std::cos(state.theta);
  const std::vector<SweepSample>& samples = data_.sections[section].samples;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Vector2d q = back * (samples[i].q - middle);  // in the curve's axes
    double& foot = all.feet[first + i];
    foot = curve.nearest(q, foot);
    const SweepPoint p = curve.at(foot);
    const Vector2d n = p.normal();
    const double away = samples[i].cosine * (q - p.position).dot(n);
    Vector5 by;
    by << back.row(0).y() * n.x() + back.row(1).y() * n.y(), n.y() * p.position.x() - n.x() * p.position.y(),
        (n.transpose() * p.by_bend).transpose();
    by *= -samples[i].cosine;
    const double size = std::abs(away), ratio = size / exponent_scale_mm_;
    const double scaled = exponent_ == 2 ? 1 : std::pow(ratio, exponent_ - 2);
    normal.add(scaled * away * away / samples_, exponent_ * scaled * away / samples_,
               exponent_ * (exponent_ - 1) * scaled / samples_, by);
    all.away_mm[first + i] = away;
    if (!(size <= all.max_mm)) all.max_mm = size;
  }
}

void SweepProblem::add_limits(const SweepState& state, const SweepCurve& curve, Normal& normal) const {
  Normal limits;
  for (const SweepPoint& p : curve.nodes()) {
    const double over = options_.smallest_radius_mm * std::abs(p.kappa) - 1;
    if (over <= 0) continue;
    Vector5 by = Vector5::Zero();
    by.tail<3>() =
        std::copysign(kRadiusWeight * options_.smallest_radius_mm, p.kappa) * p.kappa_by_bend.transpose();
    limits.add_square(kRadiusWeight * over, by);
  }
  for (const SweepPoint* end : {&curve.nodes().front(), &curve.nodes().back()}) {
    const double turn = state.theta + end->theta, over = std::abs(turn) - options_.largest_turn_rad;
    if (over > 0) {
      Vector5 by;
      by << 0, 1, end->theta_by_bend.transpose();
      limits.add_square(kTurnWeight * over, std::copysign(kTurnWeight, turn) * by);
    }
    if (!options_.block) continue;
    const PlacedPoint clamp = placed(*end, state, family_.x_mm);
    const Depth depth = depth_in(*options_.block, clamp.position);
    if (depth.mm > 0)
      limits.add_square(kClampWeight * depth.mm, kClampWeight * clamp.by_state.transpose() * depth.inwards);
  }
  const double share = 1 / static_cast<double>(data_.sections.size());
  normal.value += share * limits.value;
  normal.gradient += share * limits.gradient;
  normal.matrix += share * limits.matrix;
}

void SweepProblem::add_smoothness(const Eigen::VectorXd& unknowns, SweepEvaluation& all) const {
  const double smooth = smoothness(basis_.count());
  for (int k = 0; k < 5; ++k) {
    const double weight = std::pow(smooth * kSmoothOf[static_cast<std::size_t>(k)], 2);
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
    const double calm = std::pow(options_.calm * kCalmOf[static_cast<std::size_t>(k)], 2);
    for (int i = 0; i < basis_.count(); ++i) {
      const int u = 5 * i + k;
      all.value += calm * unknowns[u] * unknowns[u];
      all.gradient[u] += 2 * calm * unknowns[u];
      all.hessian(u, u) += 2 * calm;
    }
  }
}

void SweepProblem::measure(const SweepEvaluation& evaluation, SweepFitReport& report) const {
  double squares = 0, sharpest = 0;
  report.max_mm = evaluation.max_mm;
  const auto [low, high] = std::minmax_element(evaluation.feet.begin(), evaluation.feet.end());
  report.arc_low_mm = *low;
  report.arc_high_mm = *high;
  std::size_t i = 0;
  for (const SweepSection& section : data_.sections) {
    for (std::size_t k = 0; k < section.samples.size(); ++k, ++i) {
      squares += evaluation.away_mm[i] * evaluation.away_mm[i];
      if (std::abs(evaluation.away_mm[i]) == evaluation.max_mm) report.max_offset_mm = section.offset_mm;
    }
    const SweepState state = report.family.at(section.offset_mm);
    const SweepCurve curve(state.bend, 0.5 * options_.blade_length_mm);
    for (const SweepPoint& p : curve.nodes()) sharpest = std::max(sharpest, std::abs(p.kappa));
    for (const SweepPoint* end : {&curve.nodes().front(), &curve.nodes().back()}) {
      report.largest_turn_rad = std::max(report.largest_turn_rad, std::abs(state.theta + end->theta));
      if (options_.block)
        report.clamp_depth_mm = std::max(
            report.clamp_depth_mm, depth_in(*options_.block, placed(*end, state, family_.x_mm).position).mm);
    }
  }
  report.rms_mm = std::sqrt(squares / samples_);
  report.smallest_radius_mm = sharpest > 0 ? 1 / sharpest : std::numeric_limits<double>::infinity();
}

}  // namespace hotblade::pipeline

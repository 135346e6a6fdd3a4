#include "pipeline/plan/sweep/sweep_terms.hpp"

#include <Eigen/LU>
#include <array>
#include <limits>

#include "elastica/blade/continuation.hpp"

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
// as 1 mm, an end turned 0.1 rad too far as 1 mm, a tension a tenth too large as 0.5 mm.
constexpr double kRadiusWeight = 5, kClampWeight = 0.1, kTurnWeight = 10, kTensionWeight = 5;

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

Eigen::Matrix2d turned(double theta) {
  Eigen::Matrix2d turn;
  turn << std::cos(theta), -std::sin(theta), std::sin(theta), std::cos(theta);
  return turn;
}

}  // namespace

ByState unknown_units(const SweepData& data, double x_mm) {
  double half = 1;
  for (const SweepSection& section : data.sections)
    half = std::max({half, x_mm - section.samples.front().q.x(), section.samples.back().q.x() - x_mm});
  const double cube = half * half * half;
  ByState units;
  units << 1, 1 / half, 2 / (half * half), 12 / cube, 6 / cube;
  return units;
}

SampleTerm sample_term(const SweepSample& sample, const SweepState& state, const SweepCurve& curve,
                       double x_mm, double foot_mm) {
  const Eigen::Matrix2d back = turned(-state.theta);
  const Vector2d q = back * (sample.q - Vector2d(x_mm, state.y));  // in the curve's axes
  SampleTerm term;
  term.foot_mm = curve.nearest(q, foot_mm);
  const SweepPoint p = curve.at(term.foot_mm);
  const Vector2d n = p.normal();
  term.away_mm = sample.cosine * (q - p.position).dot(n);
  term.by << back.row(0).y() * n.x() + back.row(1).y() * n.y(),
      n.y() * p.position.x() - n.x() * p.position.y(), (n.transpose() * p.by_bend).transpose();
  term.by *= -sample.cosine;
  term.by_point = sample.cosine * back.transpose() * n;
  return term;
}

LimitTerm radius_term(const SweepPoint& node, const SweepFitOptions& options) {
  const double over = options.smallest_radius_mm * std::abs(node.kappa) - 1;
  LimitTerm term;
  if (over <= 0) return term;
  term.over = kRadiusWeight * over;
  term.by.tail<3>() =
      std::copysign(kRadiusWeight * options.smallest_radius_mm, node.kappa) * node.kappa_by_bend.transpose();
  return term;
}

LimitTerm turn_term(const SweepPoint& end, const SweepState& state, const SweepFitOptions& options) {
  const double turn = state.theta + end.theta, over = std::abs(turn) - options.largest_turn_rad;
  LimitTerm term;
  if (over <= 0) return term;
  term.over = kTurnWeight * over;
  term.by << 0, 1, end.theta_by_bend.transpose();
  term.by *= std::copysign(kTurnWeight, turn);
  return term;
}

LimitTerm clamp_term(const SweepPoint& end, const SweepState& state, double x_mm,
                     const SweepFitOptions& options) {
  LimitTerm term;
  if (!options.block) return term;
  const Eigen::Matrix2d turn = turned(state.theta);
  const Vector2d from_middle = turn * end.position;
  const Depth depth = depth_in(*options.block, Vector2d(x_mm, state.y) + from_middle);
  if (!(depth.mm > 0)) return term;
  term.over = kClampWeight * depth.mm;
  term.by << depth.inwards.y(), depth.inwards.dot(Vector2d(-from_middle.y(), from_middle.x())),
      (depth.inwards.transpose() * turn * end.by_bend).transpose();
  term.by *= kClampWeight;
  return term;
}

double clamp_depth_mm(const SweepPoint& end, const SweepState& state, double x_mm,
                      const SweepFitOptions& options) {
  return clamp_term(end, state, x_mm, options).over / kClampWeight;
}

double moved_by_clamps_mm(const SweepCurve& curve, double from_mm, double to_mm, const ClampPull& clamps) {
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  // What the middle's place and turn and the three numbers of the bend do to a point.
  const auto by_all = [](const SweepPoint& p) {
    Eigen::Matrix<double, 3, 6> by = Eigen::Matrix<double, 3, 6>::Zero();
    by(0, 0) = by(1, 1) = by(2, 2) = 1;
    by(0, 2) = -p.position.y();
    by(1, 2) = p.position.x();
    by.topRightCorner<2, 3>() = p.by_bend;
    by.bottomRightCorner<1, 3>() = p.theta_by_bend;
    return by;
  };
  const std::vector<SweepPoint>& nodes = curve.nodes();
  Matrix6 ends, wrong = Matrix6::Zero();
  for (const Eigen::Index end : {0, 1}) {
    const SweepPoint& p = end == 0 ? nodes.front() : nodes.back();
    const Eigen::Index row = 3 * end;
    ends.middleRows<3>(row) = by_all(p);
    wrong.block<2, 1>(row, row) = clamps.position_mm * p.tangent;
    wrong.block<2, 1>(row, row + 1) = clamps.position_mm * p.normal();
    wrong(row + 2, row + 2) = clamps.angle_rad;
  }
  // Numbers of one size: the bend's by what it does over half the blade.
  const double half = curve.reach_mm();
  Eigen::Matrix<double, 6, 1> units;
  units << 1, 1, 1 / half, 2 / (half * half), 6 / (half * half * half), 6 / (half * half * half);
  const Matrix6 change = units.asDiagonal() * Matrix6(ends * units.asDiagonal()).partialPivLu().solve(wrong);
  double most = 0;
  const auto look = [&](const SweepPoint& p) {
    const double across = (p.normal().transpose() * by_all(p).topRows<2>() * change).cwiseAbs().sum();
    if (!(across <= most)) most = across;
  };
  const double step = 2 * half / static_cast<double>(nodes.size() - 1);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const double s = step * static_cast<double>(i) - half;
    if (s > from_mm && s < to_mm) look(nodes[i]);
  }
  look(curve.at(from_mm));
  look(curve.at(to_mm));
  return std::isfinite(most) ? most : std::numeric_limits<double>::infinity();
}

LimitTerm tension_term(const SweepState& state, const SweepCurve& curve, const SweepFitOptions& options) {
  LimitTerm term;
  if (!(options.clamp_pull.weight > 0)) return term;
  // From there on the way of a blade is searched in smaller steps (continuation.cpp).
  constexpr double kMost = 0.5 * elastica::kLargestTension;
  const double length = 2 * curve.reach_mm(), by = -length * length / kMost;
  const double over = by * state.bend.tension1 - 1;
  if (over <= 0) return term;
  term.over = kTensionWeight * over;
  term.by[3] = kTensionWeight * by;
  return term;
}

LimitTerm clamp_error_term(const SweepState& state, const SweepCurve& curve, double from_mm, double to_mm,
                           const SweepFitOptions& options) {
  LimitTerm term;
  const ClampPull& clamps = options.clamp_pull;
  if (!(clamps.weight > 0)) return term;
  // Where a section passes straight it moves without bound: what is far off pulls by no more than this.
  constexpr double kMost_mm = 20;
  const auto pull = [&](const SweepCurve& c) {
    const double moved_mm = moved_by_clamps_mm(c, from_mm, to_mm, clamps);
    return clamps.weight * (std::isfinite(moved_mm) ? moved_mm / (1 + moved_mm / kMost_mm) : kMost_mm);
  };
  term.over = pull(curve);
  // What moves the blade's ends by a thousandth of a millimetre.
  const double half = curve.reach_mm();
  const std::array<double, 3> steps{2e-3 / (half * half), 6e-3 / (half * half * half),
                                    6e-3 / (half * half * half)};
  for (int k = 0; k < 3; ++k) {
    Bend up = state.bend;
    const double h = steps[static_cast<std::size_t>(k)];
    (k == 0 ? up.kappa : k == 1 ? up.tension1 : up.tension2) += h;
    term.by[2 + k] = (pull(SweepCurve(up, half)) - term.over) / h;
  }
  return term;
}

double smooth_weight(int function, int coefficients) {
  return kSmooth * std::pow((coefficients - 3) / 3.0, 1.5) * kSmoothOf[static_cast<std::size_t>(function)];
}

double calm_weight(int function, double calm) {
  return calm * kCalmOf[static_cast<std::size_t>(function)];
}

}  // namespace hotblade::pipeline

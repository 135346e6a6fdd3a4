#include "pipeline/plan/sweep/sweep_curve.hpp"

#include <algorithm>
#include <cmath>

namespace hotblade::pipeline {

namespace {

using Eigen::Vector2d;

// Fourth-order steps of this length are off by 1e-3 mm on arcs of 100 mm radius.
constexpr double kStepMm = 20;

// x, y, theta, and their derivatives by kappa, tension1, tension2.
struct State {
  Eigen::Array<double, 3, 4, Eigen::RowMajor> v = Eigen::Array<double, 3, 4, Eigen::RowMajor>::Zero();
};

State rate(const State& s, const Bend& bend) {
  const double c = std::cos(s.v(2, 0)), n = std::sin(s.v(2, 0));
  State r;
  r.v(0, 0) = c;
  r.v(1, 0) = n;
  r.v.row(0).tail<3>() = -n * s.v.row(2).tail<3>();
  r.v.row(1).tail<3>() = c * s.v.row(2).tail<3>();
  r.v.row(2) = bend.tension2 * s.v.row(0) - bend.tension1 * s.v.row(1);
  r.v(2, 0) += bend.kappa;
  r.v(2, 1) += 1;
  r.v(2, 2) -= s.v(1, 0);
  r.v(2, 3) += s.v(0, 0);
  return r;
}

State stepped(const State& s, const Bend& bend, double h) {
  const auto moved = [&](const State& by, double way) {
    State t;
    t.v = s.v + way * by.v;
    return t;
  };
  const State a = rate(s, bend), b = rate(moved(a, h / 2), bend), c = rate(moved(b, h / 2), bend),
              d = rate(moved(c, h), bend);
  State next;
  next.v = s.v + h / 6 * (a.v + 2 * b.v + 2 * c.v + d.v);
  return next;
}

SweepPoint point_of(const State& s, const Bend& bend) {
  SweepPoint p;
  p.position = {s.v(0, 0), s.v(1, 0)};
  p.theta = s.v(2, 0);
  p.tangent = {std::cos(p.theta), std::sin(p.theta)};
  p.kappa = bend.kappa + bend.tension2 * s.v(0, 0) - bend.tension1 * s.v(1, 0);
  p.by_bend = s.v.block<2, 3>(0, 1).matrix();
  p.theta_by_bend = s.v.row(2).tail<3>().matrix();
  p.kappa_by_bend = bend.tension2 * p.by_bend.row(0) - bend.tension1 * p.by_bend.row(1) +
                    Eigen::RowVector3d(1, -s.v(1, 0), s.v(0, 0));
  return p;
}

}  // namespace

SweepCurve::SweepCurve(const Bend& bend, double reach_mm)
    : bend_(bend), half_(std::max(1, static_cast<int>(std::ceil(reach_mm / kStepMm)))) {
  step_mm_ = reach_mm / half_;
  nodes_.resize(static_cast<std::size_t>(2 * half_ + 1));
  for (const int side : {-1, 1}) {
    State state;
    for (int i = 0; i <= half_; ++i) {
      nodes_[static_cast<std::size_t>(half_ + side * i)] = point_of(state, bend);
      if (i < half_) state = stepped(state, bend, side * step_mm_);
    }
  }
}

SweepCurve::Onward SweepCurve::onward(double s) const {
  const int at = static_cast<int>(std::lround(s / step_mm_));
  Onward on;
  on.node = &nodes_[static_cast<std::size_t>(half_ + at)];
  const double d = s - at * step_mm_, d2 = d * d, d3 = d2 * d, d4 = d3 * d, k = on.node->kappa;
  const Vector2d &t = on.node->tangent, n = on.node->normal();
  on.d = d;
  on.k1 = bend_.tension2 * t.x() - bend_.tension1 * t.y();
  on.k2 = k * (bend_.tension2 * n.x() - bend_.tension1 * n.y());
  on.way = (d - k * k * d3 / 6 - k * on.k1 * d4 / 8) * t +
           (k * d2 / 2 + on.k1 * d3 / 6 + (on.k2 - k * k * k) * d4 / 24) * n;
  return on;
}

SweepPoint SweepCurve::at(double s_mm) const {
  const Onward on = onward(std::clamp(s_mm, -reach_mm(), reach_mm()));
  const SweepPoint& p = *on.node;
  const double d = on.d, d2 = d * d, d3 = d2 * d;
  const Vector2d &t = p.tangent, n = p.normal();
  SweepPoint q;
  q.position = p.position + on.way;
  q.theta = p.theta + p.kappa * d + on.k1 * d2 / 2 + on.k2 * d3 / 6;
  q.tangent = {std::cos(q.theta), std::sin(q.theta)};
  q.kappa = p.kappa + on.k1 * d + on.k2 * d2 / 2;
  // The rest of the way turns with the node, and bends with its curvature and that one's slope.
  const Eigen::RowVector3d slope = p.theta_by_bend * (bend_.tension2 * n.x() - bend_.tension1 * n.y()) +
                                   Eigen::RowVector3d(0, -t.y(), t.x());
  q.by_bend = p.by_bend + Vector2d(-on.way.y(), on.way.x()) * p.theta_by_bend +
              n * (d2 / 2 * p.kappa_by_bend + d3 / 6 * slope);
  q.theta_by_bend = p.theta_by_bend + d * p.kappa_by_bend + d2 / 2 * slope;
  q.kappa_by_bend = p.kappa_by_bend + d * slope;
  return q;
}

double SweepCurve::nearest(const Vector2d& q, double guess_mm) const {
  constexpr int kSteps = 30;
  // A distance changes by the square of what its foot is off.
  constexpr double kLongest_mm = 60, kEnough_mm = 1e-4;
  double s = std::clamp(guess_mm, -reach_mm(), reach_mm());
  for (int i = 0; i < kSteps; ++i) {
    const Onward on = onward(s);
    const Vector2d away = q - on.node->position - on.way;
    // The tangent turned on from the node, to the fourth order of the way's angle.
    const double turn = on.node->kappa * on.d + on.k1 * on.d * on.d / 2, square = turn * turn;
    const double c = 1 - square / 2 + square * square / 24, n = turn * (1 - square / 6);
    const Vector2d& t0 = on.node->tangent;
    const Vector2d t(c * t0.x() - n * t0.y(), n * t0.x() + c * t0.y());
    const double kappa = on.node->kappa + on.k1 * on.d;
    const double bent = 1 - kappa * (t.x() * away.y() - t.y() * away.x());
    // Beyond the centre of curvature Newton's step would lead away.
    constexpr double kLeastBent = 0.3;
    const double step = std::clamp(away.dot(t) / std::max(bent, kLeastBent), -kLongest_mm, kLongest_mm);
    const double next = std::clamp(s + step, -reach_mm(), reach_mm());
    const bool settled = std::abs(next - s) <= kEnough_mm;
    s = next;
    if (settled) break;
  }
  return s;
}

}  // namespace hotblade::pipeline

#include "pipeline/plan/sweep/sweep_curve.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/plan/sweep/sweep_step.hpp"
#include "pipeline/plan/sweep/sweep_walk.hpp"

namespace hotblade::pipeline {

namespace {

using Eigen::Vector2d;
using sweep_step::Bends;
using sweep_step::State;
using sweep_step::Tangents;

// Fourth-order steps of 20 mm are off by 1e-3 mm on arcs of 100 mm radius, and steps of 0.15 rad by less on
// wider ones. None is shorter: where a blade bends more sharply it is on its way to a fit. Longer ones than
// this save little.
constexpr double kStepRad = 0.15, kShortest_mm = 20, kLongestStep_mm = 60;

int steps_to_a_side(const Bend& bend, double reach_mm) {
  const double sharpest = std::abs(bend.kappa) + std::hypot(bend.tension1, bend.tension2) * reach_mm;
  const double step = std::min(std::max(kShortest_mm, kStepRad / sharpest), kLongestStep_mm);
  return std::max(1, static_cast<int>(std::ceil(reach_mm / step)));
}

// A direction turned on by an angle.
Vector2d turned_on(const Vector2d& t, double angle) {
  using One = double __attribute__((vector_size(sizeof(double))));
  const auto turn = sweep_step::turn_of<1>(One{angle});
  return {turn.c[0] * t.x() - turn.n[0] * t.y(), turn.n[0] * t.x() + turn.c[0] * t.y()};
}

// A number of each side of the curve: both are walked at once.
using Both = double __attribute__((vector_size(2 * sizeof(double))));

SweepPoint point_of(const State<Both>& s, const Tangents<Both>& t, int side, const Bend& bend) {
  const auto at = [&](std::size_t i) { return s.v[i][side]; };
  SweepPoint p;
  p.position = {at(0), at(4)};
  p.theta = at(8);
  p.tangent = {t.c[side], t.n[side]};
  p.kappa = bend.kappa + bend.tension2 * at(0) - bend.tension1 * at(4);
  p.by_bend << at(1), at(2), at(3), at(5), at(6), at(7);
  p.theta_by_bend << at(9), at(10), at(11);
  p.kappa_by_bend = bend.tension2 * p.by_bend.row(0) - bend.tension1 * p.by_bend.row(1) +
                    Eigen::RowVector3d(1, -at(4), at(0));
  return p;
}

}  // namespace

SweepCurve::SweepCurve(const Ask& ask) : bend_(ask.bend) {
  constexpr double kWay_mm = 80, kWayShare = 0.2;  // a first guess along the chord is short of the arc
  half_ = steps_to_a_side(bend_, ask.reach_mm);
  step_mm_ = ask.reach_mm / half_;
  before_ = behind_ = half_;
  if (!ask.place_mm) return;
  const double way = kWay_mm + kWayShare * std::abs(*ask.place_mm);
  const auto steps = [&](double mm) {
    return std::clamp(static_cast<int>(std::ceil(mm / step_mm_)), 0, half_);
  };
  before_ = steps(way - *ask.place_mm);
  behind_ = steps(way + *ask.place_mm);
}

SweepCurve::SweepCurve(const Bend& bend, double reach_mm) : SweepCurve(Ask{bend, reach_mm}) {
  walk();
}

std::vector<SweepCurve> SweepCurve::all(std::span<const Ask> asked, elastica::Simd simd) {
  std::vector<SweepCurve> curves;
  curves.reserve(asked.size());
  for (const Ask& ask : asked) curves.push_back(SweepCurve(ask));
  SweepWalk::walk(curves, simd);
  return curves;
}

// From the middle to both sides.
void SweepCurve::walk() {
  const int count = before_ + behind_ + 1;
  nodes_.resize(static_cast<std::size_t>(count));
  SweepPoint* const middle = nodes_.data() + before_;
  State<Both> state{};
  Tangents<Both> tangents{{1, 1}, {0, 0}};
  const Bends<Both> bends{
      {bend_.kappa, bend_.kappa}, {bend_.tension1, bend_.tension1}, {bend_.tension2, bend_.tension2}};
  const Both step{-step_mm_, step_mm_};
  for (int i = 0;; ++i) {
    if (i <= before_) middle[-i] = point_of(state, tangents, 0, bend_);
    if (i <= behind_) middle[i] = point_of(state, tangents, 1, bend_);
    if (i >= std::max(before_, behind_)) break;
    state = sweep_step::stepped<2>(state, tangents, bends, step);
  }
}

SweepCurve::Onward SweepCurve::onward(double s) const {
  const double at = std::nearbyint(s * (1 / step_mm_));
  Onward on;
  on.node = nodes_.data() + before_ + static_cast<int>(at);
  const double d = s - at * step_mm_, d2 = d * d, d3 = d2 * d, d4 = d3 * d, k = on.node->kappa;
  const Vector2d &t = on.node->tangent, n = on.node->normal();
  on.d = d;
  on.k1 = bend_.tension2 * t.x() - bend_.tension1 * t.y();
  on.k2 = k * (bend_.tension2 * n.x() - bend_.tension1 * n.y());
  on.way = (d - k * k * (d3 * (1 / 6.0)) - k * on.k1 * (d4 * (1 / 8.0))) * t +
           (k * (d2 * (1 / 2.0)) + on.k1 * (d3 * (1 / 6.0)) + (on.k2 - k * k * k) * (d4 * (1 / 24.0))) * n;
  return on;
}

SweepPoint SweepCurve::at(double s_mm) const {
  const Onward on = onward(clamped(s_mm));
  const SweepPoint& p = *on.node;
  const double d = on.d, d2 = d * d, d3 = d2 * d;
  const Vector2d &t = p.tangent, n = p.normal();
  SweepPoint q;
  q.position = p.position + on.way;
  q.theta = p.theta + p.kappa * d + on.k1 * (d2 * (1 / 2.0)) + on.k2 * (d3 * (1 / 6.0));
  q.tangent = turned_on(t, q.theta - p.theta);
  q.kappa = p.kappa + on.k1 * d + on.k2 * (d2 * (1 / 2.0));
  // The rest of the way turns with the node, and bends with its curvature and that one's slope.
  const Eigen::RowVector3d slope = p.theta_by_bend * (bend_.tension2 * n.x() - bend_.tension1 * n.y()) +
                                   Eigen::RowVector3d(0, -t.y(), t.x());
  q.by_bend = p.by_bend + Vector2d(-on.way.y(), on.way.x()) * p.theta_by_bend +
              n * (d2 * (1 / 2.0) * p.kappa_by_bend + d3 * (1 / 6.0) * slope);
  q.theta_by_bend = p.theta_by_bend + d * p.kappa_by_bend + d2 * (1 / 2.0) * slope;
  q.kappa_by_bend = p.kappa_by_bend + d * slope;
  return q;
}

double SweepCurve::nearest(const Vector2d& q, double guess_mm) const {
  using namespace sweep_step;
  double s = clamped(guess_mm);
  for (int i = 0; i < kNearestSteps; ++i) {
    const Onward on = onward(s);
    const Vector2d away = q - on.node->position - on.way;
    // The tangent turned on from the node, to the fourth order of the way's angle.
    const double turn = on.node->kappa * on.d + on.k1 * on.d * on.d * (1 / 2.0), square = turn * turn;
    const double c = 1 - square * (1 / 2.0) + square * square * (1 / 24.0),
                 n = turn * (1 - square * (1 / 6.0));
    const Vector2d& t0 = on.node->tangent;
    const Vector2d t(c * t0.x() - n * t0.y(), n * t0.x() + c * t0.y());
    const double kappa = on.node->kappa + on.k1 * on.d;
    const double bent = 1 - kappa * (t.x() * away.y() - t.y() * away.x());
    const double step =
        std::clamp(away.dot(t) / std::max(bent, kLeastBent), -kLongestNearest_mm, kLongestNearest_mm);
    const double next = clamped(s + step);
    const bool settled = std::abs(next - s) <= kNearEnough_mm;
    s = next;
    if (settled) break;
  }
  return s;
}

}  // namespace hotblade::pipeline

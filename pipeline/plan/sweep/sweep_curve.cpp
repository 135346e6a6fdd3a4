#include "pipeline/plan/sweep/sweep_curve.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace hotblade::pipeline {

namespace {

using Eigen::Vector2d;

// Fourth-order steps of 20 mm are off by 1e-3 mm on arcs of 100 mm radius, and steps of 0.15 rad by less on
// wider ones. None is shorter: where a blade bends more sharply it is on its way to a fit. Longer ones than
// this save little.
constexpr double kStepRad = 0.15, kShortest_mm = 20, kLongestStep_mm = 60;

int steps_to_a_side(const Bend& bend, double reach_mm) {
  const double sharpest = std::abs(bend.kappa) + std::hypot(bend.tension1, bend.tension2) * reach_mm;
  const double step = std::min(std::max(kShortest_mm, kStepRad / sharpest), kLongestStep_mm);
  return std::max(1, static_cast<int>(std::ceil(reach_mm / step)));
}

// Up to here the series below are off by 1e-10; between nodes angles are smaller. They cost a fifth of the
// library's functions.
constexpr double kSmallAngle = 0.5;

template <typename T>
[[gnu::always_inline]] inline T small_cosine(const T& square) {
  return 1 - square / 2 * (1 - square / 12 * (1 - square / 30 * (1 - square / 56)));
}
template <typename T>
[[gnu::always_inline]] inline T small_sine(const T& angle, const T& square) {
  return angle * (1 - square / 6 * (1 - square / 20 * (1 - square / 42 * (1 - square / 72))));
}

// A direction turned on by an angle.
Vector2d turned_on(const Vector2d& t, double angle) {
  const bool small = std::abs(angle) < kSmallAngle;
  const double c = small ? small_cosine(angle * angle) : std::cos(angle),
               n = small ? small_sine(angle, angle * angle) : std::sin(angle);
  return {c * t.x() - n * t.y(), n * t.x() + c * t.y()};
}

// A number of each side of the curve: both are walked at once.
using Both = Eigen::Array2d;

struct Tangents {
  Both c{1, 1}, n{0, 0};

  [[nodiscard, gnu::always_inline]] Tangents turned(const Both& angle) const {
    Both cosine, sine;
    if (std::abs(angle[0]) < kSmallAngle && std::abs(angle[1]) < kSmallAngle) {
      const Both square = angle * angle;
      cosine = small_cosine(square);
      sine = small_sine(angle, square);
    } else {
      cosine = angle.cos();
      sine = angle.sin();
    }
    return {cosine * c - sine * n, sine * c + cosine * n};
  }
};

// x, y, theta, and each one's derivatives by kappa, tension1, tension2 behind it.
struct State {
  std::array<Both, 12> v;

  State() { v.fill(Both(0, 0)); }
  [[nodiscard]] const Both& x() const { return v[0]; }
  [[nodiscard]] const Both& y() const { return v[4]; }
  [[nodiscard]] const Both& theta() const { return v[8]; }
  [[nodiscard]] State moved(const State& by, const Both& way) const {
    State t;
    for (std::size_t i = 0; i < v.size(); ++i) t.v[i] = v[i] + way * by.v[i];
    return t;
  }
};

// `t` is the state's direction.
[[gnu::always_inline]] inline State rate(const State& s, const Tangents& t, const Bend& bend) {
  State r;
  r.v[0] = t.c;
  r.v[4] = t.n;
  r.v[8] = bend.kappa + bend.tension2 * s.x() - bend.tension1 * s.y();
  for (std::size_t i = 1; i < 4; ++i) {
    r.v[i] = -t.n * s.v[8 + i];
    r.v[4 + i] = t.c * s.v[8 + i];
    r.v[8 + i] = bend.tension2 * s.v[i] - bend.tension1 * s.v[4 + i];
  }
  r.v[9] += 1;
  r.v[10] -= s.y();
  r.v[11] += s.x();
  return r;
}

// A step of each side; `t` is the state's direction before and after.
State stepped(const State& s, Tangents& t, const Bend& bend, const Both& h) {
  const auto rate_at = [&](const State& on) { return rate(on, t.turned(on.theta() - s.theta()), bend); };
  const State a = rate(s, t, bend), b = rate_at(s.moved(a, h / 2)), c = rate_at(s.moved(b, h / 2)),
              d = rate_at(s.moved(c, h));
  State next;
  for (std::size_t i = 0; i < s.v.size(); ++i)
    next.v[i] = s.v[i] + h / 6 * (a.v[i] + 2 * (b.v[i] + c.v[i]) + d.v[i]);
  t = t.turned(next.theta() - s.theta());
  return next;
}

SweepPoint point_of(const State& s, const Tangents& t, int side, const Bend& bend) {
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

SweepCurve::SweepCurve(const Bend& bend, double reach_mm)
    : bend_(bend), half_(steps_to_a_side(bend, reach_mm)) {
  step_mm_ = reach_mm / half_;
  before_ = behind_ = half_;
  walk();
}

SweepCurve::SweepCurve(const Bend& bend, double reach_mm, double place_mm)
    : bend_(bend), half_(steps_to_a_side(bend, reach_mm)) {
  constexpr double kWay_mm = 80, kWayShare = 0.2;  // a first guess along the chord is short of the arc
  step_mm_ = reach_mm / half_;
  const double way = kWay_mm + kWayShare * std::abs(place_mm);
  const auto steps = [&](double mm) {
    return std::clamp(static_cast<int>(std::ceil(mm / step_mm_)), 0, half_);
  };
  before_ = steps(way - place_mm);
  behind_ = steps(way + place_mm);
  walk();
}

// From the middle to both sides.
void SweepCurve::walk() {
  nodes_.resize(static_cast<std::size_t>(before_ + behind_ + 1));
  State state;
  Tangents tangents;
  const Both step(-step_mm_, step_mm_);
  for (int i = 0;; ++i) {
    if (i <= before_) nodes_[static_cast<std::size_t>(before_ - i)] = point_of(state, tangents, 0, bend_);
    if (i <= behind_) nodes_[static_cast<std::size_t>(before_ + i)] = point_of(state, tangents, 1, bend_);
    if (i >= std::max(before_, behind_)) break;
    state = stepped(state, tangents, bend_, step);
  }
}

SweepCurve::Onward SweepCurve::onward(double s) const {
  const int at = static_cast<int>(std::lround(s / step_mm_));
  Onward on;
  on.node = &nodes_[static_cast<std::size_t>(before_ + at)];
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
  const Onward on = onward(clamped(s_mm));
  const SweepPoint& p = *on.node;
  const double d = on.d, d2 = d * d, d3 = d2 * d;
  const Vector2d &t = p.tangent, n = p.normal();
  SweepPoint q;
  q.position = p.position + on.way;
  q.theta = p.theta + p.kappa * d + on.k1 * d2 / 2 + on.k2 * d3 / 6;
  q.tangent = turned_on(t, q.theta - p.theta);
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
  double s = clamped(guess_mm);
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
    const double next = clamped(s + step);
    const bool settled = std::abs(next - s) <= kEnough_mm;
    s = next;
    if (settled) break;
  }
  return s;
}

}  // namespace hotblade::pipeline

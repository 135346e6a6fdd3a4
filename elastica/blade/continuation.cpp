#include "elastica/blade/continuation.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "elastica/blade/end_map.hpp"
#include "elastica/blade/stability.hpp"

namespace hotblade::elastica {

namespace {

using Eigen::Vector3d;

// Everything below is for a blade of length 1 that starts at the origin along the x axis: unknowns
// (kappa, lambda1, lambda2), wanted (x, y, theta) of the end.

Vector3d wanted_end(const ClampPair& c, double length) {
  const double dx = (c.b.x - c.a.x) / length, dy = (c.b.y - c.a.y) / length;
  const double co = std::cos(c.a.theta), si = std::sin(c.a.theta);
  return {co * dx + si * dy, co * dy - si * dx, c.b.theta - c.a.theta};
}

Vector3d unknowns_of(const Elastica& e) {
  const Eigen::Vector2d force = force_along(e, e.theta) * (e.length * e.length);
  return {e.kappa * e.length, force.x(), force.y()};
}

Elastica unit_blade(const Vector3d& p) {
  return {0, 0, 0, p[0], p[1], p[2], 1};
}

Elastica placed(const Vector3d& p, const PlanarPose& a, double length) {
  const double co = std::cos(a.theta), si = std::sin(a.theta), l2 = length * length;
  return {a.x,   a.y, a.theta, p[0] / length, (co * p[1] - si * p[2]) / l2, (si * p[1] + co * p[2]) / l2,
          length};
}

// Whether Newton's method may go on from these unknowns.
bool usable(const Vector3d& p, const Vector3d& wanted) {
  // More than ten waves, or as many turns: not where a blade comes to from a neighbouring shape.
  constexpr double kLargestRate = 100;
  return p.allFinite() && taylor_rate(0, p[0], p[1], p[2]) < kLargestRate &&
         p[1] * wanted[0] + p[2] * wanted[1] > -kLargestTension;
}

// What Newton's method reaches on a relaxed blade; in a search it is as good as the ends.
double fine_tolerance(Exactness exactness) {
  return exactness == Exactness::kSearch ? 1e-9 : 1e-12;
}

struct Solved {
  Vector3d p;
  JacobiFields end;
  int steps = 0;
  Vector3d went = Vector3d::Zero(), bent = Vector3d::Zero();  // ClampedShape
};

// Size of a change of the unknowns as a change of curvature: a force changes curvature by its moment.
double bend_of(const Vector3d& d) {
  return std::abs(d[0]) + 0.5 * (std::abs(d[1]) + std::abs(d[2]));
}

// Whether the end is off by so little after a step that it is not evaluated again, by a measured bound:
// its second derivatives are sums of products of the fields. Of stable blades no more taut than is looked
// for, with loops under tension among them, none was off by more than 0.6 of that and hardly one by a
// twentieth (tests/elastica/blade/continuation_test.cpp).
bool is_last(const JacobiFields& end, const Vector3d& step, Exactness exactness) {
  constexpr double kCurved = 32;
  const double off = exactness == Exactness::kSearch ? kClampTolerance : 1e-2 * kClampTolerance;
  const double bend = std::max(1.0, end.fields.cwiseAbs().maxCoeff()) * bend_of(step);
  return kCurved * bend * bend < off;
}

// Nothing where it does not converge, or its first step is larger than that.
std::optional<Solved> newton(Vector3d p, const Vector3d& wanted, Exactness exactness,
                             double largest_correction = std::numeric_limits<double>::infinity()) {
  constexpr int kMostSteps = 12;
  const double fine = fine_tolerance(exactness);
  Solved s;
  double last = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kMostSteps; ++i) {
    if (!usable(p, wanted)) return std::nullopt;
    s.end = end_map(unit_blade(p), exactness);
    const Vector3d miss = wanted - Vector3d(s.end.point.x, s.end.point.y, s.end.point.theta);
    const double error = miss.cwiseAbs().maxCoeff();
    // Rounding may keep a taut blade from the tolerance proper: the step that no longer helps is the last.
    if (error < fine || (error < kClampTolerance && error > 0.25 * last)) {
      s.p = p;
      s.steps = i;
      return s;
    }
    // Far from convergence after the first steps: Newton's method wanders.
    if (i > 3 && error > 0.5 * last) return std::nullopt;
    last = error;
    const Vector3d step = s.end.fields.partialPivLu().solve(miss);
    if (i == 0 && !(bend_of(step) <= largest_correction)) return std::nullopt;
    p += step;
    if (is_last(s.end, step, exactness)) {
      s.p = p;
      s.end.point.x = wanted[0];
      s.end.point.y = wanted[1];
      s.end.point.theta = wanted[2];
      s.end.point.kappa += s.end.rates.dot(step);
      s.steps = i + 1;
      return s;
    }
  }
  return std::nullopt;
}

ClampedShape shape_of(const Solved& s, const PlanarPose& a, double length) {
  return {placed(s.p, a, length), s.end.index, s.steps, s.end, s.went, s.bent};
}

// Of a blade that starts so, by the end of the blade 1 long.
ClampPair clamps_by(const Elastica& e, const CurvePoint& unit_end) {
  const double co = std::cos(e.theta), si = std::sin(e.theta);
  return {{e.x, e.y, e.theta},
          {e.x + e.length * (co * unit_end.x - si * unit_end.y),
           e.y + e.length * (si * unit_end.x + co * unit_end.y), e.theta + unit_end.theta}};
}

PlanarPose between(const PlanarPose& p, const PlanarPose& q, double t) {
  return {p.x + t * (q.x - p.x), p.y + t * (q.y - p.y), p.theta + t * (q.theta - p.theta)};
}

ClampPair between(const ClampPair& p, const ClampPair& q, double t) {
  return {between(p.a, q.a, t), between(p.b, q.b, t)};
}

void check(const Elastica& e, const ClampPair& c) {
  for (const double v : {e.x, e.y, e.theta, e.kappa, e.lambda1, e.lambda2, e.length, c.a.x, c.a.y, c.a.theta,
                         c.b.x, c.b.y, c.b.theta}) {
    if (!std::isfinite(v)) throw std::logic_error("blade and clamp poses must be finite");
  }
  if (!(e.length > 0)) throw std::logic_error("a blade needs a length");
}

// What a branch bends from its tangent by over a step of the end: by the square of the step as much as over
// the one before, where it goes on as that did.
Vector3d bend_over(const Solved& at, const Vector3d& step) {
  constexpr double kAlong = 0.9;  // cosine of the angle between both
  const double before = at.went.norm(), now = step.norm();
  if (!(before > 0) || !(at.went.dot(step) > kAlong * before * now)) return Vector3d::Zero();
  constexpr double kLonger = 4;
  const double share = std::min(kLonger, now / before);
  return share * share * at.bent;
}

// One blade on its way; `at` is the last place reached.
class Walk {
 public:
  Walk(const ClampedShape& from, const ClampPair& to, Exactness exactness)
      : from_(clamps_by(from.elastica, from.end.point)),
        to_(to),
        length_(from.elastica.length),
        exactness_(exactness) {
    at_ = {unknowns_of(from.elastica), from.end, 0, from.went, from.bent};
  }

  [[nodiscard]] double place() const { return place_; }
  [[nodiscard]] ClampedShape shape() const { return shape_of(at_, between(from_, to_, place_).a, length_); }

  // Why the branch cannot be followed any further. At a fold or a branching the smallest eigenvalue goes
  // through zero; a blade pulled straight keeps its own, or only gets stiffer.
  [[nodiscard]] FollowStatus lost_by(double smallest_step) const {
    constexpr double kNearFold = 1, kTaut = 0.5 * kLargestTension, kSteps = 10;
    const Vector3d ahead = wanted(std::min(1.0, place_ + kSteps * smallest_step));
    const bool straight = ahead.head<2>().norm() > 1;
    const bool taut = -(at_.p[1] * ahead[0] + at_.p[2] * ahead[1]) > kTaut;
    if (!straight && !taut) return FollowStatus::kSnapped;
    return stability_margin(unit_blade(at_.p)) < kNearFold ? FollowStatus::kSnapped
                                                           : FollowStatus::kOutOfReach;
  }

  // The equilibrium at t on the same branch, if it can be told from here.
  bool step_to(double t) {
    const Vector3d here(at_.end.point.x, at_.end.point.y, at_.end.point.theta);
    const Vector3d step = wanted(t) - here;
    const Vector3d predicted = at_.end.fields.partialPivLu().solve(step);
    // The corrector's part of the step measures how far the branch bends; beyond this share, and beyond what
    // is small for any blade, another branch might have been met.
    constexpr double kBend = 0.2, kSmall = 1e-3;
    const double correction = kBend * bend_of(predicted) + kSmall;
    std::optional<Solved> next =
        newton(at_.p + predicted + bend_over(at_, step), wanted(t), exactness_, correction);
    if (!next || next->end.index != at_.end.index) return false;
    next->went = step;
    next->bent = next->p - at_.p - predicted;
    if (bend_of(next->bent) > 2 * correction) return false;
    at_ = *next;
    place_ = t;
    return true;
  }

 private:
  [[nodiscard]] Vector3d wanted(double t) const { return wanted_end(between(from_, to_, t), length_); }

  ClampPair from_, to_;
  double length_;
  Exactness exactness_;
  Solved at_;
  double place_ = 0;
};

}  // namespace

ClampPair clamps_of(const Elastica& elastica) {
  const CurvePoint b = ElasticaCurve(elastica).at(elastica.length);
  return {{elastica.x, elastica.y, elastica.theta}, {b.x, b.y, b.theta}};
}

std::optional<ClampedShape> solve_clamped(const Elastica& near, const ClampPair& clamps) {
  check(near, clamps);
  const std::optional<Solved> s =
      newton(unknowns_of(near), wanted_end(clamps, near.length), Exactness::kRounding);
  if (!s) return std::nullopt;
  return shape_of(*s, clamps.a, near.length);
}

FollowReport follow(const Elastica& from, const ClampPair& to, const FollowOptions& options) {
  check(from, to);
  const JacobiFields end = end_map(unit_blade(unknowns_of(from)), options.exactness);
  return follow_on(ClampedShape{from, end.index, 0, end, {0, 0, 0}, {0, 0, 0}}, to, options);
}

FollowReport follow_on(const ClampedShape& from, const ClampPair& to, const FollowOptions& options) {
  check(from.elastica, to);
  Walk walk(from, to, options.exactness);
  FollowReport report;
  double step = 1;
  while (walk.place() < 1) {
    ++report.steps;
    const double t = std::min(1.0, walk.place() + step);
    if (walk.step_to(t)) {
      step *= 2;
      continue;
    }
    step = 0.5 * (t - walk.place());
    if (step < options.smallest_step) {
      report.status = walk.lost_by(options.smallest_step);
      break;
    }
  }
  report.shape = walk.shape();
  report.fraction = walk.place();
  return report;
}

}  // namespace hotblade::elastica

#include "elastica/projection/project_polish.hpp"

#include <algorithm>
#include <cmath>

#include "elastica/bezier/residual_batch.hpp"

namespace hotblade::elastica {

namespace {

// Stands for a cusp or crossing edges: worse than any residual.
constexpr double kNoCurve = 4;
// Distance kept from where edges cross or a branch ends, in the logarithm: far above rounding of the test,
// far below what a residual shows.
constexpr double kMargin = 1e-9;
// Step of the gradient's differences: gradients are exact to about 1e-9, so the Hessian is to 1e-4.
constexpr double kDifference = 1e-4;
constexpr double kFirstRadius = 0.2, kLargestRadius = 0.5, kSmallestRadius = 1e-8;
constexpr int kMostSweeps = 120;
// A step that leaves less of the gradient than this keeps the Hessian for the next one.
constexpr double kGoodStep = 0.3;

// Columns of a gradient batch and its results.
struct Points {
  std::vector<double> a1, a2, l1, l2, e, by1, by2;
  std::vector<ResidualStatus> status;

  void clear() {
    for (auto* column : {&a1, &a2, &l1, &l2}) column->clear();
  }
  void add(double x1, double x2, double u, double v) {
    a1.push_back(x1);
    a2.push_back(x2);
    l1.push_back(std::exp(u));
    l2.push_back(std::exp(v));
  }
  void evaluate() {
    for (auto* column : {&e, &by1, &by2}) column->resize(a1.size());
    status.resize(a1.size());
    lambda_residual_gradients({a1, a2, l1, l2}, {e, status}, by1, by2);
  }
};

struct Value {
  double e2, gu, gv;
};

Value value(const Points& p, std::size_t i) {
  if (p.status[i] == ResidualStatus::kCusp) return {kNoCurve, 0, 0};
  return {p.e[i] * p.e[i], 2 * p.e[i] * p.by1[i] * p.l1[i], 2 * p.e[i] * p.by2[i] * p.l2[i]};
}

// Without hypot's care about overflow, at a fifth of its cost.
double length(double x, double y) {
  return std::sqrt(x * x + y * y);
}

struct Step {
  double du = 0, dv = 0, gain = 0;  // gain: what the quadratic model promises
};

enum class Next { kBend, kTry, kDone };

struct Lane {
  Descent* descent = nullptr;
  std::optional<CrossingCorner> corner;
  Value at{kNoCurve, 0, 0};
  double huu = 0, huv = 0, hvv = 0;
  double radius = kFirstRadius;
  double trial_u = 0, trial_v = 0, trial_gain = 0;
  Next next = Next::kBend;
  bool fresh = true;  // nothing evaluated yet
  bool stale = true;  // the Hessian is not from where the lane is
};

// Where the lane may go from where it is: its box, cut where the edges would cross.
EdgeBox room(const Lane& lane) {
  EdgeBox box = lane.descent->box;
  if (!lane.corner) return box;
  const double u = lane.descent->u, v = lane.descent->v;
  if (v >= lane.corner->v) {
    box.u1 = std::min(box.u1, lane.corner->u - kMargin);
  } else if (u >= lane.corner->u) {
    box.v1 = std::min(box.v1, lane.corner->v - kMargin);
  }
  return box;
}

// The step along one axis when the other is held.
double single(double g, double h, double radius) {
  const double d = h > 0 ? -g / h : -std::copysign(radius, g);
  return std::clamp(d, -radius, radius);
}

// Newton's step of both, bent towards descent where the Hessian is not positive, within the radius.
Step both(const Lane& lane) {
  const double half = 0.5 * (lane.huu + lane.hvv), root = length(0.5 * (lane.huu - lane.hvv), lane.huv);
  const double least = half - root, most = std::max(std::abs(half + root), std::abs(least));
  constexpr double kFlat = 1e-9;
  const double shift = least > kFlat * most ? 0 : -least + std::max(kFlat * most, 0.1 * std::abs(least));
  const double a = lane.huu + shift, d = lane.hvv + shift, det = a * d - lane.huv * lane.huv;
  Step s;
  if (!(det > 0)) return s;
  s.du = -(d * lane.at.gu - lane.huv * lane.at.gv) / det;
  s.dv = -(a * lane.at.gv - lane.huv * lane.at.gu) / det;
  const double size = length(s.du, s.dv);
  if (size > lane.radius) {
    s.du *= lane.radius / size;
    s.dv *= lane.radius / size;
  }
  return s;
}

Step plan_step(const Lane& lane) {
  const EdgeBox box = room(lane);
  const double u = lane.descent->u, v = lane.descent->v, gu = lane.at.gu, gv = lane.at.gv;
  const bool hold_u = (u <= box.u0 && gu > 0) || (u >= box.u1 && gu < 0);
  const bool hold_v = (v <= box.v0 && gv > 0) || (v >= box.v1 && gv < 0);
  Step s;
  if (!hold_u && !hold_v) {
    s = both(lane);
    const double du = std::clamp(u + s.du, box.u0, box.u1) - u, dv = std::clamp(v + s.dv, box.v0, box.v1) - v;
    if (du != s.du && dv == s.dv) s.dv = single(gv + lane.huv * du, lane.hvv, lane.radius);
    if (dv != s.dv && du == s.du) s.du = single(gu + lane.huv * dv, lane.huu, lane.radius);
  } else if (!hold_u) {
    s.du = single(gu, lane.huu, lane.radius);
  } else if (!hold_v) {
    s.dv = single(gv, lane.hvv, lane.radius);
  }
  s.du = std::clamp(u + s.du, box.u0, box.u1) - u;
  s.dv = std::clamp(v + s.dv, box.v0, box.v1) - v;
  if (lane.corner && u + s.du >= lane.corner->u && v + s.dv >= lane.corner->v)
    s.du = lane.corner->u - kMargin - u;
  s.gain = -(gu * s.du + gv * s.dv +
             0.5 * (lane.huu * s.du * s.du + 2 * lane.huv * s.du * s.dv + lane.hvv * s.dv * s.dv));
  return s;
}

void plan_trial(Lane& lane, const DescentEnd& end) {
  const Step s = plan_step(lane);
  const double e = std::sqrt(lane.at.e2), worth = std::max(end.share * e, end.least) * (2 * e + end.least);
  if (!(s.gain > worth) || lane.radius < kSmallestRadius) {
    lane.next = Next::kDone;
    return;
  }
  lane.trial_u = lane.descent->u + s.du;
  lane.trial_v = lane.descent->v + s.dv;
  lane.trial_gain = s.gain;
  lane.next = Next::kTry;
}

// Differences away from the nearer end of the box.
double difference(double x, double low, double high) {
  return x - low < high - x ? kDifference : -kDifference;
}

void take_bend(Lane& lane, const Points& p, std::size_t& i, const DescentEnd& end) {
  const EdgeBox& box = lane.descent->box;
  const double hu = difference(lane.descent->u, box.u0, box.u1),
               hv = difference(lane.descent->v, box.v0, box.v1);
  if (lane.fresh) {
    lane.fresh = false;
    lane.at = value(p, i++);
    if (lane.huu != 0) {  // given: the first step goes without differences
      if (lane.at.e2 > 1) {
        lane.next = Next::kDone;
      } else {
        plan_trial(lane, end);
      }
      return;
    }
  }
  const Value by_u = value(p, i++), by_v = value(p, i++);
  if (lane.at.e2 > 1 || by_u.e2 > 1 || by_v.e2 > 1) {
    lane.next = Next::kDone;
    return;
  }
  lane.huu = (by_u.gu - lane.at.gu) / hu;
  lane.hvv = (by_v.gv - lane.at.gv) / hv;
  lane.stale = false;
  lane.huv = 0.5 * ((by_u.gv - lane.at.gv) / hu + (by_v.gu - lane.at.gu) / hv);
  plan_trial(lane, end);
}

void take_trial(Lane& lane, const Points& p, std::size_t& i, const DescentEnd& end) {
  const Value v = value(p, i++);
  const double size = length(lane.trial_u - lane.descent->u, lane.trial_v - lane.descent->v);
  if (!(v.e2 < lane.at.e2)) {
    lane.radius = 0.25 * size;
    if (lane.stale) {
      lane.next = Next::kBend;
    } else {
      plan_trial(lane, end);
    }
    return;
  }
  const bool good = length(v.gu, v.gv) < kGoodStep * length(lane.at.gu, lane.at.gv);
  const bool promised = lane.at.e2 - v.e2 > 0.7 * lane.trial_gain;
  if (promised) lane.radius = std::min(kLargestRadius, 2 * std::max(lane.radius, size));
  lane.descent->u = lane.trial_u;
  lane.descent->v = lane.trial_v;
  lane.at = v;
  lane.stale = true;
  if (good) {
    plan_trial(lane, end);
  } else {
    lane.next = Next::kBend;
  }
}

void ask(const Lane& lane, Points& p) {
  const Descent& d = *lane.descent;
  if (lane.next == Next::kTry) {
    p.add(d.a1, d.a2, lane.trial_u, lane.trial_v);
  } else if (lane.next == Next::kBend) {
    if (lane.fresh) p.add(d.a1, d.a2, d.u, d.v);
    if (lane.fresh && lane.huu != 0) return;
    p.add(d.a1, d.a2, d.u + difference(d.u, d.box.u0, d.box.u1), d.v);
    p.add(d.a1, d.a2, d.u, d.v + difference(d.v, d.box.v0, d.box.v1));
  }
}

Lane lane_of(Descent& d) {
  Lane lane;
  lane.descent = &d;
  lane.huu = d.huu;
  lane.huv = d.huv;
  lane.hvv = d.hvv;
  lane.corner = crossing_corner(d.a1, d.a2);
  d.u = std::clamp(d.u, d.box.u0, d.box.u1);
  d.v = std::clamp(d.v, d.box.v0, d.box.v1);
  if (lane.corner && d.u >= lane.corner->u && d.v >= lane.corner->v) {
    // Out of the crossing by the shorter way.
    (d.u - lane.corner->u < d.v - lane.corner->v ? d.u : d.v) =
        (d.u - lane.corner->u < d.v - lane.corner->v ? lane.corner->u : lane.corner->v) - kMargin;
    if (d.u < d.box.u0 || d.v < d.box.v0) lane.next = Next::kDone;
  }
  return lane;
}

}  // namespace

EdgeBox edge_domain() {
  static const double low = std::log(kShortestEdge), high = std::log(kLongestEdge);
  return {low, high, low, high};
}

std::optional<CrossingCorner> crossing_corner(double a1, double a2) {
  const auto meeting = edge_meeting({a1, a2, 1, 1});
  if (!meeting || !((*meeting)[0] > 0) || !((*meeting)[1] > 0)) return std::nullopt;
  return CrossingCorner{std::log((*meeting)[0]), std::log((*meeting)[1])};
}

std::optional<EdgeBox> branch_box(double a1, double a2, WantedBranch branch, double u, double v) {
  // The domain cut at ln m1 and ln m2, where they exist: up to four boxes, each wholly on one branch.
  const EdgeBox all = edge_domain();
  const auto meeting = edge_meeting({a1, a2, 1, 1});
  const auto cuts = [&all](double m, double low, double high) {
    std::vector<std::array<double, 2>> parts;
    const double cut = m > 0 ? std::log(m) : low - 1;
    if (cut - kMargin > low) parts.push_back({low, std::min(high, cut - kMargin)});
    if (cut + kMargin < high) parts.push_back({std::max(low, cut + kMargin), high});
    return parts;
  };
  std::optional<EdgeBox> nearest;
  double distance = 0;
  for (const auto& [u0, u1] : cuts(meeting ? (*meeting)[0] : -1, all.u0, all.u1)) {
    for (const auto& [v0, v1] : cuts(meeting ? (*meeting)[1] : -1, all.v0, all.v1)) {
      const StandardPosition middle{a1, a2, std::exp(0.5 * (u0 + u1)), std::exp(0.5 * (v0 + v1))};
      if (edges_cross(middle) || inflectional(middle) != (branch == WantedBranch::kInflectional)) continue;
      const double d = length(u - std::clamp(u, u0, u1), v - std::clamp(v, v0, v1));
      if (nearest && d >= distance) continue;
      nearest = EdgeBox{u0, u1, v0, v1};
      distance = d;
    }
  }
  return nearest;
}

void descend(std::span<Descent> descents, const DescentEnd& end) {
  std::vector<Lane> lanes;
  lanes.reserve(descents.size());
  for (Descent& d : descents) {
    lanes.push_back(lane_of(d));
    if (lanes.back().next == Next::kDone) {
      d.e2 = kNoCurve;
      lanes.pop_back();
    }
  }
  Points p;
  for (int sweep = 0; sweep < kMostSweeps && !lanes.empty(); ++sweep) {
    p.clear();
    for (const Lane& lane : lanes) ask(lane, p);
    p.evaluate();
    std::size_t i = 0;
    for (Lane& lane : lanes) {
      if (lane.next == Next::kTry) {
        take_trial(lane, p, i, end);
      } else {
        take_bend(lane, p, i, end);
      }
      lane.descent->e2 = lane.at.e2;
    }
    for (const Lane& lane : lanes) {
      lane.descent->huu = lane.huu;
      lane.descent->huv = lane.huv;
      lane.descent->hvv = lane.hvv;
    }
    std::erase_if(lanes, [](const Lane& lane) { return lane.next == Next::kDone; });
  }
}

std::vector<double> squared_residuals(double a1, double a2, std::span<const double> u,
                                      std::span<const double> v) {
  const std::vector<double> first(u.size(), a1), second(u.size(), a2);
  std::vector<double> l1(u.size()), l2(u.size()), e(u.size());
  std::vector<ResidualStatus> status(u.size());
  for (std::size_t i = 0; i < u.size(); ++i) {
    l1[i] = std::exp(u[i]);
    l2[i] = std::exp(v[i]);
  }
  lambda_residuals(EdgeBatch{first, second, l1, l2}, {e, status});
  const auto corner = crossing_corner(a1, a2);
  for (std::size_t i = 0; i < u.size(); ++i) {
    const bool crossing = corner && u[i] >= corner->u && v[i] >= corner->v;
    const bool none = status[i] == ResidualStatus::kCusp || crossing;
    e[i] = none ? kNoCurve : e[i] * e[i];
  }
  return e;
}

}  // namespace hotblade::elastica

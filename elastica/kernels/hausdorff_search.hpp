// The search behind the Hausdorff distance of two plane curves, refined until its bounds are near enough
// (elastica/bezier/curve_distance.hpp, gpu/curve/pair_distance.hpp).
//
// A Side is a curve over [0, 1]: at(u) gives a Point of it, bend(a, b) bounds its second derivative between
// two.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>
#include <vector>

namespace hotblade::elastica::hausdorff_search {

struct Point {
  double u = 0;
  Eigen::Vector2d p, d1, d2;
};

// Bounds between which the distance lies.
struct HausdorffRange {
  double lower = 0, upper = 0;
};

// A point of one curve and a near point of the other: `d` bounds its distance from above.
struct Pair {
  Point on, foot;
  double d = 0;
};

inline Pair paired(const Point& p, const Point& foot) {
  return {p, foot, (p.p - foot.p).norm()};
}

// The foot that Newton's method finds from a guess; it is never farther than the guess.
template <typename Side>
Pair with_foot(const Side& other, const Point& p, double guess) {
  Pair best = paired(p, other.at(guess));
  double u = guess;
  for (int i = 0; i < 6; ++i) {
    const Point q = i == 0 ? best.foot : other.at(u);
    const Eigen::Vector2d r = q.p - p.p;
    if (r.norm() < best.d) best = {p, q, r.norm()};
    const double slope = q.d1.squaredNorm() + r.dot(q.d2);
    if (!(slope > 0)) break;
    const double next = std::clamp(u - r.dot(q.d1) / slope, 0.0, 1.0);
    if (std::abs(next - u) < 1e-9) break;  // the distance is off by the square of that
    u = next;
  }
  return best;
}

inline constexpr int kCoarse = 64;

template <typename Side>
std::vector<Point> coarse_points(const Side& side) {
  std::vector<Point> points;
  for (int i = 0; i <= kCoarse; ++i) points.push_back(side.at(static_cast<double>(i) / kCoarse));
  return points;
}

template <typename Side>
Pair coarse_foot(const Side& other, const std::vector<Point>& coarse, const Point& p) {
  const auto near = std::min_element(coarse.begin(), coarse.end(), [&](const Point& a, const Point& b) {
    return (a.p - p.p).squaredNorm() < (b.p - p.p).squaredNorm();
  });
  return with_foot(other, p, near->u);
}

inline double segment_distance(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d ab = b - a;
  const double square = ab.squaredNorm();
  const double u = square > 0 ? std::clamp((p - a).dot(ab) / square, 0.0, 1.0) : 0;
  return (a + u * ab - p).norm();
}

// The sagitta of a piece of curve: how far it may leave its chord, run through at the same speed.
template <typename Side>
double sagitta(const Side& side, const Point& a, const Point& b) {
  const double h = b.u - a.u;
  return side.bend(a, b) * h * h / 8;
}

// Either a foot nearer than the pair's by more than `tolerance`, or the pair itself: its distance is then the
// true one to `tolerance`.
template <typename Side>
Pair certified(const Side& other, const std::vector<Point>& coarse, Pair pair, double tolerance,
               int& budget) {
  std::vector<std::pair<Point, Point>> open;
  for (std::size_t i = 1; i < coarse.size(); ++i) open.emplace_back(coarse[i - 1], coarse[i]);
  while (!open.empty() && budget > 0) {
    const auto [a, b] = open.back();
    open.pop_back();
    if (segment_distance(pair.on.p, a.p, b.p) - sagitta(other, a, b) >= pair.d - tolerance) continue;
    --budget;
    const Pair middle = with_foot(other, pair.on, 0.5 * (a.u + b.u));
    if (middle.d < pair.d) pair = middle;
    const Point m = other.at(0.5 * (a.u + b.u));
    open.emplace_back(a, m);
    open.emplace_back(m, b);
  }
  return pair;
}

struct Interval {
  double upper = 0;  // of the distance from any of its points to the other curve
  Pair a, b;
  bool operator<(const Interval& o) const { return upper < o.upper; }
};

// Between two samples both curves leave their chords by no more than a sagitta, and points that divide two
// chords in the same ratio are no farther apart than the farther ends. The other curve's chord may also
// shrink to either foot, which serves where the nearest point jumps from one part of the other curve to
// another.
template <typename Side, typename Other>
Interval bounded(const Side& side, const Other& other, const Pair& a, const Pair& b) {
  const double moving = std::max(a.d, b.d) + sagitta(other, a.foot, b.foot);
  const double at_a = std::max(a.d, (b.on.p - a.foot.p).norm());
  const double at_b = std::max(b.d, (a.on.p - b.foot.p).norm());
  return {std::min({moving, at_a, at_b}) + sagitta(side, a.on, b.on), a, b};
}

// Bounds of the largest distance from a point of `side` to `other`.
template <typename Side, typename Other>
HausdorffRange one_way(const Side& side, const Other& other, double tolerance) {
  int budget = 20000;
  const std::vector<Point> from = coarse_points(side), to = coarse_points(other);
  std::priority_queue<Interval> open;
  Pair last = coarse_foot(other, to, from.front()), farthest = last;
  for (std::size_t i = 1; i < from.size(); ++i) {
    const Pair next = coarse_foot(other, to, from[i]);
    if (next.d > farthest.d) farthest = next;
    open.push(bounded(side, other, last, next));
    last = next;
  }
  while (budget > 0 && open.top().upper > farthest.d + 0.5 * tolerance) {
    const Interval i = open.top();
    open.pop();
    --budget;
    const Point p = side.at(0.5 * (i.a.on.u + i.b.on.u));
    Pair m = with_foot(other, p, 0.5 * (i.a.foot.u + i.b.foot.u));
    const Pair global = coarse_foot(other, to, p);
    if (global.d < m.d) m = global;
    if (m.d > farthest.d) farthest = m;
    open.push(bounded(side, other, i.a, m));
    open.push(bounded(side, other, m, i.b));
  }
  const Pair sure = certified(other, to, farthest, 0.5 * tolerance, budget);
  const double lower = budget > 0 ? std::max(0.0, sure.d - 0.5 * tolerance) : 0;
  return {std::min(lower, open.top().upper), open.top().upper};
}

// Bounds of the Hausdorff distance, which is the greater of both ways.
template <typename Side, typename Other>
HausdorffRange both_ways(const Side& side, const Other& other, double tolerance) {
  const HausdorffRange there = one_way(side, other, tolerance), back = one_way(other, side, tolerance);
  return {std::max(there.lower, back.lower), std::max(there.upper, back.upper)};
}

}  // namespace hotblade::elastica::hausdorff_search

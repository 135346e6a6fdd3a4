// Tangent curves by brute force: the paper's locus, sampled densely, every local minimum of the samples.
#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "elastica/quadratic/quadratic_tangent.hpp"

namespace hotblade::elastica {

struct TangentProblem {
  Eigen::Vector2d b0, b2;
  bool circle = false;
  Eigen::Vector2d place;  // on the line, or the centre
  Eigen::Vector2d direction{1, 0};
  double radius = 0;
  Objective objective = Objective::kLength;
  [[nodiscard]] TangentCurves solve() const {
    return circle ? tangent_to_circle(b0, b2, place, radius, objective)
                  : tangent_to_line(b0, b2, place, direction, objective);
  }
  [[nodiscard]] double value(const Eigen::Vector2d& b1) const {
    return objective == Objective::kLength ? length({b0, b1, b2}) : energy({b0, b1, b2});
  }
};

struct BruteMinimum {
  Eigen::Vector2d b1;
  double value, step;  // step: how far b1 moves over the neighbouring samples
};

// Local minima among samples b1[i]; a sample with value NaN separates components.
inline void brute_minima(const TangentProblem& p, const std::vector<Eigen::Vector2d>& b1, bool closed,
                         std::vector<BruteMinimum>& found) {
  const std::size_t n = b1.size();
  std::vector<double> f;
  for (const auto& b : b1) f.push_back(b.allFinite() ? p.value(b) : NAN);
  for (std::size_t i = closed ? 0 : 1; i + (closed ? 0 : 1) < n; ++i) {
    const std::size_t before = (i + n - 1) % n, after = (i + 1) % n;
    if (!(f[i] < f[before] && f[i] <= f[after])) continue;
    found.push_back({b1[i], f[i], (b1[i] - b1[before]).norm() + (b1[i] - b1[after]).norm()});
  }
}

inline std::vector<BruteMinimum> brute_force(const TangentProblem& p, int n) {
  std::vector<BruteMinimum> found;
  std::vector<Eigen::Vector2d> b1;
  const double chord = (p.b2 - p.b0).norm();
  const auto along_line = [&](const Eigen::Vector2d& at, const Eigen::Vector2d& u) {
    b1.clear();
    for (int i = 0; i < n; ++i) {  // never at 0, where b1 may be an end
      b1.emplace_back(at + chord * std::sinh(12.0 * ((2.0 * i + 1) / (n + n % 2) - 1)) / 10 * u);
    }
    brute_minima(p, b1, false, found);
  };
  if (!p.circle) {
    const Eigen::Vector2d u = p.direction.normalized(), v{-u.y(), u.x()};
    const double a = v.dot(p.b0 - p.place), c = v.dot(p.b2 - p.place);
    const Eigen::Vector2d foot = p.b0 - a * v;
    along_line(foot + 0.5 * u.dot(p.b2 - p.b0) * u - (a > 0 ? 1 : -1) * std::sqrt(a * c) * v, u);
    return found;
  }
  const auto on = [&](const Eigen::Vector2d& b) {
    return std::abs((b - p.place).norm() - p.radius) < 1e-12 * p.radius;
  };
  for (int i = 0; i < n; ++i) {  // the paper's equation 6 as it stands
    const double theta = 2 * std::numbers::pi * (i + 0.5) / n;
    const Eigen::Vector2d r{p.radius * std::cos(theta), p.radius * std::sin(theta)}, c = p.place + r;
    const double h0 = (c - p.b0).dot(r) / p.radius, h2 = (c - p.b2).dot(r) / p.radius;
    if (h0 * h2 > 0) {
      b1.emplace_back(c + 0.5 * (std::sqrt(h2 / h0) * (c - p.b0) + std::sqrt(h0 / h2) * (c - p.b2)));
    } else {
      b1.emplace_back(NAN, NAN);
    }
  }
  // Past an end on the circle the locus jumps: its neighbouring samples there are not neighbours. And the
  // formula as it stands loses its digits next to such an end: no samples there.
  std::vector<Eigen::Vector2d> cut;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * std::numbers::pi * (i + 0.5) / n;
    cut.push_back(b1[static_cast<std::size_t>(i)]);
    for (const Eigen::Vector2d& e : {p.b0, p.b2}) {
      const double angle = std::atan2(e.y() - p.place.y(), e.x() - p.place.x());
      if (on(e) && std::abs(std::remainder(angle - a, 2 * std::numbers::pi)) < 7.0 / n)
        cut.back() = {NAN, NAN};
    }
  }
  brute_minima(p, cut, true, found);
  if (p.objective == Objective::kEnergy) {
    for (const Eigen::Vector2d& e : {p.b0, p.b2}) {
      const Eigen::Vector2d r = (e - p.place) / p.radius;
      if (on(e)) along_line(e, {-r.y(), r.x()});
    }
  }
  return found;
}

// Problem i of a seed: lines, and circles of the six cases by turns, lengths and energies.
inline TangentProblem random_problem(std::mt19937_64& random, int i) {
  std::uniform_real_distribution<double> u(-1, 1), positive(0, 1);
  const auto vector = [&] { return Eigen::Vector2d{u(random), u(random)}; };
  TangentProblem p;
  p.objective = i % 2 == 0 ? Objective::kLength : Objective::kEnergy;
  p.circle = i / 2 % 7 != 0;
  p.place = vector();
  if (!p.circle) {
    p.direction = vector();
    const Eigen::Vector2d across = Eigen::Vector2d{-p.direction.y(), p.direction.x()};
    const auto above = [&] {
      return Eigen::Vector2d{p.place + 2 * u(random) * p.direction + 2 * positive(random) * across};
    };
    p.b0 = above();
    p.b2 = above();
    return p;
  }
  p.radius = 0.05 + positive(random);
  const auto end = [&](int where) {  // 0 outside, 1 on, 2 inside
    const double a = 4 * u(random), q = positive(random);
    const double r = where == 0   ? p.radius * (1 + 3 * q * q)
                     : where == 1 ? p.radius
                                  : p.radius * std::sqrt(q);
    return Eigen::Vector2d{p.place + r * Eigen::Vector2d(std::cos(a), std::sin(a))};
  };
  const int cases[6][2] = {{0, 0}, {0, 2}, {0, 1}, {2, 2}, {1, 2}, {1, 1}};
  const int* c = cases[i / 2 % 7 - 1];
  const bool swap = u(random) > 0;
  p.b0 = end(c[swap ? 1 : 0]);
  p.b2 = end(c[swap ? 0 : 1]);
  return p;
}

}  // namespace hotblade::elastica

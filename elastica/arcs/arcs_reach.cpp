#include "elastica/arcs/arcs_reach.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace hotblade::elastica {

namespace {

using Eigen::Vector2d;

// The end of arcs (curvature, length) joined smoothly from the origin.
Vector2d end_of(std::initializer_list<std::pair<double, double>> arcs, double direction = 0) {
  CurvePoint at{0, 0, direction, 0};
  for (const auto& [kappa, length] : arcs) at = point_at(Arc{at.x, at.y, at.theta, kappa, length}, length);
  return at.position();
}

void check_reach(double k1, double k2, double l, int n) {
  if (!(l > 0) || !std::isfinite(l) || !(std::abs(k1) * l <= std::numbers::pi) ||
      !(std::abs(k2) * l <= std::numbers::pi) || k1 * k2 < 0 || n < 2) {
    throw std::logic_error(
        "spiral_reach needs a positive length, curvatures of one sign, turnings up to pi, 2 points");
  }
}

double distance_to_edge(const Vector2d& a, const Vector2d& b, const Vector2d& p) {
  const Vector2d d = b - a;
  const double t = d.squaredNorm() > 0 ? std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0;
  return (a + t * d - p).norm();
}

// One half as the planner of section 4.2 sees it: vertex curvatures first, top and last, lengths before and
// after the top; the second half is the mirror image of a first one.
struct Half {
  double first, top, last, before, after, turning;
  bool mirrored;
};

Half half_of(const Oval& o, int half, double mu) {
  if (half == 0) return {o.k[0], o.k[1], o.k[2], o.l[0], o.l[1], mu, false};
  return {o.k[0], o.k[3], o.k[2], o.l[3], o.l[2], 2 * std::numbers::pi - mu, true};
}

Vector2d placed(const Half& h, const Vector2d& end) {
  return h.mirrored ? Vector2d(end.x(), -end.y()) : end;
}

bool between(double a, double x, double b) {
  return std::min(a, b) <= x && x <= std::max(a, b);
}

// The arcs of the bound CD, linear in v.
struct Lengths {
  double l1, l2, l3;
};
Lengths cd_lengths(const Half& h, double v) {
  const double whole = h.before + h.after;
  const double l1 = (h.turning - h.top * (whole - 2 * v) - 2 * v * h.last) / (h.first - 2 * h.top + h.last);
  return {l1, whole - 2 * l1 - 2 * v, l1 + 2 * v};
}

}  // namespace

std::optional<LengthRange> convex_length_range(const BiarcFamily& f) {
  if (!(f.alpha * f.beta < 0)) return {};
  const auto arc = [&](double angle) { return 2 * f.c * (angle / std::sin(angle)); };
  if (std::abs(std::abs(f.alpha) - std::abs(f.beta)) < 1e-12) return LengthRange{arc(f.alpha), arc(f.alpha)};
  const bool first = std::abs(f.alpha) < std::abs(f.beta);
  const double straight =
      first ? -std::sin(f.omega()) / std::sin(f.alpha) : -std::sin(f.beta) / std::sin(f.omega());
  return LengthRange{arc(first ? f.alpha : f.beta), f.length(straight)};
}

std::optional<LengthRange> convex_length_range(const BiarcFamily& f, double kappa_a, double kappa_b) {
  const auto region = bilens(f, kappa_a, kappa_b);
  if (!region) return {};
  const double one = f.length(region->p1), other = f.length(region->p2);
  return LengthRange{std::min(one, other), std::max(one, other)};
}

std::vector<Vector2d> spiral_reach(double k1, double k2, double l, int n) {
  check_reach(k1, k2, l, n);
  std::vector<Vector2d> polygon;
  for (int i = 0; i < n; ++i) polygon.push_back(end_of({{k1 + (k2 - k1) * i / n, l}}));
  for (int i = 0; i < n; ++i) {
    const double t = l * (n - i) / n;
    polygon.push_back(end_of({{k1, l - t}, {k2, t}}));
  }
  return polygon;
}

std::vector<Vector2d> spiral_reach(double k1, double k2, double l, double turning, int n) {
  check_reach(k1, k2, l, n);
  const double joint = (turning - k1 * l) / (k2 - k1);  // length of the last arc of the biarc of k1 and k2
  if (!(joint >= 0 && joint <= l))
    throw std::logic_error("spiral_reach: the turning is beyond both curvatures");
  std::vector<Vector2d> polygon;
  for (int i = 0; i < n; ++i) {
    const double t = joint * i / n;
    polygon.push_back(end_of({{(turning - k2 * t) / (l - t), l - t}, {k2, t}}));
  }
  for (int i = 0; i < n; ++i) {
    const double t = joint + (l - joint) * i / n;
    polygon.push_back(end_of({{k1, l - t}, {t > 0 ? (turning - k1 * (l - t)) / t : k2, t}}));
  }
  return polygon;
}

bool spiral_reaches(double k1, double k2, double l, const Vector2d& end) {
  constexpr int kSide = 256;
  const std::vector<Vector2d> polygon = spiral_reach(k1, k2, l, kSide);
  // Points run along the bounds at speeds up to l^2 |k2 - k1| and turn by up to 2 pi on them, so that an edge
  // misses its arc by less than this.
  const double slack = l * (std::abs(k1 - k2) * l * std::numbers::pi / (4 * kSide * kSide) + 1e-12);
  int winding = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    if (distance_to_edge(a, b, end) <= slack) return true;
    const double side = (b.x() - a.x()) * (end.y() - a.y()) - (b.y() - a.y()) * (end.x() - a.x());
    if (a.y() <= end.y() && b.y() > end.y() && side > 0) ++winding;
    if (a.y() > end.y() && b.y() <= end.y() && side < 0) --winding;
  }
  return winding != 0;
}

std::optional<Vector2d> oval_bound_ab(const Oval& oval, int half, double mu, double u) {
  const Half h = half_of(oval, half, mu);
  const double whole = h.before + h.after;
  const double q1 = (h.turning - 2 * u * h.after) / whole, q2 = (h.turning + 2 * u * h.before) / whole;
  if (!between(h.first, q1, h.top) || !between(h.last, q2, h.top)) return {};
  return placed(h, end_of({{q1, h.before}, {q2, h.after}}, -0.5 * std::numbers::pi));
}

std::optional<Vector2d> oval_bound_cd(const Oval& oval, int half, double mu, double v) {
  const Half h = half_of(oval, half, mu);
  const auto [l1, l2, l3] = cd_lengths(h, v);
  if (!between(0, l1, h.before) || !between(0, l3, h.after)) return {};
  return placed(h, end_of({{h.first, l1}, {h.top, l2}, {h.last, l3}}, -0.5 * std::numbers::pi));
}

std::vector<OvalContact> oval_contacts(const Oval& oval) {
  using Eigen::Vector3d;
  double whole = 0;
  for (const double l : oval.l) whole += l;
  // Equations of a contact: the points coincide and the bounds are parallel. Central differences: a few parts
  // in 1e10.
  const auto equations = [&](int half, const Vector3d& x) -> std::optional<Vector3d> {
    const double du = 1e-5 / whole, dv = 1e-5 * whole;
    const auto a = oval_bound_ab(oval, half, x[0], x[1]), c = oval_bound_cd(oval, 1 - half, x[0], x[2]);
    const auto a0 = oval_bound_ab(oval, half, x[0], x[1] - du),
               a1 = oval_bound_ab(oval, half, x[0], x[1] + du);
    const auto c0 = oval_bound_cd(oval, 1 - half, x[0], x[2] - dv),
               c1 = oval_bound_cd(oval, 1 - half, x[0], x[2] + dv);
    if (!a || !c || !a0 || !a1 || !c0 || !c1) return {};
    const Vector2d p = (*a1 - *a0).normalized(), q = (*c1 - *c0).normalized();
    return Vector3d((a->x() - c->x()) / whole, (a->y() - c->y()) / whole, p.x() * q.y() - p.y() * q.x());
  };
  const auto newton = [&](int half, Vector3d x) -> std::optional<Vector3d> {
    const Vector3d step{1e-6, 1e-6 / whole, 1e-6 * whole};
    for (int i = 0; i < 40; ++i) {
      const auto f = equations(half, x);
      if (!f) return {};
      Eigen::Matrix3d jacobian;
      for (int k = 0; k < 3; ++k) {
        const auto g = equations(half, x + step[k] * Vector3d::Unit(k));
        if (!g) return {};
        jacobian.col(k) = (*g - *f) / step[k];
      }
      Vector3d d = jacobian.fullPivLu().solve(*f);
      if (!d.allFinite()) return {};
      d *= std::min(1.0,
                    0.3 / std::max({std::abs(d[0]), std::abs(d[1]) * whole, std::abs(d[2]) / whole, 1e-300}));
      x -= d;
      if (f->norm() < 1e-9) return x;
    }
    return {};
  };
  std::vector<OvalContact> found;
  constexpr int kGrid = 12;
  for (const int half : {0, 1}) {
    for (int i = 1; i < 2 * kGrid; ++i) {
      for (int j = 0; j <= kGrid; ++j) {
        for (int k = 0; k <= kGrid; ++k) {
          const double u = (2.0 * j / kGrid - 1) * 2 * std::numbers::pi / whole,
                       v = (2.0 * k / kGrid - 1) * whole / 4;
          const auto x = newton(half, {std::numbers::pi * i / kGrid, u, v});
          if (!x) continue;
          const bool known = std::any_of(found.begin(), found.end(), [&](const OvalContact& c) {
            return c.ab_half == half && std::abs(c.mu - (*x)[0]) < 1e-6 &&
                   std::abs(c.u - (*x)[1]) * whole < 1e-4;
          });
          if (!known) found.push_back({(*x)[0], (*x)[1], (*x)[2], half});
        }
      }
    }
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.mu < b.mu; });
  return found;
}

}  // namespace hotblade::elastica

#include "elastica/projection/project_zone.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace hotblade::elastica {

namespace {

// Edge-length constraint 2.
constexpr double kMostUneven = 1.3;
// Steps of a deformation; the first one inside the zone is then moved back to the boundary by halving.
constexpr int kZoneSteps = 64, kHalvings = 30;

// The quarter of the boundary with phi2 <= phi1 and phi1 + phi2 <= 2 pi: four cubic pieces, phi1 ascending.
class Boundary {
 public:
  static constexpr int kCount = 16, kQuarter = 4;

  Boundary() {
    // Once around: the paper's five points, mirrored in phi1 + phi2 = 2 pi, and both mirrored in phi1 = phi2.
    const Eigen::Vector2d given[] = {
        {1.05, 1.05}, {1.9, 1.3}, {std::numbers::pi, 1.35}, {4.3, 1.3}, {5.2, 2 * std::numbers::pi - 5.2}};
    const auto across = [](const Eigen::Vector2d& p) {
      return Eigen::Vector2d(2 * std::numbers::pi - p.y(), 2 * std::numbers::pi - p.x());
    };
    for (int i = 0; i < 5; ++i) at(i) = given[i];
    for (int i = 1; i < 5; ++i) at(4 + i) = across(given[4 - i]);
    for (int i = 1; i < 8; ++i) at(8 + i) = {at(8 - i).y(), at(8 - i).x()};
    solve();
  }

  // The point of piece i (from point i to i + 1) at t in [0, 1].
  [[nodiscard]] Eigen::Vector2d operator()(int i, double t) const {
    const double h = width_[index(i)], u = 1 - t;
    return u * at(i) + t * at(i + 1) -
           h * h / 6 * ((u - u * u * u) * bend_[index(i)] + (t - t * t * t) * bend_[index(i + 1)]);
  }

  // The boundary's phi2 above phi1, on the quarter.
  [[nodiscard]] double height(double phi1) const {
    int piece = 0;
    while (piece + 1 < kQuarter && at(piece + 1).x() < phi1) ++piece;
    double low = 0, high = 1;
    constexpr int kMostSecants = 60;
    double t = (phi1 - at(piece).x()) / (at(piece + 1).x() - at(piece).x());
    for (int k = 0; k < kMostSecants; ++k) {
      // Secant of a nearly straight piece, kept inside the bracket.
      const double off = (*this)(piece, t).x() - phi1;
      (off > 0 ? high : low) = t;
      double next = t - off / (at(piece + 1).x() - at(piece).x());
      if (!(next > low && next < high)) next = 0.5 * (low + high);
      constexpr double kSettled = 1e-15;
      if (std::abs(next - t) < kSettled) break;
      t = next;
    }
    return (*this)(piece, t).y();
  }

  [[nodiscard]] const Eigen::Vector2d& at(int i) const { return point_[index(i)]; }

 private:
  static std::size_t index(int i) { return static_cast<std::size_t>((i + kCount) % kCount); }
  Eigen::Vector2d& at(int i) { return point_[index(i)]; }

  // Second derivatives by chord length, continuous all around.
  void solve() {
    Eigen::Matrix<double, kCount, kCount> m = Eigen::Matrix<double, kCount, kCount>::Zero();
    Eigen::Matrix<double, kCount, 2> r;
    for (int i = 0; i < kCount; ++i) width_[index(i)] = (at(i + 1) - at(i)).norm();
    for (int i = 0; i < kCount; ++i) {
      const double before = width_[index(i - 1)], after = width_[index(i)];
      m(i, static_cast<int>(index(i - 1))) += before;
      m(i, i) += 2 * (before + after);
      m(i, static_cast<int>(index(i + 1))) += after;
      r.row(i) = 6 * ((at(i + 1) - at(i)) / after - (at(i) - at(i - 1)) / before);
    }
    const Eigen::Matrix<double, kCount, 2> x = m.partialPivLu().solve(r);
    for (int i = 0; i < kCount; ++i) bend_[index(i)] = x.row(i);
  }

  std::array<Eigen::Vector2d, kCount> point_, bend_;
  std::array<double, kCount> width_{};
};

const Boundary& boundary() {
  static const Boundary instance;
  return instance;
}

double positive(double angle) {
  return angle < 0 ? angle + 2 * std::numbers::pi : angle;
}

StandardPosition moved(const StandardPosition& s, double l1, double l2) {
  return {s.a1, s.a2, l1, l2};
}

// Within both edge-length constraints, each edge changed as little as the other allows.
StandardPosition within_limits(const StandardPosition& s) {
  const EdgeLimits limits = edge_limits(s.a1, s.a2);
  StandardPosition r = moved(s, std::clamp(s.l1, limits.shortest, limits.longest),
                             std::clamp(s.l2, limits.shortest, limits.longest));
  if (inflectional(r)) {
    r.l1 = std::min(r.l1, kMostUneven * r.l2);
    r.l2 = std::min(r.l2, kMostUneven * r.l1);
  }
  return r;
}

struct Walk {
  StandardPosition s;
  bool inside = false;  // the boundary
};

// Along the straight line of edge lengths to (l1, l2), up to the zone; with `inflectional_only` also no
// further than the first plain curve.
Walk walk(const StandardPosition& from, double l1, double l2, bool inflectional_only) {
  const auto at = [&](double t) {
    return moved(from, (1 - t) * from.l1 + t * l1, (1 - t) * from.l2 + t * l2);
  };
  const auto arrived = [&](double t) {
    const StandardPosition s = at(t);
    return inside_zone_boundary(polygon_angles(s)) || (inflectional_only && !inflectional(s));
  };
  for (int i = 0; i <= kZoneSteps; ++i) {
    double inside = static_cast<double>(i) / kZoneSteps;
    if (!arrived(inside)) continue;
    double outside = std::max(0.0, static_cast<double>(i - 1) / kZoneSteps);
    for (int k = 0; k < kHalvings && i > 0; ++k) {
      const double middle = 0.5 * (inside + outside);
      (arrived(middle) ? inside : outside) = middle;
    }
    return {at(inside), inside_zone_boundary(polygon_angles(at(inside)))};
  }
  return {at(1), false};
}

StandardPosition into_zone(const StandardPosition& input) {
  StandardPosition s = within_limits(uncrossed(input));
  const EdgeLimits limits = edge_limits(s.a1, s.a2);
  if (inflectional(s)) {
    const Walk w = walk(s, limits.shortest, limits.shortest, true);
    if (w.inside) return w.s;
    s = w.s;
  }
  const PolygonAngles a = polygon_angles(s);
  // The vertex with the larger angle, seen from the side the polygon bulges to, moves away from its end.
  const bool second_larger = a.phi1 + a.phi2 <= 2 * std::numbers::pi ? a.phi1 < a.phi2 : a.phi1 > a.phi2;
  return second_larger ? walk(s, limits.shortest, limits.longest, false).s
                       : walk(s, limits.longest, limits.shortest, false).s;
}

}  // namespace

PolygonAngles polygon_angles(const StandardPosition& s) {
  using Complex = std::complex<double>;
  const Complex p1 = std::polar(s.l1, s.a1), p2 = 1.0 + std::polar(s.l2, s.a2);
  return {positive(std::arg((p2 - p1) * std::conj(-p1))),
          positive(std::arg((1.0 - p2) * std::conj(p1 - p2)))};
}

EdgeLimits edge_limits(double a1, double a2) {
  const double d = (a2 < 0 ? -1.0 : 1.0) * (a1 - a2) / std::numbers::pi;
  return {std::max(0.4 * (1 + 6 * d), 0.27), std::max(1.2 * (1 + 5 * d), 0.58)};
}

bool edge_lengths_hold(const StandardPosition& s) {
  const EdgeLimits limits = edge_limits(s.a1, s.a2);
  if (std::min(s.l1, s.l2) < limits.shortest || std::max(s.l1, s.l2) > limits.longest) return false;
  return !inflectional(s) || std::max(s.l1, s.l2) <= kMostUneven * std::min(s.l1, s.l2);
}

bool inside_zone_boundary(const PolygonAngles& angles) {
  double x = std::max(angles.phi1, angles.phi2), y = std::min(angles.phi1, angles.phi2);
  if (x + y > 2 * std::numbers::pi) {
    const double mirrored = 2 * std::numbers::pi - y;
    y = 2 * std::numbers::pi - x;
    x = mirrored;
  }
  const Boundary& edge = boundary();
  return x >= edge.at(0).x() && x <= edge.at(Boundary::kQuarter).x() && y >= edge.height(x);
}

bool in_projection_zone(const StandardPosition& s) {
  return angle_constraints_hold(s) && edge_lengths_hold(s) && !edges_cross(s) &&
         inside_zone_boundary(polygon_angles(s));
}

std::vector<PolygonAngles> zone_boundary(int n) {
  std::vector<PolygonAngles> list;
  for (int k = 0; k <= Boundary::kCount * n; ++k) {
    const Eigen::Vector2d p = boundary()(k / n, static_cast<double>(k % n) / n);
    list.push_back({p.x(), p.y()});
  }
  return list;
}

Projection project_zone(const Bezier& b, double threshold) {
  const auto input = standard_position(b);
  if (!input) {
    Projection unsupported;
    unsupported.bezier = b;
    unsupported.status = ProjectStatus::kUnsupported;
    return unsupported;
  }
  return projection(b, *input, in_projection_zone(*input) ? *input : into_zone(*input), threshold);
}

}  // namespace hotblade::elastica

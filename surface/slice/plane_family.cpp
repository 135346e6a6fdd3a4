#include "surface/slice/plane_family.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "surface/read/place_text.hpp"

namespace hotblade::surface {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kTurn = 2 * std::numbers::pi;
// Closer to the axis neighbouring planes are one: far less than any blade is wide.
constexpr double kLeastRadiusMm = 1;
// A design's angle ends at a gap at least this wide, far above the rounding of angles.
constexpr double kLeastGapRad = 1e-3;

double cross(const Vector2d& a, const Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

double distance_to_segment(const Vector2d& a, const Vector2d& b) {
  const Vector2d along = b - a;
  const double size = along.squaredNorm();
  const double t = size > 0 ? std::clamp(-a.dot(along) / size, 0.0, 1.0) : 0;
  return (a + t * along).norm();
}

// Distance of the origin from a triangle, seen along the axis.
double distance_from_origin(const std::array<Vector2d, 3>& q) {
  const double ab = cross(q[0], q[1]), bc = cross(q[1], q[2]), ca = cross(q[2], q[0]);
  if ((ab > 0 && bc > 0 && ca > 0) || (ab < 0 && bc < 0 && ca < 0)) return 0;
  return std::min(
      {distance_to_segment(q[0], q[1]), distance_to_segment(q[1], q[2]), distance_to_segment(q[2], q[0])});
}

struct Arc {
  double start = 0, extent = 0;  // rad; start in [-pi, pi]
};

// The angle a triangle takes up, less than half a turn: from behind the largest gap between its corners on.
Arc arc_of(const std::array<Vector2d, 3>& q) {
  std::array<double, 3> angles{};
  for (std::size_t i = 0; i < 3; ++i) angles[i] = std::atan2(q[i].y(), q[i].x());
  std::sort(angles.begin(), angles.end());
  const std::array<double, 3> gaps{angles[1] - angles[0], angles[2] - angles[1],
                                   angles[0] + kTurn - angles[2]};
  const auto largest = static_cast<std::size_t>(std::max_element(gaps.begin(), gaps.end()) - gaps.begin());
  return {angles[(largest + 1) % 3], kTurn - gaps[largest]};
}

// Middle of what the arcs cover, and how much they leave open: beside the largest gap between them.
struct Cover {
  double middle = 0, gap = 0;
};

Cover cover(std::vector<Arc> arcs) {
  std::sort(arcs.begin(), arcs.end(), [](const Arc& a, const Arc& b) { return a.start < b.start; });
  Cover best;
  double reached = arcs.front().start;
  const auto offer = [&](double next) {
    if (next - reached <= best.gap) return;
    best.gap = next - reached;
    best.middle = std::remainder(0.5 * (reached + next) + std::numbers::pi, kTurn);
  };
  for (const Arc& arc : arcs) {
    offer(arc.start);
    reached = std::max(reached, arc.start + arc.extent);
  }
  offer(arcs.front().start + kTurn);
  return best;
}

// What points about the axis cover that lie to one side of it: all between the outermost two.
class OneSided {
 public:
  explicit OneSided(const Vector2d& middle) : middle_(middle) {}

  void add(const Vector2d& q) {
    const double towards = middle_.dot(q), tangent = cross(middle_, q) / towards;
    holds_ = holds_ && towards > 0 && std::isfinite(tangent);
    low_ = std::min(low_, tangent);
    high_ = std::max(high_, tangent);
  }

  // None where a point lies on the other side.
  [[nodiscard]] std::optional<Cover> cover() const {
    if (!holds_ || !(low_ <= high_)) return std::nullopt;
    const double from = std::atan(low_), to = std::atan(high_), at = std::atan2(middle_.y(), middle_.x());
    return Cover{std::remainder(at + 0.5 * (from + to), kTurn), kTurn - (to - from)};
  }

 private:
  Vector2d middle_;
  bool holds_ = true;
  double low_ = std::numeric_limits<double>::infinity(), high_ = -low_;  // tangents of angles from the middle
};

}  // namespace

PlaneFamily PlaneFamily::parallel(const Vector3d& normal, const Vector3d& centre) {
  PlaneFamily family;
  family.normal_ = normal;
  family.centre_ = centre;
  return family;
}

PlaneFamily PlaneFamily::fan(const FanAxis& axis, const Vector3d& reference, double radius_mm) {
  const bool finite = axis.point.allFinite() && axis.direction.allFinite() && reference.allFinite();
  if (!finite || !(axis.direction.norm() > 0) || !std::isfinite(radius_mm) || radius_mm <= 0) {
    throw std::logic_error("a fan needs a finite axis that is not zero and a radius greater than 0");
  }
  PlaneFamily family;
  family.centre_ = axis.point;
  family.axis_ = axis.direction.normalized();
  family.reference_ = reference - reference.dot(family.axis_) * family.axis_;
  constexpr double kAlong = 1e-9;  // of the reference: what is left square to the axis is rounding
  if (!(family.reference_.norm() > kAlong * reference.norm())) {
    throw std::logic_error("a fan's reference must not lie along its axis");
  }
  family.reference_.normalize();
  family.normal_ = family.axis_.cross(family.reference_);
  family.radius_mm_ = radius_mm;
  return family;
}

double PlaneFamily::offset(const Vector3d& p) const {
  if (!turns()) return normal_.dot(p - centre_);
  const Vector3d d = p - centre_;
  return radius_mm_ * std::atan2(normal_.dot(d), reference_.dot(d));
}

double PlaneFamily::distance_from_axis(const Vector3d& p) const {
  const Vector3d d = p - centre_;
  return std::hypot(normal_.dot(d), reference_.dot(d));
}

double PlaneFamily::angle(double offset_mm) const {
  return turns() ? offset_mm / radius_mm_ : 0;
}

Vector3d PlaneFamily::turned(const Vector3d& at_zero, double offset_mm) const {
  if (!turns()) return at_zero;
  const double phi = angle(offset_mm);
  return turned_by(at_zero, std::cos(phi), std::sin(phi));
}

Vector3d PlaneFamily::turned_to(const Vector3d& at_zero, const Vector3d& p) const {
  if (!turns()) return at_zero;
  const Vector3d d = p - centre_;
  const double c = reference_.dot(d), s = normal_.dot(d), r = std::sqrt(c * c + s * s);
  // On the axis itself as at offset 0, as atan2 has it.
  return r > 0 ? turned_by(at_zero, c / r, s / r) : at_zero;
}

Vector3d PlaneFamily::turned_by(const Vector3d& at_zero, double c, double s) const {
  return c * at_zero + s * axis_.cross(at_zero) + (1 - c) * axis_.dot(at_zero) * axis_;
}

double PlaneFamily::crossing(const Vector3d& a, double offset_a, const Vector3d& b, double offset_b,
                             double offset_mm) const {
  if (!turns()) return (offset_mm - offset_a) / (offset_b - offset_a);
  const Vector3d n = normal(offset_mm);
  const double low = n.dot(a - centre_), high = n.dot(b - centre_);
  // Angles and distances round differently: a corner on the plane may come to lie on its other side.
  return high == low ? 0 : std::clamp(-low / (high - low), 0.0, 1.0);
}

std::string PlaneFamily::describe(double offset_mm) const {
  std::array<char, 64> text{};
  if (turns()) {
    std::snprintf(text.data(), text.size(), "%.3f degrees about the axis",
                  angle(offset_mm) * 180 / std::numbers::pi);
  } else {
    std::snprintf(text.data(), text.size(), "normal . p = %.3f mm", normal_.dot(centre_) + offset_mm);
  }
  return text.data();
}

PlaneFamily parallel_about(const TriangleMesh& mesh, const Vector3d& normal) {
  if (mesh.vertices().empty()) throw std::logic_error("parallel_about: the design has no vertices");
  return PlaneFamily::parallel(normal.normalized(), area_centre(mesh));
}

PlaneFamily fan_about(const TriangleMesh& mesh, const FanAxis& axis) {
  if (mesh.triangles().empty()) throw std::logic_error("fan_about: the design has no faces");
  const PlaneFamily any = PlaneFamily::fan(axis, axis.direction.unitOrthogonal(), 1);
  const Vector3d x = axis.direction.unitOrthogonal(), y = any.normal(0);
  const auto along_axis = [&](const Vector3d& p) {
    return Vector2d(x.dot(p - axis.point), y.dot(p - axis.point));
  };
  const auto corners_of = [&](const std::array<int, 3>& t) {
    std::array<Vector2d, 3> q;
    for (std::size_t i = 0; i < 3; ++i) q[i] = along_axis(mesh.vertices()[static_cast<std::size_t>(t[i])]);
    return q;
  };
  Vector3d middle_of_all = Vector3d::Zero();
  for (const Vector3d& p : mesh.vertices()) middle_of_all += p;
  OneSided one_sided(along_axis(middle_of_all / static_cast<double>(mesh.vertices().size())));
  double outermost = 0;
  Vector2d farthest = Vector2d::Zero();
  for (const auto& t : mesh.triangles()) {
    const std::array<Vector2d, 3> q = corners_of(t);
    for (const Vector2d& corner : q) {
      one_sided.add(corner);
      // As far vertices, as on a circle: only a clearly farther one counts, so that rounding does not decide.
      constexpr double kClearly = 1 + 1e-9;
      if (corner.norm() > kClearly * farthest.norm()) farthest = corner;
      outermost = std::max(outermost, corner.norm());
    }
    const double distance = distance_from_origin(q);
    if (!(distance >= kLeastRadiusMm)) {
      std::array<char, 128> amount{};
      std::snprintf(amount.data(), amount.size(),
                    ": distance from the fan's axis (%.3f mm, at least %.0f mm)", distance, kLeastRadiusMm);
      throw FanError("face at " + place_text(mesh.vertices()[static_cast<std::size_t>(t[0])]) +
                     amount.data() + ": no planes that turn about slice.fan_axis cut there");
    }
  }
  const auto by_arcs = [&] {
    std::vector<Arc> arcs;
    for (const auto& t : mesh.triangles()) arcs.push_back(arc_of(corners_of(t)));
    return cover(std::move(arcs));
  };
  const std::optional<Cover> between = one_sided.cover();
  const Cover covered = between ? *between : by_arcs();
  const bool closed = covered.gap < kLeastGapRad;
  const Vector3d middle = std::cos(covered.middle) * x + std::sin(covered.middle) * y;
  const Vector3d towards = farthest.x() * x + farthest.y() * y;
  PlaneFamily fan = PlaneFamily::fan(axis, closed ? towards : middle, outermost);
  fan.closed_ = closed;
  return fan;
}

}  // namespace hotblade::surface

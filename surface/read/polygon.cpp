#include "surface/read/polygon.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "surface/read/needles.hpp"

namespace hotblade::surface {
namespace {

using Point2 = CGAL::Exact_predicates_inexact_constructions_kernel::Point_2;

// The polygon's vector area, twice: sums over the corners, so it is right for concave outlines too (Newell).
Eigen::Vector3d newell(std::span<const Eigen::Vector3d> points, std::span<const int> corners) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const Eigen::Vector3d& origin = points[static_cast<std::size_t>(corners[0])];
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector3d a = points[static_cast<std::size_t>(corners[i])] - origin;
    const Eigen::Vector3d b = points[static_cast<std::size_t>(corners[(i + 1) % corners.size()])] - origin;
    sum += a.cross(b);
  }
  return sum;
}

// The outline seen along the largest axis of its normal, counter-clockwise.
std::vector<Point2> flatten(std::span<const Eigen::Vector3d> points, std::span<const int> corners) {
  const Eigen::Vector3d normal = newell(points, corners);
  Eigen::Index drop = 0;
  normal.cwiseAbs().maxCoeff(&drop);
  Eigen::Index u = (drop + 1) % 3, v = (drop + 2) % 3;
  if (normal[drop] < 0) std::swap(u, v);
  std::vector<Point2> flat;
  flat.reserve(corners.size());
  for (const int c : corners) {
    const Eigen::Vector3d& p = points[static_cast<std::size_t>(c)];
    flat.emplace_back(p[u], p[v]);
  }
  return flat;
}

bool turns_left(const Point2& a, const Point2& b, const Point2& c) {
  return CGAL::orientation(a, b, c) == CGAL::LEFT_TURN;
}

// Inside or on the rim, but not at a corner: outlines bridged to a hole pass twice through the same point.
bool covers(const Point2& a, const Point2& b, const Point2& c, const Point2& p) {
  if (p == a || p == b || p == c) return false;
  return !turns_left(b, a, p) && !turns_left(c, b, p) && !turns_left(a, c, p);
}

// Corners still to be cut off, as positions in the polygon.
class Outline {
 public:
  explicit Outline(std::vector<Point2> flat) : flat_(std::move(flat)), left_(flat_.size()) {
    for (std::size_t i = 0; i < left_.size(); ++i) left_[i] = i;
  }
  [[nodiscard]] std::size_t size() const { return left_.size(); }
  [[nodiscard]] std::array<std::size_t, 3> corner(std::size_t k) const {
    const std::size_t n = left_.size();
    return {left_[(k + n - 1) % n], left_[k], left_[(k + 1) % n]};
  }
  [[nodiscard]] bool turns_right(std::size_t k) const {
    const auto [i, j, l] = corner(k);
    return turns_left(flat_[l], flat_[j], flat_[i]);
  }
  // A thin ear is one whose corners lie on a line but for rounding: cut only when there is no other, because
  // it would leave a vertex on the edge of another triangle.
  [[nodiscard]] bool is_ear(std::size_t k, bool thin_too) const {
    const auto [i, j, l] = corner(k);
    if (!turns_left(flat_[i], flat_[j], flat_[l]) || (!thin_too && is_thin(i, j, l))) return false;
    for (const std::size_t m : left_) {
      if (m != i && m != j && m != l && covers(flat_[i], flat_[j], flat_[l], flat_[m])) return false;
    }
    return true;
  }
  void cut(std::size_t k) { left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(k)); }

 private:
  [[nodiscard]] bool is_thin(std::size_t i, std::size_t j, std::size_t l) const {
    constexpr double kThin =
        1e-9;  // of the squared longest side: well over rounding, far under any drawn corner
    const auto a = flat_[j] - flat_[i], b = flat_[l] - flat_[j];
    const double longest = std::max({a.squared_length(), b.squared_length(), (a + b).squared_length()});
    return CGAL::determinant(a, b) <= kThin * longest;
  }

  std::vector<Point2> flat_;
  std::vector<std::size_t> left_;
};

bool on_a_line(std::span<const Eigen::Vector3d> points, std::span<const int> corners) {
  for (std::size_t i = 2; i < corners.size(); ++i) {
    if (has_area(points, {corners[0], corners[i - 1], corners[i]})) return false;
  }
  return true;
}

bool cut_quad(std::span<const Eigen::Vector3d> points, std::span<const int> c,
              std::vector<std::array<int, 3>>& triangles) {
  const std::vector<Point2> q = flatten(points, c);
  const bool inside02 = turns_left(q[0], q[1], q[2]) && turns_left(q[0], q[2], q[3]);
  const bool inside13 = turns_left(q[1], q[2], q[3]) && turns_left(q[1], q[3], q[0]);
  const auto at = [&](std::size_t i) -> const Eigen::Vector3d& {
    return points[static_cast<std::size_t>(c[i])];
  };
  const bool shorter02 = (at(2) - at(0)).squaredNorm() <= (at(3) - at(1)).squaredNorm();
  if (inside02 && (shorter02 || !inside13)) {
    triangles.insert(triangles.end(), {{c[0], c[1], c[2]}, {c[0], c[2], c[3]}});
    return true;
  }
  if (!inside13) return false;
  triangles.insert(triangles.end(), {{c[1], c[2], c[3]}, {c[1], c[3], c[0]}});
  return true;
}

}  // namespace

bool triangulate_polygon(std::span<const Eigen::Vector3d> points, std::span<const int> corners,
                         std::vector<std::array<int, 3>>& triangles) {
  if (corners.size() == 3) {
    triangles.push_back({corners[0], corners[1], corners[2]});
    return true;
  }
  if (corners.size() == 4 && cut_quad(points, corners, triangles)) return true;
  if (on_a_line(points, corners)) {
    for (std::size_t i = 2; i < corners.size(); ++i)
      triangles.push_back({corners[0], corners[i - 1], corners[i]});
    return true;
  }
  Outline outline(flatten(points, corners));
  const auto emit = [&](std::size_t k) {
    const auto [i, j, l] = outline.corner(k);
    triangles.push_back({corners[i], corners[j], corners[l]});
    outline.cut(k);
  };
  bool simple = true;
  // Going on from the last ear, instead of from the start, spreads the cuts and avoids a fan of slivers.
  // After one round without an ear thin ones are taken, after two anything.
  for (std::size_t k = 0, missed = 0; outline.size() > 3;) {
    k %= outline.size();
    if (missed > 2 * outline.size()) simple = false;
    if (!simple || outline.is_ear(k, missed > outline.size())) {
      emit(k);
      missed = 0;
    } else {
      ++missed;
    }
    ++k;
  }
  simple = simple && !outline.turns_right(1);
  emit(1);
  return simple;
}

}  // namespace hotblade::surface

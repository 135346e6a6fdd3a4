#include "pipeline/plan/direction/least_bent.hpp"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "gpu/backend/stop.hpp"

namespace hotblade::pipeline {

namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Calls f(centre, doubled area normal) for every triangle.
template <class F>
void for_each_facet(const surface::TriangleMesh& mesh, const F& f) {
  for (const auto& t : mesh.triangles()) {
    const auto at = [&](std::size_t i) -> const Vector3d& {
      return mesh.vertices()[static_cast<std::size_t>(t[i])];
    };
    f((at(0) + at(1) + at(2)) / 3, (at(1) - at(0)).cross(at(2) - at(0)));
  }
}

// An angle and the area that has it.
using Weighed = std::pair<double, double>;

// The angle below which this share of the area lies, between the middles of what two angles weigh: rounding
// moves it by as little.
double quantile(const std::vector<Weighed>& sorted, double total, double share) {
  double before = 0, last = sorted.front().first, last_middle = 0;
  for (const auto& [angle, area] : sorted) {
    const double middle = before + 0.5 * area;
    if (middle >= share * total) {
      const double part = middle > last_middle ? (share * total - last_middle) / (middle - last_middle) : 1;
      return last + part * (angle - last);
    }
    last = angle;
    last_middle = middle;
    before += area;
  }
  return last;
}

}  // namespace

Vector3d NormalsTurn::planes_normal() const {
  return along.cross(middle);
}

double NormalsTurn::steepest_rad(const Vector3d& planes_normal) const {
  const double up = std::cos(half_rad) * planes_normal.dot(middle),
               side = std::sin(half_rad) * planes_normal.dot(along.cross(middle));
  return std::asin(std::min(1.0, std::abs(up) + std::abs(side)));
}

std::optional<NormalsTurn> normals_turn(const surface::TriangleMesh& mesh, const Vector3d& along) {
  constexpr double kTail = 0.01;      // of the area, at either end
  constexpr double kLeastMean = 0.1;  // of the area: less is no side that the surface shows
  Vector3d sum = Vector3d::Zero();
  double area = 0;
  for_each_facet(mesh, [&](const Vector3d&, const Vector3d& normal) {
    sum += normal;
    area += normal.norm();
  });
  const Vector3d mean = sum - sum.dot(along) * along;
  if (!(mean.norm() > kLeastMean * area)) return std::nullopt;
  const Vector3d up = mean.normalized(), across = along.cross(up);
  std::vector<Weighed> angles;
  angles.reserve(mesh.triangles().size());
  double total = 0;
  for_each_facet(mesh, [&](const Vector3d&, const Vector3d& normal) {
    const double y = normal.dot(across), x = normal.dot(up), weight = std::hypot(x, y);
    if (!(weight > 0)) return;
    angles.emplace_back(std::atan2(y, x), weight);
    total += weight;
  });
  gpu::stop_point();
  std::sort(angles.begin(), angles.end());
  const double low = quantile(angles, total, kTail), high = quantile(angles, total, 1 - kTail),
               middle = 0.5 * (low + high);
  return NormalsTurn{along, (std::cos(middle) * up + std::sin(middle) * across).normalized(),
                     0.5 * (high - low)};
}

std::optional<surface::FanAxis> axis_less_steep_than(const surface::TriangleMesh& mesh,
                                                     const NormalsTurn& turn, double steepest_rad) {
  const double share = 1 - steepest_rad / turn.half_rad;  // of the normals' turn that the planes make
  const Vector3d centre = surface::area_centre(mesh), across = turn.along.cross(turn.middle);
  // The place that the lines through the facets, as the planes stand there, miss the least.
  Matrix2d matrix = Matrix2d::Zero();
  Vector2d right = Vector2d::Zero();
  for_each_facet(mesh, [&](const Vector3d& p, const Vector3d& normal) {
    const double y = normal.dot(across), x = normal.dot(turn.middle), turned = share * std::atan2(y, x);
    const Vector2d to_line(std::cos(turned), -std::sin(turned)),
        q((p - centre).dot(across), (p - centre).dot(turn.middle));
    const double weight = std::hypot(x, y);
    matrix += weight * to_line * to_line.transpose();
    right += weight * to_line.dot(q) * to_line;
  });
  constexpr double kLeastTurn = 1e-3;  // mean square in rad^2, by which the lines turn
  const double det = matrix.determinant(), trace = matrix.trace();
  if (!(det > kLeastTurn * trace * trace)) return std::nullopt;
  const Vector2d a = matrix.inverse() * right;
  return surface::FanAxis{centre + a.x() * across + a.y() * turn.middle, turn.along};
}

}  // namespace hotblade::pipeline

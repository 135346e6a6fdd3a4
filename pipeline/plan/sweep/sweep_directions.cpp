#include "pipeline/plan/sweep/sweep_directions.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "gpu/backend/stop.hpp"
#include "pipeline/plan/direction/fan_axes.hpp"
#include "pipeline/plan/direction/least_bent.hpp"
#include "pipeline/plan/ribs/rib_fit.hpp"

namespace hotblade::pipeline {

using Eigen::Vector3d;

double waste_side(const surface::TriangleMesh& mesh, Keep keep) {
  if (keep == Keep::kBack) return 1;
  if (keep == Keep::kFront) return -1;
  double up = 0, area = 0;
  for (const auto& t : mesh.triangles()) {
    const auto at = [&](std::size_t i) -> const Vector3d& {
      return mesh.vertices()[static_cast<std::size_t>(t[i])];
    };
    const Vector3d normal = (at(1) - at(0)).cross(at(2) - at(0));
    up += normal.z();
    area += normal.norm();
  }
  if (!(std::abs(up) >= kLeastLean * area)) return 0;
  return (keep == Keep::kBelow) == (up > 0) ? 1 : -1;
}

std::vector<double> too_steep_shares(const WasteSurface& surface, const std::vector<SweepSeam>& seams,
                                     std::span<const surface::PlaneFamily> planes) {
  std::vector<double> steep(planes.size(), 0);
  double all = 0;
  const double most = std::sin(kMaxSlopeRad);
  for (const auto& t : surface.triangles) {
    gpu::stop_point();
    const auto at = [&](std::size_t i) -> const Vector3d& {
      return surface.points[static_cast<std::size_t>(t[i])];
    };
    int behind = 0;
    for (const Vector3d& p : {at(0), at(1), at(2), Vector3d((at(0) + at(1) + at(2)) / 3)})
      behind += lies_behind(seams, p) ? 1 : 0;
    if (behind == 0) continue;
    const Vector3d normal = (at(1) - at(0)).cross(at(2) - at(0));
    const double area = normal.norm(), counts = 0.25 * behind * area;
    all += counts;
    for (std::size_t i = 0; i < planes.size(); ++i) {
      const double along = normal.dot(planes[i].normal_at(at(0)));
      if (std::abs(along) > most * area) steep[i] += counts;
    }
  }
  for (double& share : steep) share = all > 0 ? share / all : 1;
  return steep;
}

namespace {

// The fan about an axis, where its planes turn by more than parallel ones could be tilted for.
std::optional<surface::PlaneFamily> fan_that_turns(const surface::TriangleMesh& mesh,
                                                   const surface::FanAxis& axis) {
  constexpr double kLeastTurnRad = 0.1;
  try {
    surface::PlaneFamily planes = surface::fan_about(mesh, axis);
    double low = 0, high = 0;
    for (const Vector3d& p : mesh.vertices()) {
      const double angle = planes.angle(planes.offset(p));
      low = std::min(low, angle);
      high = std::max(high, angle);
      if (high - low >= kLeastTurnRad) return planes;
    }
    return std::nullopt;
  } catch (const surface::FanError&) {
    return std::nullopt;  // it runs through the design
  }
}

}  // namespace

std::vector<surface::PlaneFamily> sweep_planes(const surface::TriangleMesh& mesh,
                                               const SliceSettings& settings) {
  if (settings.direction) {
    const auto& d = *settings.direction;
    return {surface::parallel_about(mesh, Vector3d(d[0], d[1], d[2]).normalized())};
  }
  if (settings.fan_axis) {
    const auto& a = *settings.fan_axis;
    return {surface::fan_about(mesh, {{a[0], a[1], a[2]}, {a[3], a[4], a[5]}})};
  }
  const BodyAxes body = body_axes(mesh);
  std::vector<Vector3d> all = along_borders(mesh, body);
  const std::optional<Vector3d> flattest = least_steep(mesh);
  const std::optional<NormalsTurn> turn = flattest ? normals_turn(mesh, *flattest) : std::nullopt;
  if (flattest) all.push_back(*flattest);
  for (const Vector3d& n : hemisphere(body)) all.push_back(n);
  std::vector<Vector3d> apart;
  constexpr double kSame = 0.9986;  // within 3 degrees
  for (const Vector3d& n : all) {
    const bool known = std::any_of(apart.begin(), apart.end(),
                                   [&](const Vector3d& m) { return std::abs(m.dot(n)) > kSame; });
    if (!known) apart.push_back(n);
  }
  if (turn && turn->half_rad <= kMaxSlopeRad) {
    // Beside them others may be too steep within those degrees.
    const Vector3d n = turn->planes_normal();
    const bool known = std::any_of(apart.begin(), apart.end(), [&](const Vector3d& m) {
      return std::abs(m.dot(n)) > kSame && turn->steepest_rad(m) <= kMaxSlopeRad;
    });
    if (!known) apart.push_back(n);
  }
  std::vector<surface::PlaneFamily> planes;
  for (const Vector3d& n : with_senses(mesh, body, apart))
    planes.push_back(surface::PlaneFamily::parallel(n.normalized(), body.centre));
  for (const surface::FanAxis& axis : fan_axes(mesh, body, long_sides(mesh))) {
    if (const auto fan = fan_that_turns(mesh, axis)) planes.push_back(*fan);
  }
  if (turn && turn->half_rad > kMaxSlopeRad) {
    // As little as they turn, blades hang the least; ten degrees are for what lies off the fan's one axis. Of
    // 14 rounds of changing radius all are cut with ten, 13 with five.
    constexpr double kSteepestRad = 5 * kMaxSlopeRad / 6;
    if (auto axis = axis_less_steep_than(mesh, *turn, kSteepestRad)) {
      axis->direction = with_sense(mesh, body, axis->direction);
      if (const auto fan = fan_that_turns(mesh, *axis)) planes.push_back(*fan);
    }
  }
  return planes;
}

}  // namespace hotblade::pipeline

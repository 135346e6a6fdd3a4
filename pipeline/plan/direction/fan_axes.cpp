#include "pipeline/plan/direction/fan_axes.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

namespace hotblade::pipeline {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using surface::FanAxis;

// The quadratic form of n . (v + c x p) over the area in (c, v), p in sizes from the body's centre, and that
// of |v + c x p|.
struct LineComplex {
  Eigen::Matrix<double, 6, 6> along, whole;
  double size_mm = 0;
};

LineComplex line_complex(const surface::TriangleMesh& mesh, const BodyAxes& body) {
  struct Facet {
    double area;
    Vector3d p, n;
  };
  std::vector<Facet> facets;
  double total = 0, square = 0;
  for (const auto& t : mesh.triangles()) {
    const auto at = [&](std::size_t i) { return mesh.vertices()[static_cast<std::size_t>(t[i])]; };
    const Vector3d cross = (at(1) - at(0)).cross(at(2) - at(0));
    const double area = 0.5 * cross.norm();
    if (!(area > 0)) continue;
    facets.push_back({area, (at(0) + at(1) + at(2)) / 3 - body.centre, cross / (2 * area)});
    total += area;
    square += area * facets.back().p.squaredNorm();
  }
  LineComplex form;
  form.along.setZero();
  form.whole.setZero();
  form.size_mm = std::sqrt(square / total);
  for (const Facet& f : facets) {
    const Vector3d p = f.p / form.size_mm;
    Eigen::Matrix<double, 6, 1> row;
    row << p.cross(f.n), f.n;
    form.along += f.area / total * row * row.transpose();
    for (int i = 0; i < 3; ++i) {
      const Vector3d e = Vector3d::Unit(i);
      row << p.cross(e), e;
      form.whole += f.area / total * row * row.transpose();
    }
  }
  return form;
}

// The inverse on what the normals span; translations that leave the surface in itself cost nothing and are
// not made.
Matrix3d inverse_on_span(const Matrix3d& m) {
  constexpr double kNone = 1e-6;  // of the largest: normals within a thousandth of a plane span that plane
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(m);
  Vector3d inverse = Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    const double value = solver.eigenvalues()[i];
    if (value > kNone * solver.eigenvalues()[2]) inverse[i] = 1 / value;
  }
  return solver.eigenvectors() * inverse.asDiagonal() * solver.eigenvectors().transpose();
}

// Directions of rotation, best first. Where several are equally good, as about a sphere, any between them
// would be: then the body's own axes choose.
std::vector<Vector3d> rotations(const Matrix3d& cost, const BodyAxes& body) {
  constexpr double kEqual = 1e-4;  // rotations that move the surface by less than a hundredth are perfect
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(cost);
  const Vector3d& value = solver.eigenvalues();
  std::vector<Vector3d> all;
  const auto equal = [&](int i) { return value[i] - value[0] < kEqual; };
  if (!equal(1)) {
    for (int i = 0; i < 3; ++i) all.push_back(solver.eigenvectors().col(i));
    return all;
  }
  for (const Vector3d& axis : body.axes) {
    Vector3d within = Vector3d::Zero();
    for (int i = 0; i < 3; ++i) {
      const Vector3d v = solver.eigenvectors().col(i);
      if (equal(i)) within += v.dot(axis) * v;
    }
    constexpr double kWithin = 0.5;
    if (within.norm() > kWithin) all.push_back(within.normalized());
  }
  return all;
}

// Through the place nearest to the body's centre.
FanAxis seen_from(const BodyAxes& body, const FanAxis& axis) {
  const Vector3d d = axis.direction.normalized();
  return {axis.point + d.dot(body.centre - axis.point) * d, d};
}

void give_senses(const surface::TriangleMesh& mesh, const BodyAxes& body, std::vector<FanAxis>& axes) {
  std::vector<Vector3d> directions;
  for (const FanAxis& axis : axes) directions.push_back(axis.direction);
  directions = with_senses(mesh, body, directions);
  for (std::size_t i = 0; i < axes.size(); ++i) axes[i].direction = directions[i];
}

// The line two planes meet in; nothing for planes so nearly parallel that turning from one to the other is
// not worth while.
std::optional<FanAxis> meet(const BorderPlane& a, const BorderPlane& b) {
  constexpr double kLeastSine = 0.05;
  const Vector3d d = a.n.cross(b.n);
  if (d.norm() < kLeastSine) return std::nullopt;
  // From the middle between both planes' points, to keep digits.
  const Vector3d from = 0.5 * (a.p + b.p);
  const double ha = a.n.dot(a.p - from), hb = b.n.dot(b.p - from);
  const Vector3d to = (ha * b.n.cross(d) + hb * d.cross(a.n)) / d.squaredNorm();
  return FanAxis{from + to, d};
}

}  // namespace

std::vector<FanAxis> revolution_axes(const surface::TriangleMesh& mesh, const BodyAxes& body) {
  const LineComplex form = line_complex(mesh, body);
  const Matrix3d turning = form.along.topLeftCorner<3, 3>(), mixed = form.along.topRightCorner<3, 3>();
  const Matrix3d to_shift = -inverse_on_span(form.along.bottomRightCorner<3, 3>()) * mixed.transpose();
  const Matrix3d cost = turning + mixed * to_shift;
  std::vector<FanAxis> axes;
  for (const Vector3d& c : rotations(0.5 * (cost + cost.transpose()), body)) {
    const Vector3d point = c.cross(to_shift * c);
    Eigen::Matrix<double, 6, 1> motion;
    motion << c, point.cross(c);
    constexpr double kMost = 0.25;  // a mean slope of 14 degrees
    if (!(motion.dot(form.along * motion) <= kMost * kMost * motion.dot(form.whole * motion))) continue;
    axes.push_back(seen_from(body, {body.centre + form.size_mm * point, c}));
  }
  give_senses(mesh, body, axes);
  return axes;
}

std::vector<FanAxis> fan_axes(const surface::TriangleMesh& mesh, const BodyAxes& body,
                              const std::vector<BorderRun>& sides) {
  double size = 0;
  for (const Vector3d& p : mesh.vertices()) size = std::max(size, (p - body.centre).norm());
  std::vector<FanAxis> axes;
  const auto add = [&](const FanAxis& found) {
    constexpr double kSameRad = 0.035, kSamePlace = 0.02;
    const FanAxis axis = seen_from(body, found);
    // A single facet's normals say of no axis where it is.
    if (!axis.point.allFinite() || !axis.direction.allFinite()) return;
    const bool known = std::any_of(axes.begin(), axes.end(), [&](const FanAxis& other) {
      return axis.direction.cross(other.direction).norm() < kSameRad &&
             (axis.point - other.point).norm() < kSamePlace * size;
    });
    if (!known) axes.push_back(axis);
  };
  const auto add_meetings = [&](const std::vector<BorderPlane>& planes) {
    for (std::size_t i = 0; i < planes.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (const auto axis = meet(planes[j], planes[i])) add(*axis);
      }
    }
  };
  std::vector<BorderPlane> of_curves, all;
  for (const BorderRun& side : sides) {
    const auto plane = plane_of(side);
    if (!plane) continue;
    all.push_back(*plane);
    if (!is_straight(side)) of_curves.push_back(*plane);
  }
  add_meetings(of_curves);
  for (const BorderRun& side : sides) {
    if (const auto axis = circle_axis(side)) add(*axis);
  }
  // Planes of straight sides take their normals from facets, half a cell beside them.
  add_meetings(all);
  for (const FanAxis& axis : revolution_axes(mesh, body)) add(axis);
  give_senses(mesh, body, axes);
  return axes;
}

}  // namespace hotblade::pipeline

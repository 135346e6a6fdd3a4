#include "robot/arm/solid.hpp"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace hotblade::robot {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr int kCylinderSides = 32;
constexpr int kSphereSides = 16, kSphereRings = 8;

struct Surface {
  std::vector<Triangle> operator()(const Box& box) const {
    std::vector<Triangle> all;
    const Vector3d half = box.size_mm / 2;
    for (int axis = 0; axis < 3; ++axis) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      for (const double side : {-1.0, 1.0}) {
        const auto corner = [&](double at_u, double at_v) {
          Vector3d p;
          p[axis] = side * half[axis];
          p[u] = at_u * half[u];
          p[v] = at_v * half[v];
          return p;
        };
        // Seen from outside they turn to the left.
        all.push_back({corner(-1, -1), corner(side, -side), corner(1, 1)});
        all.push_back({corner(-1, -1), corner(1, 1), corner(-side, side)});
      }
    }
    return all;
  }

  std::vector<Triangle> operator()(const Cylinder& c) const {
    std::vector<Triangle> all;
    const double radius = c.radius_mm / std::cos(M_PI / kCylinderSides), half = c.length_mm / 2;
    const auto rim = [&](int i, double z) {
      const double angle = 2 * M_PI * i / kCylinderSides;
      return Vector3d(radius * std::cos(angle), radius * std::sin(angle), z);
    };
    for (int i = 0; i < kCylinderSides; ++i) {
      const Vector3d a = rim(i, -half), b = rim((i + 1) % kCylinderSides, -half);
      const Vector3d c1 = rim(i, half), d = rim((i + 1) % kCylinderSides, half);
      all.push_back({a, b, d});
      all.push_back({a, d, c1});
      all.push_back({Vector3d(0, 0, -half), b, a});
      all.push_back({Vector3d(0, 0, half), c1, d});
    }
    return all;
  }

  // Rings and sides, grown until no face cuts the ball.
  std::vector<Triangle> operator()(const Sphere& sphere) const {
    const auto at = [](int ring, int side) {
      const double polar = M_PI * ring / kSphereRings,
                   angle = 2 * M_PI * (side % kSphereSides) / kSphereSides;
      return Vector3d(std::sin(polar) * std::cos(angle), std::sin(polar) * std::sin(angle), std::cos(polar));
    };
    std::vector<Triangle> all;
    for (int ring = 0; ring < kSphereRings; ++ring) {
      for (int side = 0; side < kSphereSides; ++side) {
        const Vector3d a = at(ring, side), b = at(ring + 1, side), c = at(ring + 1, side + 1),
                       d = at(ring, side + 1);
        if (ring + 1 < kSphereRings) all.push_back({a, b, c});
        if (ring > 0) all.push_back({a, c, d});
      }
    }
    double least = 1;
    for (const Triangle& t : all) {
      const Vector3d normal = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
      least = std::min(least, std::abs(normal.dot(t[0])));
    }
    for (Triangle& t : all) {
      for (Vector3d& corner : t) corner *= sphere.radius_mm / least;
    }
    return all;
  }

  std::vector<Triangle> operator()(const Mesh& mesh) const { return mesh.triangles; }
};

// The solid angle that a triangle fills, seen from the origin (van Oosterom, Strackee 1983), half of it.
double half_solid_angle(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

using DistanceTree = fcl::BVHModel<fcl::RSSd>;

}  // namespace

std::vector<Triangle> triangles_of(const Shape& shape) {
  std::vector<Triangle> all = std::visit(Surface{}, shape.solid);
  for (Triangle& triangle : all) {
    for (Vector3d& corner : triangle) corner = shape.place * corner;
  }
  return all;
}

struct Solid::Data {
  std::vector<Triangle> triangles;
  std::vector<std::size_t> first;  // triangle of each part
  bool closed = true;
  Vector3d centre{0, 0, 0};
  double radius_mm = 0;
  DistanceTree tree;

  void finish() {
    if (triangles.empty()) throw std::logic_error("Solid: no triangle");
    Eigen::AlignedBox3d box;
    for (const Triangle& t : triangles) {
      for (const Vector3d& corner : t) box.extend(corner);
    }
    centre = box.center();
    tree.beginModel(static_cast<int>(triangles.size()), static_cast<int>(3 * triangles.size()));
    for (const Triangle& t : triangles) {
      for (const Vector3d& corner : t) radius_mm = std::max(radius_mm, (corner - centre).norm());
      tree.addTriangle(t[0], t[1], t[2]);
    }
    tree.endModel();
  }
};

Solid::Solid(const std::vector<Shape>& shapes) {
  auto data = std::make_shared<Data>();
  for (const Shape& shape : shapes) {
    data->first.push_back(data->triangles.size());
    const std::vector<Triangle> part = triangles_of(shape);
    data->triangles.insert(data->triangles.end(), part.begin(), part.end());
  }
  data->finish();
  data_ = std::move(data);
}

Solid::Solid(std::vector<Triangle> sheet) {
  auto data = std::make_shared<Data>();
  data->triangles = std::move(sheet);
  data->first = {0};
  data->closed = false;
  data->finish();
  data_ = std::move(data);
}

const Vector3d& Solid::centre() const {
  return data_->centre;
}
double Solid::radius_mm() const {
  return data_->radius_mm;
}
const std::vector<Triangle>& Solid::triangles() const {
  return data_->triangles;
}

bool Solid::holds(const Vector3d& point) const {
  if (!data_->closed) return false;
  for (std::size_t part = 0; part < data_->first.size(); ++part) {
    const std::size_t end = part + 1 < data_->first.size() ? data_->first[part + 1] : data_->triangles.size();
    double turns = 0;
    for (std::size_t i = data_->first[part]; i < end; ++i) {
      const Triangle& t = data_->triangles[i];
      turns += half_solid_angle(t[0] - point, t[1] - point, t[2] - point) / (2 * M_PI);
    }
    if (std::abs(turns) > 0.5) return true;
  }
  return false;
}

std::vector<Vector3d> Solid::corners() const {
  std::vector<Vector3d> all;
  for (const std::size_t first : data_->first) all.push_back(data_->triangles[first][0]);
  return all;
}

double distance_mm(const Solid& a, const Isometry3d& at_a, const Solid& b, const Isometry3d& at_b,
                   double capped_mm) {
  const double apart = (at_a * a.centre() - at_b * b.centre()).norm() - a.radius_mm() - b.radius_mm();
  if (apart >= capped_mm) return apart;
  const fcl::DistanceRequestd request;
  fcl::DistanceResultd result;
  // The search leaves out what is farther than the least that it knows.
  result.min_distance = capped_mm;
  fcl::distance(&a.data_->tree, at_a, &b.data_->tree, at_b, request, result);
  return std::clamp(result.min_distance, 0.0, capped_mm);
}

bool one_inside_other(const Solid& a, const Isometry3d& at_a, const Solid& b, const Isometry3d& at_b) {
  const Isometry3d a_to_b = at_b.inverse() * at_a, b_to_a = a_to_b.inverse();
  for (const Vector3d& corner : a.corners()) {
    if (b.holds(a_to_b * corner)) return true;
  }
  for (const Vector3d& corner : b.corners()) {
    if (a.holds(b_to_a * corner)) return true;
  }
  return false;
}

}  // namespace hotblade::robot

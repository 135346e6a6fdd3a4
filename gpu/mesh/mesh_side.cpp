#include "gpu/mesh/mesh_side.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <tuple>

#include "gpu/backend/stop.hpp"

namespace hotblade::gpu {
namespace {

using Eigen::Vector3d;
using Triangle = std::array<int, 3>;

// Triangles one thread takes at a time.
constexpr std::size_t kGrain = 4096;

// For every vertex the lowest one at the same place.
std::vector<int> welded(const std::vector<Vector3d>& vertices) {
  std::vector<int> order(vertices.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int i) {
    const Vector3d& v = vertices[static_cast<std::size_t>(i)];
    return std::tuple(v.x(), v.y(), v.z(), i);
  };
  tbb::parallel_sort(order.begin(), order.end(), [&](int a, int b) { return key(a) < key(b); });
  stop_point();
  std::vector<int> first(vertices.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const auto at = static_cast<std::size_t>(order[i]);
    const bool same = i > 0 && vertices[at] == vertices[static_cast<std::size_t>(order[i - 1])];
    first[at] = same ? first[static_cast<std::size_t>(order[i - 1])] : order[i];
  }
  return first;
}

// The unit normal; zero when rounding of the corners, within [-1, 1]^3, can turn it over.
Vector3d unit_normal(const std::array<Vector3d, 3>& p) {
  const Vector3d a = p[1] - p[0], b = p[2] - p[0], n = a.cross(b);
  const double longest = std::max({a.norm(), b.norm(), (p[2] - p[1]).norm()}), length = n.norm();
  // Each corner is off by sqrt(3)/2 epsilon at most, the cross product by twice that times two edges; twice
  // again.
  constexpr double kShare = 8 * std::numeric_limits<double>::epsilon();
  return length > kShare * longest ? Vector3d(n / length) : Vector3d::Zero();
}

double angle_at(const std::array<Vector3d, 3>& p, std::size_t k) {
  const Vector3d a = p[(k + 1) % 3] - p[k], b = p[(k + 2) % 3] - p[k];
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

struct HalfEdge {
  int low, high, triangle, side;
  [[nodiscard]] auto key() const { return std::tuple(low, high, triangle, side); }
};

}  // namespace

MeshSide::MeshSide(const MeshFrame& frame)
    : face_(frame.triangles.size()),
      vertex_(frame.vertices.size(), Vector3d::Zero()),
      edge_(frame.triangles.size()) {
  const std::vector<int> first = welded(frame.vertices);
  const auto corner = [&](std::size_t t, std::size_t k) {
    return static_cast<std::size_t>(frame.triangles[t][k % 3]);
  };
  std::vector<HalfEdge> edges(3 * face_.size());
  std::vector<std::array<double, 3>> angles(face_.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, face_.size(), kGrain), [&](const auto& range) {
    for (std::size_t t = range.begin(); t != range.end(); ++t) {
      const std::array<Vector3d, 3> p{frame.vertices[corner(t, 0)], frame.vertices[corner(t, 1)],
                                      frame.vertices[corner(t, 2)]};
      face_[t] = unit_normal(p);
      for (std::size_t k = 0; k < 3; ++k) {
        angles[t][k] = angle_at(p, k);
        const int a = first[corner(t, k)], b = first[corner(t, k + 1)];
        edges[3 * t + k] = {std::min(a, b), std::max(a, b), static_cast<int>(t), static_cast<int>(k)};
      }
    }
  });
  stop_point();
  // Summed in the order of the triangles, whatever the number of threads.
  for (std::size_t t = 0; t < face_.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      vertex_[static_cast<std::size_t>(first[corner(t, k)])] += angles[t][k] * face_[t];
    }
  }
  for (std::size_t i = 0; i < vertex_.size(); ++i) vertex_[i] = vertex_[static_cast<std::size_t>(first[i])];
  tbb::parallel_sort(edges.begin(), edges.end(),
                     [](const HalfEdge& a, const HalfEdge& b) { return a.key() < b.key(); });
  stop_point();
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i;
    Vector3d sum = Vector3d::Zero();
    for (; end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high; ++end) {
      sum += face_[static_cast<std::size_t>(edges[end].triangle)];
    }
    for (; i < end; ++i) {
      edge_[static_cast<std::size_t>(edges[i].triangle)][static_cast<std::size_t>(edges[i].side)] = sum;
    }
  }
}

double MeshSide::height(const MeshFrame& frame, int triangle, const Vector3d& q, double rounding) const {
  const TriangleDistance d = frame.distance(triangle, q);
  if (d.distance_sq <= rounding * rounding) return 0;
  const auto t = static_cast<std::size_t>(triangle), k = static_cast<std::size_t>(d.corner);
  const Vector3d off = q - d.nearest;
  switch (d.feature) {
    case Feature::kFace:
      return off.dot(face_[t]);
    case Feature::kEdge:
      return off.dot(edge_[t][k]);
    case Feature::kVertex:
      break;
  }
  return off.dot(vertex_[static_cast<std::size_t>(frame.triangles[t][k])]);
}

}  // namespace hotblade::gpu

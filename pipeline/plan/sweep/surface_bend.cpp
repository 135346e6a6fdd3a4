#include "pipeline/plan/sweep/surface_bend.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "gpu/backend/stop.hpp"
#include "surface/read/blocks.hpp"

namespace hotblade::pipeline {

namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3f;
using Eigen::Vector3d;

// How the normals change over a triangle on which they are linear, negative and made symmetric.
SurfaceBend form_of(const std::array<Vector3d, 3>& p, const std::array<Vector3d, 3>& n) {
  const Vector3d u = p[1] - p[0], v = p[2] - p[0], across = u.cross(v);
  const double area_sq = across.squaredNorm();
  constexpr double kSliver_sq = 1e-20;  // of the sine of its angle
  if (!(area_sq > kSliver_sq * u.squaredNorm() * v.squaredNorm())) return {};
  // Their products with u and v are ones and zeros.
  const Vector3d by_u = v.cross(across) / area_sq, by_v = across.cross(u) / area_sq;
  const Matrix3d change = (n[1] - n[0]) * by_u.transpose() + (n[2] - n[0]) * by_v.transpose();
  const Matrix3f m = (-0.5 * (change + change.transpose())).cast<float>();
  return {{m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(0, 2), m(1, 2)}};
}

using Triangles = std::span<const std::array<int, 3>>;

// Of each vertex the mean over its faces, by these weights.
std::vector<SurfaceBend> at_vertices(std::size_t vertices, Triangles triangles,
                                     const std::vector<SurfaceBend>& faces,
                                     const std::vector<float>& weights) {
  std::vector<SurfaceBend> bends(vertices);
  std::vector<float> sums(vertices, 0);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (const int v : triangles[i]) {
      bends[static_cast<std::size_t>(v)].form += weights[i] * faces[i].form;
      sums[static_cast<std::size_t>(v)] += weights[i];
    }
  }
  for (std::size_t v = 0; v < vertices; ++v)
    if (sums[v] > 0) bends[v].form *= 1 / sums[v];
  return bends;
}

}  // namespace

double SurfaceBend::of(const Vector3d& t) const {
  return form[0] * t.x() * t.x() + form[1] * t.y() * t.y() + form[2] * t.z() * t.z() +
         2 * (form[3] * t.x() * t.y() + form[4] * t.x() * t.z() + form[5] * t.y() * t.z());
}

SurfaceBend between(const SurfaceBend& a, const SurfaceBend& b, double t) {
  return {static_cast<float>(1 - t) * a.form + static_cast<float>(t) * b.form};
}

std::vector<SurfaceBend> surface_bends(std::span<const Vector3d> points, std::span<const Vector3d> normals,
                                       Triangles triangles, std::span<const std::pair<int, int>> border,
                                       double over_mm) {
  constexpr std::size_t kBlock = 1 << 12;
  constexpr double kMostRounds = 16;
  constexpr float kHardly = 1e-6F;
  if (triangles.empty()) return std::vector<SurfaceBend>(points.size());
  std::vector<char> on_border(points.size(), 0);
  for (const auto& [a, b] : border)
    on_border[static_cast<std::size_t>(a)] = on_border[static_cast<std::size_t>(b)] = 1;
  const auto inside = [&](int v) { return on_border[static_cast<std::size_t>(v)] == 0; };
  const auto corners = [](std::span<const Vector3d> all, const std::array<int, 3>& t) {
    return std::array<Vector3d, 3>{all[static_cast<std::size_t>(t[0])], all[static_cast<std::size_t>(t[1])],
                                   all[static_cast<std::size_t>(t[2])]};
  };
  std::vector<SurfaceBend> faces(triangles.size());
  std::vector<float> areas(triangles.size()), weights(triangles.size());
  surface::for_blocks(triangles.size(), kBlock, [&](std::size_t first, std::size_t last) {
    gpu::stop_point();
    for (std::size_t i = first; i < last; ++i) {
      const auto& t = triangles[i];
      const auto p = corners(points, t);
      areas[i] = static_cast<float>((p[1] - p[0]).cross(p[2] - p[0]).norm());
      weights[i] = std::all_of(t.begin(), t.end(), inside) ? areas[i] : kHardly * areas[i];
      faces[i] = form_of(p, corners(normals, t));
    }
  });
  double area = 0;
  for (const float a : areas) area += 0.5 * a;
  const double cell_mm = std::sqrt(2 * area / static_cast<double>(triangles.size()));
  std::vector<SurfaceBend> bends = at_vertices(points.size(), triangles, faces, weights);
  const auto mean_over = [&](const std::array<int, 3>& t, const auto& counts) {
    SurfaceBend sum;
    float count = 0;
    for (const int v : t) {
      if (!counts(v)) continue;
      sum.form += bends[static_cast<std::size_t>(v)].form;
      ++count;
    }
    sum.form *= 1 / count;
    return sum;
  };
  // The normal at a border is that of half a facet inside: what bends there is taken from what lies behind.
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto& t = triangles[i];
    if (weights[i] < areas[i] && std::any_of(t.begin(), t.end(), inside)) faces[i] = mean_over(t, inside);
  }
  bends = at_vertices(points.size(), triangles, faces, areas);
  // A round of means over the vertices of a face and the faces at a vertex goes a facet farther, and many of
  // them by the root of their number.
  const double wide = over_mm / std::max(cell_mm, 1e-9);
  const auto rounds = static_cast<int>(std::clamp(std::ceil(wide * wide), 1.0, kMostRounds));
  for (int round = 1; round < rounds; ++round) {
    gpu::stop_point();
    for (std::size_t i = 0; i < triangles.size(); ++i)
      faces[i] = mean_over(triangles[i], [](int) { return true; });
    bends = at_vertices(points.size(), triangles, faces, areas);
  }
  return bends;
}

}  // namespace hotblade::pipeline

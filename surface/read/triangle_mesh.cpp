#include "surface/read/triangle_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <utility>

#include "surface/read/blocks.hpp"
#include "surface/read/half_edges.hpp"

namespace hotblade::surface {

TriangleMesh::TriangleMesh(TriangleSoup soup)
    : half_edges_(std::make_shared<const HalfEdges>(std::move(soup))),
      vertices_(half_edges_->vertices()),
      triangles_(half_edges_->triangles()) {}

TriangleSoup TriangleMesh::soup() const {
  return {{vertices_.begin(), vertices_.end()}, {triangles_.begin(), triangles_.end()}};
}

int TriangleMesh::beyond(int corner) const {
  const HalfEdges::Halfedge other = half_edges_->across(half_edges_->at_corner(corner));
  return other.is_valid() ? half_edges_->corner_of(other) : kNone;
}

std::vector<int> TriangleMesh::border() const {
  return half_edges_ ? half_edges_->border() : std::vector<int>();
}

std::vector<std::vector<int>> TriangleMesh::border_loops() const {
  // Turns about the edge's end, from triangle to triangle, to the border's next edge.
  const auto after = [&](int corner) {
    int c = next_corner(corner);
    for (int other = beyond(c); other != kNone; other = beyond(c)) c = next_corner(other);
    return c;
  };
  std::vector<bool> seen(3 * triangles_.size(), false);
  std::vector<std::vector<int>> loops;
  for (const int start : border()) {
    std::vector<int> loop;
    for (int c = start; !seen[static_cast<std::size_t>(c)]; c = after(c)) {
      seen[static_cast<std::size_t>(c)] = true;
      loop.push_back(c);
    }
    if (!loop.empty()) loops.push_back(std::move(loop));
  }
  return loops;
}

Eigen::Vector3d area_centre(const TriangleMesh& mesh) {
  if (mesh.vertices().empty()) throw std::logic_error("area_centre: the design has no vertices");
  // From a vertex: from the origin a design far away would lose its digits.
  const Eigen::Vector3d& from = mesh.vertices().front();
  // Six times the area's first moments, and thrice twice the area.
  const auto moments = [&](std::array<int, 3> t) -> Eigen::Vector4d {
    std::sort(t.begin(), t.end());
    const auto side = [&](std::size_t i) -> Eigen::Vector3d {
      return mesh.vertices()[static_cast<std::size_t>(t[i])] - from;
    };
    const Eigen::Vector3d a = side(0), b = side(1), c = side(2);
    const double area = (b - a).cross(c - a).norm();
    Eigen::Vector4d m;
    m << area * (a + b + c), 3 * area;
    return m;
  };
  const std::size_t count = mesh.triangles().size(), blocks = (count + kBlock - 1) / kBlock;
  std::vector<Eigen::Array4d> most(blocks, Eigen::Array4d::Zero());
  for_blocks(count, kBlock, [&](std::size_t first, std::size_t last) {
    for (const auto& t : mesh.triangles().subspan(first, last - first))
      most[first / kBlock] = most[first / kBlock].max(moments(t).array().abs());
  });
  Eigen::Array4d largest = Eigen::Array4d::Zero();
  for (const Eigen::Array4d& of : most) largest = largest.max(of);
  if (!(largest[3] > 0) || !largest.isFinite().all()) return from;
  // In whole numbers, so that the order of the triangles does not matter: each with 62 bits less those that
  // the sum may take, 42 for a million of them.
  constexpr int kBits = 62;
  const int taken = std::ilogb(static_cast<double>(mesh.triangles().size())) + 1;
  std::array<int, 4> shift{};
  for (Eigen::Index i = 0; i < 4; ++i)
    shift[static_cast<std::size_t>(i)] = largest[i] > 0 ? kBits - taken - (std::ilogb(largest[i]) + 1) : 0;
  using Sums = std::array<std::int64_t, 4>;
  std::vector<Sums> sum_of(blocks, Sums{});
  for_blocks(count, kBlock, [&](std::size_t first, std::size_t last) {
    for (const auto& t : mesh.triangles().subspan(first, last - first)) {
      const Eigen::Vector4d m = moments(t);
      for (std::size_t i = 0; i < 4; ++i)
        sum_of[first / kBlock][i] += std::llrint(std::ldexp(m[static_cast<Eigen::Index>(i)], shift[i]));
    }
  });
  Sums sums{};
  for (const Sums& of : sum_of) {
    for (std::size_t i = 0; i < 4; ++i) sums[i] += of[i];
  }
  const double total = std::ldexp(static_cast<double>(sums[3]), -shift[3]);
  Eigen::Vector3d centre = from;
  for (std::size_t i = 0; i < 3; ++i)
    centre[static_cast<Eigen::Index>(i)] += std::ldexp(static_cast<double>(sums[i]), -shift[i]) / total;
  return centre;
}

bool TriangleMesh::joined(int vertex, int other) const {
  return half_edges_ && half_edges_->joined(vertex, other);
}

}  // namespace hotblade::surface

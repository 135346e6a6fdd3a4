// Straight ways over the triangles of a mesh.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "surface/read/triangle_mesh.hpp"
#include "surface/slice/face_turn.hpp"

namespace hotblade::surface {

class Walks {
 public:
  explicit Walks(const TriangleMesh& mesh) : mesh_(mesh) {}

  struct Walk {
    double way_mm = 0;
    bool to_border = false;
  };

  // Walks from an edge into its triangle, square to it, and straight on over edges for as long as `goes_on`,
  // asked at each of these with the way so far and its corners in the triangles before and behind it, says
  // so.
  template <typename GoesOn>
  [[nodiscard]] Walk walk(int corner, const GoesOn& goes_on) const {
    const Eigen::Vector3d edge = at(next_corner(corner)) - at(corner);
    return walk_on(corner / 3, corner, at(corner) + 0.5 * edge,
                   normal(corner / 3).cross(edge).stableNormalized(), goes_on);
  }

  // Walks likewise from the middle of a triangle, in a direction in its plane.
  template <typename GoesOn>
  [[nodiscard]] Walk walk_from(int face, const Eigen::Vector3d& along, const GoesOn& goes_on) const {
    return walk_on(face, TriangleMesh::kNone, centroid(face), along, goes_on);
  }

 protected:
  [[nodiscard]] const Eigen::Vector3d& at(int corner) const {
    return mesh_.vertices()[static_cast<std::size_t>(vertex_at(mesh_, corner))];
  }
  [[nodiscard]] Eigen::Vector3d centroid(int face) const {
    return (at(3 * face) + at(3 * face + 1) + at(3 * face + 2)) / 3;
  }
  [[nodiscard]] Eigen::Vector3d normal(int face) const { return across_face(mesh_, face).stableNormalized(); }
  [[nodiscard]] double turn(int face, int other) const { return turn_between(mesh_, face, other); }

  const TriangleMesh& mesh_;

 private:
  // More facets than any design has that a walk should see through.
  static constexpr int kMostFacets = 10'000;

  struct Exit {
    int corner = TriangleMesh::kNone;
    double way_mm = 0;
  };

  // Where a line in a triangle meets one of its edges other than the one by which it came.
  [[nodiscard]] Exit leaves(int face, int entered, const Eigen::Vector3d& from,
                            const Eigen::Vector3d& along) const {
    const Eigen::Vector3d n = normal(face);
    Exit best;
    for (int corner = 3 * face; corner < 3 * face + 3; ++corner) {
      if (corner == entered) continue;
      const Eigen::Vector3d edge = at(next_corner(corner)) - at(corner), out = edge.cross(n);
      const double speed = along.dot(out);
      if (!(speed > 0)) continue;
      const double way = std::max(0.0, (at(corner) - from).dot(out) / speed);
      if (best.corner == TriangleMesh::kNone || way < best.way_mm) best = {corner, way};
    }
    return best;
  }

  template <typename GoesOn>
  [[nodiscard]] Walk walk_on(int face, int entered, Eigen::Vector3d from, Eigen::Vector3d along,
                             const GoesOn& goes_on) const {
    Walk walked;
    for (int facet = 0; facet < kMostFacets; ++facet) {
      const auto [exit, way] = leaves(face, entered, from, along);
      if (exit == TriangleMesh::kNone) break;
      walked.way_mm += way;
      from += way * along;
      const int next = mesh_.beyond(exit);
      walked.to_border = next == TriangleMesh::kNone;
      if (walked.to_border || !goes_on(walked.way_mm, exit, next)) break;
      // Straight on over the edge: the same along it, and into the next triangle.
      const Eigen::Vector3d over = (at(next_corner(next)) - at(next)).stableNormalized(),
                            inward = normal(next / 3).cross(over);
      const double share = std::clamp(along.dot(over), -1.0, 1.0);
      along = share * over + std::sqrt(1 - share * share) * inward;
      face = next / 3;
      entered = next;
    }
    return walked;
  }
};

}  // namespace hotblade::surface

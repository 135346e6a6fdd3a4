// Triangles in space: as plain arrays, and as a half-edge mesh seen through plain views.
//
// The half-edge mesh is OpenMesh's (half_edges.hpp, for the sources of this room). Other rooms see points,
// corners and neighbours by number: corner c = 3 f + i stands for corner i of triangle f and for its edge,
// which leads from corner i to corner i + 1 (mod 3).
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <span>
#include <vector>

namespace hotblade::surface {

// Points and triangles as plain arrays, before they are a mesh.
struct TriangleSoup {
  std::vector<Eigen::Vector3d> vertices;      // mm
  std::vector<std::array<int, 3>> triangles;  // indices into vertices, counter-clockwise seen from the front
};

class HalfEdges;

// A mesh never changes, and its copies share one half-edge structure: a copy costs nothing. Safe for
// concurrent readers.
class TriangleMesh {
 public:
  static constexpr int kNone = -1;

  // Makes a mesh without vertices and triangles.
  TriangleMesh() = default;
  // Takes any triangles: numbers and order of vertices, triangles and corners stay as they are, edges of more
  // than two triangles get no neighbours. Throws std::logic_error when a triangle names a vertex that does
  // not exist, or one vertex twice.
  explicit TriangleMesh(TriangleSoup soup);
  // There are no moves: a mesh that was moved away would keep views of another one's points.
  TriangleMesh(const TriangleMesh&) = default;
  TriangleMesh& operator=(const TriangleMesh&) = default;
  ~TriangleMesh() = default;

  // Returns the points in mm. The view lasts as long as a copy of this mesh does.
  [[nodiscard]] std::span<const Eigen::Vector3d> vertices() const { return vertices_; }
  // Returns the triangles' vertices, counter-clockwise seen from the front; the view lasts as `vertices`
  // does.
  [[nodiscard]] std::span<const std::array<int, 3>> triangles() const { return triangles_; }
  // Returns a copy as plain arrays.
  [[nodiscard]] TriangleSoup soup() const;

  // Returns the corner that holds the same edge in the triangle beyond it; kNone on the border and at an edge
  // of more than two triangles.
  [[nodiscard]] int beyond(int corner) const;
  // Returns the corners whose edge has nothing beyond it, ascending.
  [[nodiscard]] std::vector<int> border() const;
  // Returns the border's closed loops, each as corners whose edges follow each other in the sense of their
  // triangles; a loop starts at its lowest corner, and loops are sorted by their first corners.
  [[nodiscard]] std::vector<std::vector<int>> border_loops() const;
  // Tells whether an edge joins the two vertices.
  [[nodiscard]] bool joined(int vertex, int other) const;

  // Returns the half-edges for the sources of this room; the mesh must have triangles.
  [[nodiscard]] const HalfEdges& half_edges() const { return *half_edges_; }

 private:
  std::shared_ptr<const HalfEdges> half_edges_;
  std::span<const Eigen::Vector3d> vertices_;
  std::span<const std::array<int, 3>> triangles_;
};

// Returns the corner after `corner` in its triangle.
[[nodiscard]] constexpr int next_corner(int corner) {
  return corner % 3 == 2 ? corner - 2 : corner + 1;
}

// Returns the vertex at a corner.
[[nodiscard]] inline int vertex_at(const TriangleMesh& mesh, int corner) {
  return mesh.triangles()[static_cast<std::size_t>(corner / 3)][static_cast<std::size_t>(corner % 3)];
}

// Returns the centre of the surface's area, which moves and turns with it; the first vertex where it has no
// area. Throws std::logic_error when there is no vertex.
[[nodiscard]] Eigen::Vector3d area_centre(const TriangleMesh& mesh);

}  // namespace hotblade::surface

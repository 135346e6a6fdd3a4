// The half-edge structure (OpenMesh) under a TriangleMesh, for sources of surface/ only: a private header,
// which no other header includes, so that OpenMesh stays inside this room.
#pragma once

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
// After the mesh: it adds to a template that it does not include.
#include <OpenMesh/Core/Geometry/EigenVectorT.hh>

#include <array>
#include <memory>
#include <mutex>
#include <span>
#include <typeindex>
#include <vector>

#include "surface/read/mates.hpp"
#include "surface/read/triangle_mesh.hpp"

namespace hotblade::surface {

// Points in double precision, and nothing else an element could carry.
struct HalfEdgeTraits : OpenMesh::DefaultTraits {
  using Point = Eigen::Vector3d;
  using Normal = Eigen::Vector3d;
};

// Triangle f is OpenMesh's face f, with its corners in order, and vertex v its vertex v. OpenMesh holds only
// oriented manifolds; a triangle that it refuses (a third one at an edge, one of the opposite sense, one at a
// vertex that is surrounded already) lies beside the others in it, on copies of its vertices, and `across`
// knows what lies beyond its edges. So every set of triangles has one structure, in which what is wrong can
// be found and told; a mesh that can be sliced has no such triangles. A plain surface (mates.hpp), as nearly
// every design is, is laid out at once on all cores; OpenMesh is asked triangle by triangle for the others.
class HalfEdges {
 public:
  using Mesh = OpenMesh::TriMesh_ArrayKernelT<HalfEdgeTraits>;
  using Halfedge = OpenMesh::HalfedgeHandle;

  // Throws std::logic_error as TriangleMesh does.
  explicit HalfEdges(TriangleSoup soup);

  [[nodiscard]] const Mesh& mesh() const { return mesh_; }
  [[nodiscard]] std::span<const Eigen::Vector3d> vertices() const { return {mesh_.points(), vertices_}; }
  [[nodiscard]] std::span<const std::array<int, 3>> triangles() const { return triangles_; }

  // Returns the half-edge along triangle f's edge from corner 0 to corner 1.
  [[nodiscard]] Halfedge first(int f) const {
    return mesh_.next_halfedge_handle(mesh_.halfedge_handle(OpenMesh::FaceHandle(f)));
  }
  // Returns the half-edge along a corner's edge (triangle_mesh.hpp), and back.
  [[nodiscard]] Halfedge at_corner(int corner) const;
  [[nodiscard]] int corner_of(Halfedge h) const;

  // Returns the half-edge of the triangle beyond the edge of h, a triangle's; an invalid one on the border
  // and at crowded edges.
  [[nodiscard]] Halfedge across(Halfedge h) const {
    if (!refused_.empty()) return mesh_.property(across_, h);
    const Halfedge opposite = mesh_.opposite_halfedge_handle(h);
    return mesh_.is_boundary(opposite) ? Halfedge() : opposite;
  }

  [[nodiscard]] bool joined(int vertex, int other) const;

  // Edges of more than two triangles.
  struct Crowded {
    std::size_t edges = 0;
    std::array<int, 2> first{};  // its vertices, the lower one first; of several edges the lowest
    std::size_t triangles = 0;   // at the first one
  };
  [[nodiscard]] const Crowded& crowded() const { return crowded_; }

  // Tells whether OpenMesh refused triangles, or holds vertices with several fans of them.
  [[nodiscard]] bool has_seams() const;

  // Tells whether the triangles were found to be a plain surface: no edge of more than two, neighbours of one
  // sense, and one fan at each vertex.
  [[nodiscard]] bool plain() const { return plain_; }
  // Returns the corners whose edge has nothing beyond it, ascending.
  [[nodiscard]] std::vector<int> border() const;

  // Returns what `find()` finds of the mesh, a T, which these numbers tell from others of its kind: it is
  // found once and kept, as the mesh never changes. A T must not hold the mesh. Several threads may ask; two
  // that ask first may both find it.
  template <typename T, typename Find>
  [[nodiscard]] T found_once(const std::array<double, 3>& by, const Find& find) const {
    const auto known = [&]() -> const T* {
      for (const Finding& of : findings_) {
        if (of.kind == typeid(T) && of.by == by) return static_cast<const T*>(of.value.get());
      }
      return nullptr;
    };
    {
      const std::scoped_lock lock(finding_);
      if (const T* value = known()) return *value;
    }
    const auto value = std::make_shared<const T>(find());
    const std::scoped_lock lock(finding_);
    if (!known()) findings_.push_back({typeid(T), by, value});
    return *value;
  }

 private:
  struct Finding {
    std::type_index kind;
    std::array<double, 3> by;
    std::shared_ptr<const void> value;
  };
  // A half-edge of a triangle by its edge's vertices, the lower one first.
  struct EdgeUse {
    std::array<int, 2> edge;
    Halfedge halfedge;
    friend bool operator<(const EdgeUse& a, const EdgeUse& b) {
      return a.edge != b.edge ? a.edge < b.edge : a.halfedge < b.halfedge;
    }
  };

  // Lays the half-edges of a plain surface out as OpenMesh would, triangle by triangle.
  void lay_out(const std::vector<std::array<int, 3>>& triangles, Mates mates);
  void set_border();
  void add(const TriangleSoup& soup);
  void add_beside(const std::array<int, 3>& triangle);
  // Finds what lies beyond the edges of refused triangles.
  void link_refused();
  [[nodiscard]] std::vector<EdgeUse> uses_at_refused() const;

  Mesh mesh_;
  std::size_t vertices_ = 0;  // given; copies follow
  bool plain_ = false;
  std::vector<int> border_;  // of a plain surface: corners
  std::vector<std::array<int, 3>> triangles_;
  std::vector<int> refused_;                       // triangles
  OpenMesh::HPropHandleT<Halfedge> across_;        // only where triangles were refused
  std::vector<std::array<int, 2>> refused_edges_;  // sorted; the lower vertex first
  Crowded crowded_;
  mutable std::mutex finding_;
  mutable std::vector<Finding> findings_;
};

}  // namespace hotblade::surface

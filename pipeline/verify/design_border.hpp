// Where a design ends: edges of its mesh with one face.
#pragma once

#include <functional>
#include <vector>

#include "gpu/mesh/mesh_distance.hpp"
#include "pipeline/verify/mesh_view.hpp"
#include "surface/read/triangle_mesh.hpp"

namespace hotblade::pipeline {

// Tells whether a point on the mesh lies on one of its vertices or edges that are asked for: `vertex(v)`
// answers for vertex v, `edge(c)` for the edge that starts at corner c % 3 of triangle c / 3. Both ends of an
// edge that is asked for are vertices that are.
[[nodiscard]] bool lies_on(const MeshView& mesh, const gpu::Nearest& nearest,
                           const std::function<bool(int)>& vertex, const std::function<bool(int)>& edge);

class DesignBorder {
 public:
  explicit DesignBorder(const surface::TriangleMesh& mesh);

  // Tells whether this point, the nearest one of the mesh to some other point, lies on the border.
  [[nodiscard]] bool holds(const gpu::Nearest& nearest) const;

 private:
  surface::TriangleMesh mesh_;
  std::vector<bool> vertex_;  // on the border
};

}  // namespace hotblade::pipeline

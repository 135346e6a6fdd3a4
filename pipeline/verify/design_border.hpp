// Where a design ends: edges of its mesh with one face.
#pragma once

#include <vector>

#include "gpu/mesh/mesh_distance.hpp"
#include "pipeline/verify/mesh_view.hpp"
#include "surface/read/face_links.hpp"

namespace hotblade::pipeline {

class DesignBorder {
 public:
  // Looks at the mesh's triangles here only.
  explicit DesignBorder(const MeshView& mesh);

  // Does this point, the nearest one of the same mesh to some other point, lie on the border?
  [[nodiscard]] bool holds(const MeshView& mesh, const gpu::Nearest& nearest) const;

 private:
  // The edge that starts at corner `corner` % 3 of face `corner` / 3.
  [[nodiscard]] bool edge(std::size_t corner) const;

  surface::FaceLinks links_;
  std::vector<bool> vertex_;
};

}  // namespace hotblade::pipeline

// Tells which side of a mesh a point lies on.
//
// It is the sign of (point - nearest point) . n, where n is the face's normal when the nearest point lies
// within a face, the sum of its faces' normals on an edge, and the sum weighted by the faces' angles at a
// vertex: with these pseudo-normals the sign is right everywhere around a closed mesh whose faces agree
// (Baerentzen and Aanaes, "Signed distance computation using the angle weighted pseudonormal", 2005, theorem
// 1). A face's own normal is wrong beside every edge sharper than a right angle.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "gpu/mesh/mesh_frame.hpp"

namespace hotblade::gpu {

// Holds the pseudo-normals of a mesh. Vertices at the same place count as one, so a soup of triangles will
// do. Faces without area have no normal and no say.
class MeshSide {
 public:
  explicit MeshSide(const MeshFrame& frame);

  // Returns (point - nearest) . n of the feature of this triangle that is nearest to the point of the frame:
  // its sign is the side, and it is 0 where the point lies on the triangle up to `rounding` or the feature
  // has no normal.
  [[nodiscard]] double height(const MeshFrame& frame, int triangle, const Eigen::Vector3d& local_point,
                              double rounding) const;

 private:
  using Normals = std::vector<Eigen::Vector3d>;
  Normals face_, vertex_;                             // by triangle; by vertex
  std::vector<std::array<Eigen::Vector3d, 3>> edge_;  // by triangle, from corner k to the next
};

}  // namespace hotblade::gpu

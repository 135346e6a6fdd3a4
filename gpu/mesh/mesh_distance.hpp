// Computes the distances from many points to a triangle mesh.
//
// Promise of every backend: the nearest distance is within kDistanceErrorRel of the true one, relative to the
// largest coordinate that takes part (the mesh's and the point's), and distance, triangle and point are the
// same bits whatever the backend, the number of threads or the other points of the call. Degenerate triangles
// count as the segment or point they are.
//
// How: a search in single precision, in the mesh's own frame, with a derived error bound
// (kernels/mesh_tree.h) gives every triangle that can be the nearest; these alone are compared in double
// precision, by one formula that gives host and device the same bits (kernels/triangle_exact.h).
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <span>
#include <vector>

#include "gpu/backend/backend.hpp"

namespace hotblade::gpu {

struct Nearest {
  double distance = 0;  // same unit as the input, >= 0
  int triangle = -1;    // index of the nearest triangle; of several at the same computed distance, the lowest
  Eigen::Vector3d point{0, 0, 0};  // on that triangle
};

// Says on which side of a mesh a point lies: before it is where the face normals point to.
enum class Side { kBehind = -1, kNeither = 0, kBefore = 1 };

// Holds a mesh prepared for queries. It copies what it needs; concurrent queries are safe.
class MeshDistance {
 public:
  // Throws std::logic_error when there is no triangle, an index is out of range or a coordinate is not
  // finite; std::runtime_error when the search tree cannot be built (out of memory).
  MeshDistance(std::span<const Eigen::Vector3d> vertices, std::span<const std::array<int, 3>> triangles,
               Backend backend = Backend::kCpu);
  ~MeshDistance();
  MeshDistance(MeshDistance&&) noexcept;
  MeshDistance& operator=(MeshDistance&&) noexcept;

  // Returns one answer a point, in order; it runs on all cores allowed. Points that follow each other closely
  // are answered faster. Throws std::logic_error when a coordinate is not finite.
  [[nodiscard]] std::vector<Nearest> query(std::span<const Eigen::Vector3d> points) const;
  // The same into `answers`, for who asks often: fresh memory costs a device's queries more than the search.
  // Throws std::logic_error when the spans differ in size, too.
  void query(std::span<const Eigen::Vector3d> points, std::span<Nearest> answers) const;

  // Returns on which side of the mesh each point lies, from the answers that query gave for these points: by
  // the pseudo-normals of mesh_side.hpp, right everywhere around a closed mesh whose faces agree; beside an
  // open one, by the nearest face, edge or vertex. kNeither for points on the mesh up to kDistanceErrorRel
  // and beside triangles without area that no other shares. The first call prepares the normals. Throws
  // std::logic_error when the spans differ in size or an answer is not of this mesh.
  [[nodiscard]] std::vector<Side> sides(std::span<const Eigen::Vector3d> points,
                                        std::span<const Nearest> answers) const;

  // Returns what answered the last query, and why.
  [[nodiscard]] BackendUse used() const;

  static constexpr double kDistanceErrorRel = 1e-12;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hotblade::gpu

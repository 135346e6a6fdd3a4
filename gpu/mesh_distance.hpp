// Distance from many points to a triangle mesh.
//
// Promise of every backend: the nearest distance is within kDistanceErrorRel of the true one, relative to the
// largest coordinate that takes part (the mesh's and the point's), and distance, triangle and point do not
// depend on the number of threads or on the other points of the call. Degenerate triangles count as the
// segment or point they are.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace hotblade::gpu {

struct Nearest {
  double distance = 0;  // same unit as the input, >= 0
  int triangle = -1;    // index of the nearest triangle; of several at the same computed distance, the lowest
  Eigen::Vector3d point{0, 0, 0};  // on that triangle
};

// A mesh prepared for queries. Copies what it needs; safe for concurrent queries.
class MeshDistance {
 public:
  // Throws std::logic_error when there is no triangle, an index is out of range or a coordinate is not
  // finite; std::runtime_error when the search tree cannot be built (out of memory).
  MeshDistance(std::span<const Eigen::Vector3d> vertices, std::span<const std::array<int, 3>> triangles);
  ~MeshDistance();
  MeshDistance(MeshDistance&&) noexcept;
  MeshDistance& operator=(MeshDistance&&) noexcept;

  // One answer a point, in order; runs on all cores allowed. Points that follow each other closely are
  // answered faster. Throws std::logic_error when a coordinate is not finite.
  [[nodiscard]] std::vector<Nearest> query(std::span<const Eigen::Vector3d> points) const;

  // Distances are recomputed in double precision for the triangles that single-precision boxes cannot
  // exclude.
  static constexpr double kDistanceErrorRel = 1e-12;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Name of the backend in use, for run.json.
[[nodiscard]] std::string backend_name();

}  // namespace hotblade::gpu

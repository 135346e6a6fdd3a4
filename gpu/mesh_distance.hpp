// Distance from many points to a triangle mesh.
//
// Promise of every backend: the nearest distance is within kDistanceErrorRel of the mesh's largest coordinate of the
// true one, and value, triangle and point do not depend on the number of threads.
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
  int triangle = -1;    // index of a nearest triangle
  Eigen::Vector3d point{0, 0, 0};
};

// A mesh prepared for queries. Copies what it needs; safe for concurrent queries.
class MeshDistance {
 public:
  // Throws std::logic_error when there is no triangle, an index is out of range or a coordinate is not finite.
  MeshDistance(std::span<const Eigen::Vector3d> vertices, std::span<const std::array<int, 3>> triangles);
  ~MeshDistance();
  MeshDistance(MeshDistance&&) noexcept;
  MeshDistance& operator=(MeshDistance&&) noexcept;

  // One answer a point, in order; runs on all cores allowed.
  [[nodiscard]] std::vector<Nearest> query(std::span<const Eigen::Vector3d> points) const;

  // Distances are recomputed in double precision for the triangles that single-precision boxes cannot exclude.
  static constexpr double kDistanceErrorRel = 1e-12;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Name of the backend in use, for run.json.
[[nodiscard]] std::string backend_name();

}  // namespace hotblade::gpu

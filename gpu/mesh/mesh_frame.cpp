#include "gpu/mesh/mesh_frame.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace hotblade::gpu {
namespace {

using Eigen::Vector3d;

void check_input(std::span<const Vector3d> vertices, std::span<const std::array<int, 3>> triangles) {
  if (triangles.empty()) throw std::logic_error("MeshDistance: no triangles");
  for (const Vector3d& v : vertices) {
    if (!v.allFinite()) throw std::logic_error("MeshDistance: a vertex is not finite");
  }
  for (const auto& t : triangles) {
    for (const int i : t) {
      if (i < 0 || static_cast<std::size_t>(i) >= vertices.size()) {
        throw std::logic_error("MeshDistance: vertex index " + std::to_string(i) + " out of range, " +
                               std::to_string(vertices.size()) + " vertices");
      }
    }
  }
}

}  // namespace

MeshFrame make_mesh_frame(std::span<const Vector3d> vertices, std::span<const std::array<int, 3>> triangles) {
  check_input(vertices, triangles);
  MeshFrame frame;
  // Only vertices that a triangle uses count: a stray one far away would cost precision.
  Vector3d low = vertices[static_cast<std::size_t>(triangles[0][0])], high = low;
  for (const auto& triangle : triangles) {
    for (const int i : triangle) {
      low = low.cwiseMin(vertices[static_cast<std::size_t>(i)]);
      high = high.cwiseMax(vertices[static_cast<std::size_t>(i)]);
    }
  }
  frame.centre = 0.5 * low + 0.5 * high;
  const double half = (high - frame.centre).cwiseMax(frame.centre - low).maxCoeff();
  int exponent = 0;
  if (half > 0) std::frexp(half, &exponent);
  frame.scale = std::ldexp(1.0, std::clamp(-exponent, -1000, 1000));
  frame.vertices.assign(vertices.size(), Vector3d::Zero());
  for (const auto& triangle : triangles) {
    for (const int i : triangle) {
      frame.vertices[static_cast<std::size_t>(i)] = frame.local(vertices[static_cast<std::size_t>(i)]);
    }
  }
  frame.triangles.assign(triangles.begin(), triangles.end());
  return frame;
}

}  // namespace hotblade::gpu

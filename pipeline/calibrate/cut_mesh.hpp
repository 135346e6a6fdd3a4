// Where measured points lie against a cut surface.
//
// The surface is a grid of facets that stands for a smooth one. Between its vertices it bulges by half of
// what their tangent planes lie above a facet, which is exact for quadratics (Boubekeur and Alexa, Phong
// tessellation, 2008, with their weight 1/2): or a scan that slides along the cut would feel every facet's
// edge.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "gpu/mesh/mesh_distance.hpp"
#include "pipeline/verify/swept_surface.hpp"

namespace hotblade::pipeline {

// The surface's point nearest to a measured one.
struct Foot {
  Eigen::Vector3d point{0, 0, 0},
      normal{0, 0, 1};              // on its facet, mm; of the smooth surface, unit, towards the waste
  std::array<int, 3> corners{};     // vertices of its triangle
  std::array<double, 3> weights{};  // of them, at the foot
  double height_mm = 0;             // of the measured point above the smooth surface
  bool beside = false;              // the point lies past the surface's edge: its height says nothing
};

class CutMesh {
 public:
  explicit CutMesh(SweptSurface surface);
  // Returns the feet of the points, in their order.
  [[nodiscard]] std::vector<Foot> feet(std::span<const Eigen::Vector3d> points) const;
  // Returns the distances of the points.
  [[nodiscard]] std::vector<double> distances(std::span<const Eigen::Vector3d> points) const;
  [[nodiscard]] const SweptSurface& surface() const { return surface_; }

 private:
  SweptSurface surface_;
  std::vector<Eigen::Vector3d> normals_;  // of the smooth surface, by vertex
  gpu::MeshDistance distance_;
};

}  // namespace hotblade::pipeline

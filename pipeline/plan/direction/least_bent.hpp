// Planes that hold the direction along which a surface bends the least, as those along a cylinder's rulings
// do: blades lie along it, and what the surface bends by is left to the sweep.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "surface/read/design_surface.hpp"
#include "surface/slice/plane_family.hpp"

namespace hotblade::pipeline {

// How a surface's normals turn about the direction that it bends the least along.
struct NormalsTurn {
  Eigen::Vector3d along = Eigen::Vector3d::Zero();   // unit; what the surface bends along the least
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  // unit, square to it: the middle of the normals' angles
  double half_rad = 0;                               // that these go to both sides of the middle

  // Returns the normal of the planes along it that the normals stand alike steeply on from both sides: no
  // others leave the steepest of them as little.
  [[nodiscard]] Eigen::Vector3d planes_normal() const;
  // Returns how steep the outermost of these normals are to planes of this unit normal.
  [[nodiscard]] double steepest_rad(const Eigen::Vector3d& planes_normal) const;
};

// Returns how the normals of 98 of a hundred facets, by area, turn about a direction: the rest does not
// decide. Nothing where they face all round it.
[[nodiscard]] std::optional<NormalsTurn> normals_turn(const surface::TriangleMesh& mesh,
                                                      const Eigen::Vector3d& along);

// Returns the axis of the fan whose planes turn by as much less than the normals that these are no steeper to
// them than `steepest_rad`, in the same share everywhere: by least squares over the area, as only a cylinder
// has an axis that does so exactly, where planes turn half as far as the normals or as far. Nothing where
// they would turn by less than says where it is.
[[nodiscard]] std::optional<surface::FanAxis> axis_less_steep_than(const surface::TriangleMesh& mesh,
                                                                   const NormalsTurn& turn,
                                                                   double steepest_rad);

}  // namespace hotblade::pipeline

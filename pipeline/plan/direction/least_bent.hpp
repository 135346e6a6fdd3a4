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
  Eigen::Vector3d along = Eigen::Vector3d::Zero();   // unit; as the normals are the least steep to it
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  // unit, square to it: the middle of the normals' angles
  double half_rad = 0;                               // that these go to both sides of the middle

  // Returns the normal of the planes along it that the normals stand alike steeply on from both sides: no
  // others leave the steepest of them as little.
  [[nodiscard]] Eigen::Vector3d planes_normal() const;
};

// Returns the turn of 98 of a hundred normals by area: the rest does not decide. Nothing where no direction
// is the least bent (least_steep), or where normals face all round it.
[[nodiscard]] std::optional<NormalsTurn> normals_turn(const surface::TriangleMesh& mesh);

// Returns the axis along it of the fan whose planes turn half as far as the normals do: nowhere are these
// steeper to them than half of `half_rad`, by least squares over the area. An arc's lies on its circle,
// opposite the arc's middle (half of the angle at the centre). Nothing where the normals turn by less than
// says where it is.
[[nodiscard]] std::optional<surface::FanAxis> half_way_axis(const surface::TriangleMesh& mesh,
                                                            const NormalsTurn& turn);

}  // namespace hotblade::pipeline

// Where a clamp is: position and orientation.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace hotblade::robot {

// A clamp's position p in mm and orientation q, which turns the frame's axes to (blade tangent from A to B,
// in-plane normal, plane normal); unit length.
struct Pose {
  Eigen::Vector3d p{0, 0, 0};
  Eigen::Quaterniond q{1, 0, 0, 0};
};

// Both clamps of a blade. In the blade's plane the pair is elastica::ClampPair.
struct ClampPoses {
  Pose a, b;
};

// Returns whichever of q and -q, which are one orientation, has a positive largest component (lowest index on
// ties, order w x y z).
[[nodiscard]] Eigen::Quaterniond canonical(const Eigen::Quaterniond& q);

// Returns the same clamp seen from another frame: p' = R p + t.
[[nodiscard]] Pose transformed(const Pose& frame_to_other, const Pose& pose);

}  // namespace hotblade::robot

// Bodies along a path: where each is at a pose and between poses, and how far it can have moved. mm, rad.
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <string>
#include <vector>

#include "robot/arm/clearance.hpp"
#include "robot/arm/solid.hpp"

namespace hotblade::robot {

struct PlacedSolid {
  Solid solid;
  Eigen::Isometry3d at;
};

// By step from a pose to the next: how far points of a body move at most along the straight line, and how far
// the path leaves that.
struct Way {
  std::vector<double> straight_mm, bend_mm;
};

class MovingBody {
 public:
  MovingBody() = default;
  MovingBody(const MovingBody&) = delete;
  MovingBody& operator=(const MovingBody&) = delete;
  virtual ~MovingBody() = default;

  // Returns the body where it is at a pose, or a share of the way to the next, joints and blade moved in
  // straight lines. The path itself is no more than `bend_mm` of the step away from that.
  [[nodiscard]] virtual PlacedSolid placed(std::size_t pose, double share) const = 0;

  // Returns the body's way, or of an arm's body what the joints from index `from_joint` on move it: its way
  // as the link before that joint sees it.
  [[nodiscard]] virtual Way way(std::size_t from_joint) const = 0;

  std::string name;

  // Of an arm.
  std::size_t arm = 0;                  // index in the cell
  std::size_t joints = 0;               // that move it
  bool tool = false, follower = false;  // it stands on the flange; it has joints of its own that follow
};

using Bodies = std::vector<std::unique_ptr<MovingBody>>;

// Returns base, links and tool of one of the cell's arms; bodies without a shape are left out.
[[nodiscard]] Bodies arm_bodies(const Cell& cell, std::size_t arm, const CellPath& path);

[[nodiscard]] std::unique_ptr<MovingBody> standing_body(const Standing& standing, std::size_t poses);

// The blade between two of its stations.
[[nodiscard]] std::unique_ptr<MovingBody> blade_body(const CellPath& path, std::size_t from, std::size_t to);

}  // namespace hotblade::robot

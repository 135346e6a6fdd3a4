// What may not touch in a cell, and the controller's samples of how near it comes.
//
// Bodies are looked at where they are, every 10 ms, and nothing is proved between: a second opinion beside
// the planner's proof (robot/arm/clearance.hpp). A distance is asked for again once both bodies together have
// moved by what it was above the clearance; before that no sample can break it. mm, in the cell's frame.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "elastica/curve/elastica.hpp"
#include "robot/arm/cell.hpp"
#include "robot/arm/clearance.hpp"
#include "robot/arm/solid.hpp"
#include "robot/controller/arm_follower.hpp"
#include "robot/wire/protocol.hpp"

namespace hotblade::robot {

// What a controller knows of its arms and of what stands around them.
class ArmCell {
 public:
  struct Limits {
    double jerk_mm_s3 = 0, angular_jerk_rad_s3 = 0;  // of a clamp; 0: not judged
  };
  // `id` is the first 64 bits of the cell's hash, which ARMS has to name. `blocks` has by job what a
  // controller is not told: the block and what it stands on.
  ArmCell(Cell cell, std::uint64_t id, const Limits& limits,
          const std::map<std::uint64_t, std::vector<Standing>>& blocks = {});

  [[nodiscard]] const Cell& cell() const { return cell_; }
  [[nodiscard]] std::uint64_t id() const { return id_; }
  [[nodiscard]] const Limits& limits() const { return limits_; }

  // A body of an arm; `link` 7 is the tool.
  struct Body {
    std::uint8_t arm = 0, link = 0;
    std::size_t moved_by = 0;
    std::vector<MimicJoint> mimics;
    Solid solid;
  };
  // A body with another, with what stands, or with the blade between two of its stations; the blade with what
  // stands; or two that stand.
  struct Pair {
    protocol::ArmsOther other = protocol::ArmsOther::kNothing;
    std::size_t body = 0;
    std::size_t with = 0;  // index of a body or of what stands
    double clearance_mm = 0;
    // In a body's place: the blade, or the block or plinth, whose index among what stands is `body`.
    protocol::ArmsOther of = protocol::ArmsOther::kNothing;
    [[nodiscard]] bool has_blade() const {
      return other == protocol::ArmsOther::kBlade || of == protocol::ArmsOther::kBlade;
    }
  };
  [[nodiscard]] const std::vector<Body>& bodies() const { return bodies_; }
  [[nodiscard]] const std::vector<Solid>& standing() const { return standing_; }
  // Returns the pairs of a job, of which the first are those of every job.
  [[nodiscard]] std::vector<Pair> pairs_of(std::uint64_t job) const;

 private:
  void add_arm(std::size_t arm);
  void add_pairs_of_arms();
  void add_standing(const Standing& standing, std::vector<Pair>& pairs);
  [[nodiscard]] bool built_to_touch(const Body& a, const Body& b) const;

  Cell cell_;
  std::uint64_t id_;
  Limits limits_;
  std::vector<Body> bodies_;
  std::vector<Solid> standing_;
  std::vector<std::size_t> obstacles_;  // indices of what stands
  std::vector<Pair> pairs_;
  std::map<std::uint64_t, std::vector<Pair>> block_pairs_;
};

// One look after the other at the pairs of a job. It is copyable, as the checks that use it.
class ArmWatch {
 public:
  ArmWatch() = default;
  ArmWatch(const ArmCell& cell, std::uint64_t job, double blade_width_mm);

  // The blade at a look: between the clamps, in the axes of clamp A as it holds the blade.
  struct BladeNow {
    const elastica::Elastica& shape;
    const Pose& clamp_a;
    std::size_t arm_at_a;
  };
  struct TooNear {
    protocol::ArmsDetail detail;
    double mm = 0;
  };
  // Looks at the pairs with the arms where they are now; without a blade those of the blade are left out.
  // Returns the first that is nearer than its clearance.
  [[nodiscard]] std::optional<TooNear> look(const ArmCell& cell, const std::array<ArmPosture, 2>& arms,
                                            const std::optional<BladeNow>& blade);
  // How many distances were asked for.
  [[nodiscard]] std::size_t asked() const { return asked_; }

 private:
  void move_bodies(const ArmCell& cell, const std::array<ArmPosture, 2>& arms);
  void move_blade(const BladeNow& blade);
  [[nodiscard]] double distance(const ArmCell& cell, const ArmCell::Pair& pair, bool first_look) const;
  [[nodiscard]] std::optional<Solid> blade_beside(const ArmCell::Body* holder) const;
  [[nodiscard]] double moved(const ArmCell::Pair& pair) const;

  std::vector<ArmCell::Pair> pairs_;
  std::vector<Eigen::Isometry3d> at_;     // of the bodies
  std::vector<double> moved_mm_;          // of the bodies, along their ways
  std::vector<double> clear_until_mm_;    // by pair: while both have moved no more than that
  std::vector<Eigen::Vector3d> corners_;  // of the blade, two a station
  double blade_width_mm_ = 0, blade_moved_mm_ = 0, blade_sag_mm_ = 0, blade_length_mm_ = 0;
  std::size_t arm_at_a_ = 0, asked_ = 0;
  bool begun_ = false;
};

}  // namespace hotblade::robot

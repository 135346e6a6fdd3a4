// The controller's check of its arms: it follows their joints along the clamps' motion from those that ARMS
// declares, and says which limit breaks (docs/controller-protocol.md).
//
// A second opinion, by other code than the plan's: joints by Newton's method from where they are, speeds and
// jerk by differences of what came through registers, distances by samples. mm, rad, s.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "elastica/curve/elastica.hpp"
#include "robot/controller/arm_follower.hpp"
#include "robot/controller/arm_scene.hpp"
#include "robot/pose/clamp_offset.hpp"
#include "robot/pose/limit.hpp"
#include "robot/pose/rates.hpp"
#include "robot/pose/waypoint.hpp"
#include "robot/wire/protocol.hpp"

namespace hotblade::robot {

// A limit that breaks, and of the arms which part breaks it by how much; kNone: none does.
struct Breach {
  Limit limit = Limit::kNone;
  protocol::ArmsDetail detail{};
};

// Clamps come as near to the declared joints at waypoint 0 as this.
inline constexpr double kDeclaredOff_mm = 0.01, kDeclaredOff_rad = 1e-4;

// Checks one stream of poses. It is copyable, as LimitChecker: check a window on a copy. Unlike that it
// allocates: where it asks for a distance from the blade.
class ArmCheck {
 public:
  ArmCheck() = default;  // checks nothing
  // `clamp_a` says where clamp A holds the blade, from where the machine takes it to.
  ArmCheck(std::shared_ptr<const ArmCell> cell, const protocol::Arms& declared, std::uint64_t job,
           double blade_width_mm, const ClampOffset& clamp_a = {});

  [[nodiscard]] bool checks() const { return cell_ != nullptr; }
  // Returns whether the declared joints are of this cell and held the first pose; true before it came. A
  // check that does not fit has no joints, and finds nothing else.
  [[nodiscard]] bool fits() const { return fits_; }

  // The blade at a pose, between the clamps in the axes of clamp A as it holds the blade; where it is not
  // known nothing is asked of it.
  using Blade = std::optional<elastica::Elastica>;

  // Moves to the next waypoint of a stream, every 10 ms on the way, and returns the limit that breaks.
  [[nodiscard]] Breach next(const Waypoint& waypoint, const Blade& blade);
  // Returns the limit that the stop at the end of the stream breaks.
  [[nodiscard]] Breach finish();

  // Moves to any pose on the way, forwards or backwards; the waypoints around it are `step_s` apart.
  [[nodiscard]] Breach move_to(const Pose& a, const Pose& b, const Blade& blade, double step_s);
  // Moves to a waypoint that is executed, after the poses on the way to it.
  [[nodiscard]] Breach arrive(const Waypoint& waypoint, const Blade& blade);

  // Returns the joints that hold clamp A and clamp B; absent when they are not known.
  [[nodiscard]] std::optional<std::array<JointAngles, 2>> joints() const;
  // Returns how many distances were asked for.
  [[nodiscard]] std::size_t asked() const { return watch_.asked(); }

 private:
  // A waypoint as the arms meet it, and how far registers may have turned each joint.
  struct Met {
    double t = 0;
    std::array<JointAngles, 2> q, rounding;
    std::array<Eigen::Vector3d, 2> place, turned;  // of the clamps; turns since the first, added up
  };
  [[nodiscard]] bool begin(const Pose& a, const Pose& b);
  [[nodiscard]] std::optional<bool> jaw_flipped(std::size_t clamp, const Pose& pose) const;
  [[nodiscard]] Eigen::Isometry3d jaw_for(std::size_t clamp, const Pose& pose) const;
  [[nodiscard]] Breach follow_clamp(std::size_t clamp, const Pose& pose, double step_s);
  [[nodiscard]] Breach not_there(std::size_t clamp, const FollowedJoints& followed) const;
  [[nodiscard]] Breach check_angles(std::size_t clamp, double step_s) const;
  [[nodiscard]] Breach check_bends(std::size_t clamp, double step_s) const;
  [[nodiscard]] Met met(const Waypoint& waypoint) const;
  [[nodiscard]] Breach check_rates(const Met& now);
  [[nodiscard]] Breach check_change(const std::array<JointAngles, 2>& next_speed,
                                    const std::array<JointAngles, 2>& next_error, double next_s) const;
  [[nodiscard]] Breach note_for_jerk(const Met& now);
  [[nodiscard]] Breach check_jerk() const;
  [[nodiscard]] const CellArm& arm_at(std::size_t clamp) const { return cell_->cell().arms[arm_[clamp]]; }
  [[nodiscard]] std::uint8_t number(std::size_t clamp) const {
    return static_cast<std::uint8_t>(arm_[clamp] + 1);
  }

  std::shared_ptr<const ArmCell> cell_;
  protocol::Arms declared_;
  bool fits_ = true, begun_ = false;
  std::array<std::size_t, 2> arm_{0, 1};  // index in the cell, by clamp
  std::array<bool, 2> flip_{};
  std::array<ArmPosture, 2> posture_;  // by clamp
  std::array<ArmBends, 2> first_;      // whose signs the arms keep
  ArmWatch watch_;
  ClampOffset clamp_a_;
  std::optional<Waypoint> last_;
  std::optional<Met> met_;
  std::array<JointAngles, 2> speed_, speed_error_;
  double step_s_ = 0;  // of the last step; 0 before the first
  // Waypoints far enough apart to tell jerk from rounding; the oldest first.
  std::array<Met, 4> far_;
  std::size_t far_count_ = 0;
};

}  // namespace hotblade::robot

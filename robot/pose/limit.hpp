// Every limit that a job may break, in one table: what planner, branch check, controller and client name.
//
// A refusal states a limit by its name with amount and unit. A controller's STATUS states it by a code
// (docs/controller-protocol.md); the same limit has the same entry on both sides.
#pragma once

#include <cstdint>
#include <span>

namespace hotblade::robot {

enum class Limit : std::uint8_t {
  kNone,
  // Of waypoints and jobs, by code.
  kCount,
  kQuaternion,
  kHeat,
  kTime,
  kMinDt,
  kStartPose,
  kEnvelope,
  kSpeed,
  kAcceleration,
  kAngularSpeed,
  kAngularAcceleration,
  kChord,
  kBlade,
  kHeldPose,
  // Of the blade between two clamps, by code (robot/blade/blade_branch.hpp).
  kBladePlane,
  kBladeReach,
  kBladeSnap,
  kBladeYield,
  kBladeMargin,
  // Of the arms that hold the clamps, by code (robot/controller/arm_check.hpp).
  kCell,
  kArmReach,
  kJointAngle,
  kJointSpeed,
  kJointAcceleration,
  kNearSingular,
  kConfiguration,
  kArmClearance,
  kJointJerk,
  // Of plans alone: what a controller is never sent.
  kPlannedShape,
  kLean,
  kWasteSide,
  kSlope,
  kFacing,
  kGap,
  kStrips,
  kRibDeviation,
  kRibRadius,
  kRibLength,
  kBlockEdge,
  kClampClearance,
  kFreePart,
  kSelfCrossing,
  kPlannedMargin,
  kSag,
  kBendingStress,
  kSnapError,
  kTipping,
  kDuration,
  kJerk,
  kAngularJerk,
  kCommonPlane,
  kClampHeight,
  kSlowestFeed,
  kDeviation,
  kDeviationWithSag,
  kUncutShare,
  kBudget,
  kWristAngle,
  kElbowAngle,
  kShoulderDistance,
  kWarnings,
  // A code that this table does not know.
  kUnknown,
};

struct LimitInfo {
  Limit limit = Limit::kUnknown;
  const char* name = "";  // of the amount that is measured: "clamp speed"
  const char* unit = "";  // of the amount; empty: it has none
  // What it means that it is broken, where the name does not say it. What would help is not said: that takes
  // a trial (pipeline/advice/advice.hpp).
  const char* meaning = "";
  // STATUS's fault detail, and how it is said there, without an amount. 0 and empty: a controller does not
  // check it.
  std::uint16_t code = 0;
  const char* fault = "";
};

// Returns all entries, in the enum's order.
[[nodiscard]] std::span<const LimitInfo> limits();

// Returns the limit's entry.
[[nodiscard]] const LimitInfo& info(Limit limit);

// Tells whether the limit is one of the blade's shape: it snaps or could, yields, crosses itself, cuts what
// is kept or brings its clamps too near to the block.
[[nodiscard]] bool is_of_the_shape(Limit limit);

// Returns the limit of a fault detail; kUnknown for a code that is not in the table.
[[nodiscard]] Limit limit_of_code(std::uint16_t code);

}  // namespace hotblade::robot

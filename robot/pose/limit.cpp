#include "robot/pose/limit.hpp"

#include <algorithm>
#include <array>

namespace hotblade::robot {
namespace {

constexpr auto kLimits = std::to_array<LimitInfo>({
    {Limit::kNone, "no limit", "", "", 0, "no limit"},

    {Limit::kCount, "number of waypoints", "", "", 1, "number of waypoints or misplaced last flag"},
    {Limit::kQuaternion, "length of the quaternion", "", "", 2, "quaternion is not of unit length"},
    {Limit::kHeat, "heat bits of the clamps", "", "", 3, "heat bits of the clamps differ"},
    {Limit::kTime, "time of a waypoint", "s", "", 4, "time does not increase"},
    {Limit::kMinDt, "time between waypoints", "s", "", 5, "time step below the minimum"},
    {Limit::kStartPose, "half turn of the flat arc at the start", "rad", "", 6,
     "start pose is no flat circular arc of the blade"},
    {Limit::kEnvelope, "distance outside the envelope", "mm", "", 7, "position outside the envelope"},
    {Limit::kSpeed, "clamp speed", "mm/s", "", 8, "speed"},
    {Limit::kAcceleration, "clamp acceleration", "mm/s2", "", 9, "acceleration"},
    {Limit::kAngularSpeed, "clamp angular speed", "rad/s", "", 10, "angular speed"},
    {Limit::kAngularAcceleration, "clamp angular acceleration", "rad/s2", "", 11, "angular acceleration"},
    {Limit::kChord, "chord of the blade", "mm", "", 12, "chord too long for the blade"},
    {Limit::kBlade, "blade data of the job", "", "", 13, "blade data or number of waypoints out of range"},
    {Limit::kHeldPose, "distance of the path from the held pose", "mm", "", 14,
     "path does not continue from the held pose"},

    {Limit::kBladePlane, "distance of clamp B from clamp A's plane", "mm", "", 15,
     "clamps are not in one plane"},
    {Limit::kBladeReach, "distance between the clamps", "mm", "the blade is pulled taut", 16,
     "blade is pulled taut, the clamps are too far apart"},
    {Limit::kBladeSnap, "stability margin, the blade snaps through", "", "", 17, "blade snaps through"},
    {Limit::kBladeYield, "blade radius", "mm", "the blade would yield", 18, "blade would yield"},
    {Limit::kBladeMargin, "stability margin", "", "the blade could snap through", 19,
     "blade's stability margin is too small"},

    {Limit::kCell, "distance of the declared joints from waypoint 0", "mm", "", 20,
     "arms are not declared, or not those of this cell at waypoint 0"},
    {Limit::kArmReach, "distance of an arm's wrist from its shoulder", "mm", "the arm does not reach so far",
     21, "arm does not reach"},
    {Limit::kJointAngle, "joint angle of an arm", "degrees", "", 22, "joint limit"},
    {Limit::kJointSpeed, "joint speed of an arm", "rad/s", "", 23, "joint speed"},
    {Limit::kJointAcceleration, "joint acceleration of an arm", "rad/s2", "", 24, "joint acceleration"},
    {Limit::kNearSingular, "distance of an arm from singular", "", "", 25, "arm is next to singular"},
    {Limit::kConfiguration, "branch of an arm", "", "", 26, "arm's configuration would change"},
    {Limit::kArmClearance, "clearance in the cell", "mm", "", 27, "too near in the cell"},
    {Limit::kJointJerk, "jerk of an arm", "", "", 28, "jerk of a joint or clamp"},

    {Limit::kPlannedShape, "distance of the blade from the planned shape", "mm",
     "the clamps lead the blade to another shape than the plan's"},
    {Limit::kLean, "lean of the surface towards z", "", "design.keep says nothing about an upright surface"},
    {Limit::kWasteSide, "side of the waste across the ribs", "", "face normals turn over along the ribs"},
    {Limit::kSlope, "slope of the design against the rib planes", "degrees",
     "no blade follows what is as steep"},
    {Limit::kFacing, "turn of the design's normals within a rib plane", "degrees",
     "no blade forms what faces back"},
    {Limit::kGap, "gap in the design within a strip that keeps to one side", "mm", ""},
    {Limit::kStrips, "strips", "", "no part of the design could be planned"},
    {Limit::kRibDeviation, "deviation of an elastica", "mm", ""},
    {Limit::kRibRadius, "radius of a rib (bending stress over yield strength and safety)", "mm",
     "the design bends more sharply than the blade can"},
    {Limit::kRibLength, "rib length", "mm", "no blade is as long"},
    {Limit::kBlockEdge, "block edge", "mm", "no block is as large"},
    {Limit::kClampClearance, "clamp clearance to the stock", "mm", ""},
    {Limit::kFreePart, "depth of the blade's free part in the kept foam", "mm", ""},
    {Limit::kSelfCrossing, "self-crossings of the blade", "", ""},
    {Limit::kPlannedMargin, "stability margin (snap-through)", "", "the blade could snap through on its way"},
    {Limit::kSag, "sag of the blade under its weight", "mm", ""},
    {Limit::kBendingStress, "bending stress (yield strength over safety)", "MPa",
     "the blade would yield on its way"},
    {Limit::kSnapError, "clamp error that makes the blade snap", "mm", ""},
    {Limit::kTipping, "margin against tipping out of the plane", "", ""},
    {Limit::kDuration, "duration", "s", "registers hold no more"},
    {Limit::kJerk, "clamp jerk", "mm/s3", ""},
    {Limit::kAngularJerk, "clamp angular jerk", "rad/s3", ""},
    {Limit::kCommonPlane, "distance of the clamps from a common plane", "mm", ""},
    {Limit::kClampHeight, "clamp height above the table", "mm", ""},
    {Limit::kSlowestFeed, "feed of the slowest blade point", "mm/s", "the blade would melt too wide there"},
    {Limit::kDeviation, "deviation", "mm", ""},
    {Limit::kDeviationWithSag, "deviation with the sag of the blade under its weight", "mm", ""},
    {Limit::kUncutShare, "uncut share of the area", "%", ""},
    {Limit::kBudget, "error budget", "mm", ""},
    {Limit::kWristAngle, "angle between axes 4 and 6 of an arm", "degrees", "the arm is next to singular"},
    {Limit::kElbowAngle, "angle of an arm's elbow from stretched", "degrees", "the arm is next to singular"},
    {Limit::kShoulderDistance, "distance of an arm's wrist from axis 1", "mm", "the arm is next to singular"},
    {Limit::kWarnings, "warnings with --strict", "", ""},

    {Limit::kUnknown, "unknown limit", "", "", 0, "unknown limit"},
});

constexpr bool in_order() {
  for (std::size_t i = 0; i < kLimits.size(); ++i) {
    if (static_cast<std::size_t>(kLimits[i].limit) != i) return false;
  }
  return kLimits.back().limit == Limit::kUnknown;
}
static_assert(in_order(), "kLimits has one entry for each Limit, in its order");

}  // namespace

std::span<const LimitInfo> limits() {
  return kLimits;
}

const LimitInfo& info(Limit limit) {
  return kLimits[static_cast<std::size_t>(limit)];
}

bool is_of_the_shape(Limit limit) {
  constexpr std::array kShape{Limit::kBladeReach,    Limit::kBladeSnap,    Limit::kBladeYield,
                              Limit::kBladeMargin,   Limit::kPlannedShape, Limit::kClampClearance,
                              Limit::kFreePart,      Limit::kSelfCrossing, Limit::kPlannedMargin,
                              Limit::kBendingStress, Limit::kSnapError};
  return std::find(kShape.begin(), kShape.end(), limit) != kShape.end();
}

Limit limit_of_code(std::uint16_t code) {
  if (code == 0) return Limit::kNone;
  const auto* const at =
      std::find_if(kLimits.begin(), kLimits.end(), [code](const LimitInfo& i) { return i.code == code; });
  return at == kLimits.end() ? Limit::kUnknown : at->limit;
}

}  // namespace hotblade::robot

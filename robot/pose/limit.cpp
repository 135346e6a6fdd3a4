#include "robot/pose/limit.hpp"

#include <algorithm>
#include <array>

namespace hotblade::robot {
namespace {

constexpr const char* kPlanAgain = "plan the program again for this machine";

constexpr auto kLimits = std::to_array<LimitInfo>({
    {Limit::kNone, "no limit", "", "nothing is broken", 0, "no limit"},

    {Limit::kCount, "number of waypoints", "", "send the job that OPEN announced", 1,
     "number of waypoints or misplaced last flag"},
    {Limit::kQuaternion, "length of the quaternion", "", kPlanAgain, 2, "quaternion is not of unit length"},
    {Limit::kHeat, "heat bits of the clamps", "", kPlanAgain, 3, "heat bits of the clamps differ"},
    {Limit::kTime, "time of a waypoint", "s", kPlanAgain, 4, "time does not increase"},
    {Limit::kMinDt, "time between waypoints", "s", "raise motion.waypoint_s", 5,
     "time step below the minimum"},
    {Limit::kStartPose, "half turn of the flat arc at the start", "rad",
     "a strip starts at a flat arc of 0.10 to 0.17 rad", 6,
     "start pose is no flat circular arc of the blade"},
    {Limit::kEnvelope, "distance outside the envelope", "mm", "choose a shorter blade or a larger machine", 7,
     "position outside the envelope"},
    {Limit::kSpeed, "clamp speed", "mm/s", "plan again with what this machine can: motion.travel_mm_s", 8,
     "speed"},
    {Limit::kAcceleration, "clamp acceleration", "mm/s2",
     "plan again with what this machine can: motion.accel_mm_s2", 9, "acceleration"},
    {Limit::kAngularSpeed, "clamp angular speed", "rad/s",
     "plan again with what this machine can: motion.angular_rad_s", 10, "angular speed"},
    {Limit::kAngularAcceleration, "clamp angular acceleration", "rad/s2",
     "plan again with what this machine can: motion.angular_accel_rad_s2", 11, "angular acceleration"},
    {Limit::kChord, "chord of the blade", "mm", kPlanAgain, 12, "chord too long for the blade"},
    {Limit::kBlade, "blade data of the job", "", "check the program's blade", 13,
     "blade data or number of waypoints out of range"},
    {Limit::kHeldPose, "distance of the path from the held pose", "mm",
     "send the job that was under way when the controller stopped", 14,
     "path does not continue from the held pose"},

    {Limit::kBladePlane, "distance of clamp B from clamp A's plane", "mm",
     "both clamps of a waypoint lie in one plane", 15, "clamps are not in one plane"},
    {Limit::kBladeReach, "distance between the clamps", "mm", "the blade is pulled taut: a longer blade", 16,
     "blade is pulled taut, the clamps are too far apart"},
    {Limit::kBladeSnap, "stability margin, the blade snaps through", "", "a shorter blade or more splits", 17,
     "blade snaps through"},
    {Limit::kBladeYield, "blade radius", "mm", "the blade would yield: a thinner blade or more splits", 18,
     "blade would yield"},
    {Limit::kBladeMargin, "stability margin", "",
     "the blade could snap through: a shorter blade or more splits", 19,
     "blade's stability margin is too small"},

    {Limit::kPlannedShape, "distance of the blade from the planned shape", "mm",
     "the clamps lead the blade to another shape than the plan's"},
    {Limit::kLean, "lean of the surface towards z", "", "set design.keep to back or front"},
    {Limit::kWasteSide, "side of the waste across the ribs", "",
     "face normals turn over along the ribs: check their orientation or choose another slice.direction"},
    {Limit::kSlope, "slope of the design against the rib planes", "degrees",
     "another slice.direction, or leave slice.direction to the search"},
    {Limit::kFacing, "turn of the design's normals within a rib plane", "degrees",
     "no blade forms what faces back: another slice.direction, or more splits"},
    {Limit::kStrips, "strips", "", "no chain of ribs was found: see the warnings"},
    {Limit::kRibDeviation, "deviation of an elastica", "mm",
     "allow more splits (fit.max_splits) or a larger tolerance"},
    {Limit::kRibRadius, "radius of a rib (bending stress over yield strength and safety)", "mm",
     "the design bends more sharply than the blade can: thinner blade, lower blade.safety, or another "
     "slice.direction"},
    {Limit::kRibLength, "rib length", "mm",
     "add a longer blade to blade.free_lengths_mm or allow more splits"},
    {Limit::kBlockEdge, "block edge", "mm", "allow more splits or larger stock.max_size_mm"},
    {Limit::kClampClearance, "clamp clearance to the stock", "mm",
     "add a longer blade to blade.free_lengths_mm"},
    {Limit::kFreePart, "depth of the blade's free part in the kept foam", "mm", "closer ribs or more splits"},
    {Limit::kSelfCrossing, "self-crossings of the blade", "", "more splits or a shorter blade"},
    {Limit::kPlannedMargin, "stability margin (snap-through)", "",
     "the blade could snap through on the way: a shorter blade or more splits"},
    {Limit::kSag, "sag of the blade under its weight", "mm",
     "allow more splits, or a wider or shorter blade"},
    {Limit::kBendingStress, "bending stress (yield strength over safety)", "MPa",
     "the blade would yield on the way: closer ribs, or a thinner blade"},
    {Limit::kSnapError, "clamp error that makes the blade snap", "mm",
     "a shorter blade or more splits; or more exact clamps (machine.clamp_error_mm, "
     "machine.clamp_error_rad)"},
    {Limit::kTipping, "margin against tipping out of the plane", "", "a shorter or thicker blade"},
    {Limit::kDuration, "duration", "s", "raise motion.feed_mm_s or split the design"},
    {Limit::kCommonPlane, "distance of the clamps from a common plane", "mm",
     "lower motion.waypoint_s or motion.feed_mm_s"},
    {Limit::kClampHeight, "clamp height above the table", "mm", "raise machine.plinth_mm"},
    {Limit::kSlowestFeed, "feed of the slowest blade point", "mm/s",
     "the blade would melt too wide there: another slice.direction or a lower motion.min_feed_mm_s"},
    {Limit::kDeviation, "deviation", "mm",
     "a larger tolerance, closer ribs (slice.spacing_mm) or another slice.direction"},
    {Limit::kDeviationWithSag, "deviation with the sag of the blade under its weight", "mm",
     "a shorter or wider blade, or another slice.direction"},
    {Limit::kUncutShare, "uncut share of the area", "%",
     "another slice.direction, a trimmed design or a larger design.max_uncut_share"},
    {Limit::kBudget, "error budget", "mm",
     "more exact clamps (machine.clamp_error_mm, machine.clamp_error_rad), or design.over_budget = \"warn\""},
    {Limit::kWarnings, "warnings with --strict", "", "see to them, or plan without --strict"},

    {Limit::kUnknown, "unknown limit", "", "the controller speaks of a limit that came after this program", 0,
     "unknown limit"},
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

Limit limit_of_code(std::uint16_t code) {
  if (code == 0) return Limit::kNone;
  const auto* const at =
      std::find_if(kLimits.begin(), kLimits.end(), [code](const LimitInfo& i) { return i.code == code; });
  return at == kLimits.end() ? Limit::kUnknown : at->limit;
}

}  // namespace hotblade::robot

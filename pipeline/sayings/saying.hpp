// What plans, cells and designs are told to be: why a limit broke, what to look at, what was not checked.
// Each sentence has a code and stands in one table, in English, with places for its values; report.json and
// program.json have it so. Pages in another language find it again by what stands between its places
// (pipeline/report/words.hpp).
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <variant>

namespace hotblade::pipeline {

enum class Saying : std::uint8_t {
  // Of a refusal: when and where.
  kInPhase,
  kBeforeTheStrip,
  kFromItsBezier,
  kAt,
  kAbout,
  kMeasuredThere,
  // Why a limit broke, and what else is known of it.
  kTenthForBezier,
  kTurnsThere,
  kTurnsWithPlanes,
  kFasterInWaste,
  kHeldBack,
  kLeadEndsNear,
  kUpright,
  kClosed,
  kUnitOrParts,
  kOverFacets,
  kBladeReach,
  kNoBound,
  kByRegisters,
  kFirstWarning,
  kClampsWithin,
  kClampsNotEnough,
  kAnyHeight,
  // Of arms.
  kArm,
  kArmPart,
  kArmJointNear,
  kArmShort,
  kArmTooNear,
  kJointBeyond,
  kArmSingular,
  kAtTheStart,
  kNotProvedClear,
  kTooNear,
  kOtherJawOrPlace,
  kRaiseOrSmallerPlinth,
  kRaise,
  kOtherJawOrBases,
  kOtherJawOrPlaces,
  kOtherPlaces,
  kJointTooSlow,
  kRaised,
  kRaisedMoved,
  kRaisedTurned,
  kRaisedMovedTurned,
  kOfChoices,
  // Warnings.
  kNearlyStraight,
  kSlowMelt,
  kFacets,
  kShownCoarsely,
  kOfDesign,
  kOverBudget,
  kJointNearLimit,
  kWristNearStraight,
  kAccelerationsAssumed,
  kToolHasNoShape,
  kLinksHaveNoShape,
  kNoTable,
  kSmallExtent,
  kMostlyLost,
  kMostlyLostGiven,
  kStripsAtLeast,
  kIsThatTheUnit,
  kIsThatTheUnitOthers,
  kIfInUnit,
  kIfInUnitStrips,
  kAnd,
  // Why another setting may help.
  kSolidAlongY,
  kSolidUpperFaces,
  kSolidFaces,
  kFacesAlongY,
  kStandsUpright,
  kLeansNowhere,
  kPlanesGiven,
  kOtherRibs,
  kShareOfWeight,
  kMayStayUncut,
  kThinnerBlade,
  kSlowestPoint,
  kTimeOfCut,
  kBlockHigher,
  kEdgeOfBlock,
  kOneMoreLength,
  kSmallestTried,
  kWithout,
  kAlso,
  // What was not checked.
  kSnapsBetween,
  kClampsInDeviation,
  kMeltOfHeld,
  kMeltOfSlow,
  kHotSteel,
  kArmsNotLookedAt,
  kThermal,
  kPlinthAside,
  kJerkUnlimited,
  kJerkOfHolds,
  kShapelessLinks,
  kShapelessTool,
  kArmsBeyond,
};

struct SayingInfo {
  Saying saying = Saying::kInPhase;
  const char* english = "";  // places as fmt::format has them; those with a format take numbers alone
};

// Returns all entries, in the enum's order.
[[nodiscard]] std::span<const SayingInfo> sayings();

// A value of a sentence: a number, a count, or words, which may be a sentence themselves.
class SaidValue {
 public:
  // NOLINTBEGIN(google-explicit-constructor): values are written as they are
  SaidValue(double number) : value_(number) {}
  template <std::integral Count>
  SaidValue(Count count) : value_(static_cast<long long>(count)) {}
  SaidValue(std::string words) : value_(std::move(words)) {}
  SaidValue(std::string_view words) : value_(std::string(words)) {}
  SaidValue(const char* words) : value_(std::string(words)) {}
  // NOLINTEND(google-explicit-constructor)

  [[nodiscard]] const std::variant<double, long long, std::string>& value() const { return value_; }

 private:
  std::variant<double, long long, std::string> value_;
};

// Returns the sentence in English, its values in their places. Throws std::logic_error where they do not go
// into them.
[[nodiscard]] std::string say(Saying saying, std::initializer_list<SaidValue> values = {});

}  // namespace hotblade::pipeline

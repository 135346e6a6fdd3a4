#include "pipeline/sayings/saying.hpp"

#include <fmt/args.h>
#include <fmt/format.h>

#include <array>
#include <stdexcept>

namespace hotblade::pipeline {
namespace {

constexpr auto kSayings = std::to_array<SayingInfo>({
    {Saying::kInPhase, " in phase {} at {:.2f} s"},
    {Saying::kBeforeTheStrip, " before the strip begins"},
    {Saying::kFromItsBezier, " from its Bezier"},
    {Saying::kAt, "at ({:.1f}, {:.1f}, {:.1f})"},
    {Saying::kAbout, "about ({:.1f}, {:.1f}, {:.1f})"},
    {Saying::kMeasuredThere, ", measured there {:.3f} mm"},

    {Saying::kTenthForBezier, "a Bezier may use up a tenth of the tolerance"},
    {Saying::kTurnsThere,
     "the blade turns there, its fastest point goes at {:.3g} mm/s, and it would melt too wide"},
    {Saying::kTurnsWithPlanes,
     "the blade turns there with its planes, its fastest point goes at {:.3g} mm/s, and it would melt too "
     "wide"},
    {Saying::kFasterInWaste,
     "the blade turns there, its fastest point in foam, in the waste beside the design, goes at {:.3g} mm/s, "
     "and it would melt too wide: the smallest feed takes motion.feed_mm_s of {} mm/s"},
    {Saying::kHeldBack,
     "the clamps' {} holds the blade back there, and it would melt too wide: the smallest feed takes {} of "
     "{} {}"},
    {Saying::kLeadEndsNear, "motion.lead_mm ends nearer behind the block"},
    {Saying::kUpright, "design.keep = \"{}\" says nothing about an upright surface"},
    {Saying::kClosed,
     "the design is closed, and a blade cuts one side of it: design.facing says which, and check proposes "
     "one"},
    {Saying::kUnitOrParts, "is the design really in {}? Else plan it in parts"},
    {Saying::kOverFacets,
     "a cut that is smooth across the design's facets there, {:.0f} mm wide, is off by that at least"},
    {Saying::kBladeReach,
     "about ({:.1f}, {:.1f}, {:.1f}) no blade that bends to {:.1f} mm follows the design for {:.0f} mm to "
     "both sides, whichever way it lies"},
    {Saying::kNoBound, "tries that failed: {}; that every one would is not proved"},
    {Saying::kByRegisters,
     "of it {:.3f} mm are what the controller's micrometres move a nearly straight blade by"},
    {Saying::kFirstWarning, "first: {}"},
    {Saying::kClampsWithin, "within {:g} mm if the clamps are within {:g} mm and {:g} mrad"},
    {Saying::kClampsNotEnough, "not within {:g} mm for certain, however exact the clamps are"},
    {Saying::kAnyHeight, "at any height of cell.raise_mm"},

    {Saying::kArm, "arm {}"},
    {Saying::kArmPart, "arm {} {}"},
    {Saying::kArmJointNear, "arm {} {} from its limit"},
    {Saying::kArmShort,
     "arm {} cannot reach clamp {}, {:.0f} mm short: another place of its base, or another height of the "
     "block"},
    {Saying::kArmTooNear,
     "arm {} cannot reach clamp {}, {:.0f} mm too near: another place of its base, or another height of the "
     "block"},
    {Saying::kJointBeyond,
     "arm {} {}, limit {:.4g}, of which {:.3g} are kept ({:.3g} over): another jaw, or another place of the "
     "block"},
    {Saying::kArmSingular, "arm {} is next to singular: another jaw, or another place of the block"},
    {Saying::kAtTheStart,
     "{}, where the straight blade is bent to the strip's first shape: another place of the block"},
    {Saying::kNotProvedClear,
     "{} and {}: not proved clear of {:.4g} mm between {:.3f} and {:.3f} s (bound {:.1f} mm)"},
    {Saying::kTooNear, "{} is {:.1f} mm from {}, {:.4g} at least ({:.1f} mm too near)"},
    {Saying::kOtherJawOrPlace, "{}: another jaw, or another place of the block"},
    {Saying::kRaiseOrSmallerPlinth,
     "{}: raise the block (cell.raise_mm) or make the plinth smaller (plinth.inset_mm)"},
    {Saying::kRaise, "{}: raise the block (cell.raise_mm)"},
    {Saying::kOtherJawOrBases, "{}: another jaw, or bases farther apart"},
    {Saying::kOtherJawOrPlaces, "{}: another jaw, or another place of the block or of what stands there"},
    {Saying::kOtherPlaces,
     "{}: another place of the block (cell.place = \"search\" looks for one) or of what stands there"},
    {Saying::kJointTooSlow,
     "{} would slow the cut to {:.2g} mm/s, {:.2g} mm/s at least (motion.min_feed_mm_s): tilt the jaw or "
     "turn the block"},
    {Saying::kRaised, "raised {:.0f} mm"},
    {Saying::kRaisedMoved, "raised {:.0f} mm, moved {:.0f}, {:.0f} mm"},
    {Saying::kRaisedTurned, "raised {:.0f} mm, turned {:.0f} degrees"},
    {Saying::kRaisedMovedTurned, "raised {:.0f} mm, moved {:.0f}, {:.0f} mm, turned {:.0f} degrees"},
    {Saying::kOfChoices,
     "{} ({}; of {} choices of place and arms {} are out of reach, {} at joint limits, {} next to singular, "
     "{} not clear, {} too slow a cut for a joint; cell {})"},

    {Saying::kNearlyStraight,
     "{}: blade nearly straight or taut at {} poses from {:.2f} s ({}) to {:.2f} s ({}): its clamps decide "
     "its "
     "shape to second order only, and their errors may move it by {:.1f} mm"},
    {Saying::kSlowMelt,
     "{}: the blade goes at {:.3g} mm/s square to itself, slower than foam.band_mm_at_mm_s tells ({:.3g} "
     "mm/s): it melts more than the {:.3g} mm that are taken there"},
    {Saying::kFacets,
     "design: height of the facets' chords ({:.3g} mm, limit {:.3g} mm): the cut follows its facets, not the "
     "surface that they stand for"},
    {Saying::kShownCoarsely,
     "design: refused, and shown as it was looked at: poses eight times as far apart, the cut measured at "
     "half "
     "as many places a mm, the clamps' errors left out"},
    {Saying::kOfDesign, "design: {}"},
    {Saying::kOverBudget,
     "error budget {:.4g} mm (tolerance {:g} mm), of it {:.4g} mm by clamps that err by {:g} mm and {:g} "
     "mrad: {}"},
    {Saying::kJointNearLimit, "{}: arm {} joint {} comes within {:.1f} degrees of its limit at {:.2f} s"},
    {Saying::kWristNearStraight, "{}: arm {} comes within {:.1f} degrees of a straight wrist at {:.2f} s"},
    {Saying::kAccelerationsAssumed,
     "arm {}: accelerations are assumed: give acceleration_rad_s2 of the arm's maker"},
    {Saying::kToolHasNoShape, "arm {}: the tool has no shape: give its boxes"},
    {Saying::kLinksHaveNoShape, "arm {}: no collision shape in its model: {}"},
    {Saying::kNoTable, "no table: give [table] size_mm"},
    {Saying::kSmallExtent, "largest extent {:.6g} mm is less than clamps are apart ({:g} mm)"},
    {Saying::kMostlyLost, "{:.0f} % of the area is too steep or too sharp for the blade in any planes"},
    {Saying::kMostlyLostGiven,
     "{:.0f} % of the area is too steep or too sharp for the blade in the planes given: others suit more of "
     "it"},
    {Saying::kStripsAtLeast, "largest extent {:.6g} mm: {} strips at least"},
    {Saying::kIsThatTheUnit, "{}: is that the design's unit?"},
    {Saying::kIsThatTheUnitOthers, "{}: is that the design's unit? {}"},
    {Saying::kIfInUnit, "{} x {} x {} mm if in {}"},
    {Saying::kIfInUnitStrips, "{} x {} x {} mm if in {} ({} strips at least)"},
    {Saying::kAnd, "{}, {}"},

    {Saying::kSolidAlongY,
     "the design is a closed solid, and most of it faces along y: its upper faces alone"},
    {Saying::kSolidUpperFaces, "the design is a closed solid: its upper faces alone"},
    {Saying::kSolidFaces, "the design is a closed solid: its faces towards {} alone"},
    {Saying::kFacesAlongY, "most of the design faces along y: {} may be up in it"},
    {Saying::kStandsUpright, "the surface stands upright"},
    {Saying::kLeansNowhere, "the surface leans neither up nor down"},
    {Saying::kPlanesGiven, "the planes that were given: others may do"},
    {Saying::kOtherRibs, "what the cut deviates by; with another tolerance other ribs are chosen"},
    {Saying::kShareOfWeight, "weight may use up a share of the tolerance"},
    {Saying::kMayStayUncut, "the share of the design that no strip reaches: only if it may stay uncut"},
    {Saying::kThinnerBlade,
     "the smallest radius goes with the thickness of the blade; a thinner blade is held less firmly"},
    {Saying::kSlowestPoint, "the slowest point of the blade; slower foam melts wider, which is not modelled"},
    {Saying::kTimeOfCut, "the time of the cut"},
    {Saying::kBlockHigher, "the block stands higher, and with it the clamps"},
    {Saying::kEdgeOfBlock, "the edge of the block this strip needs"},
    {Saying::kOneMoreLength,
     "one more length: clamps stay clear of the block; a blade that bends away needs more"},
    {Saying::kSmallestTried, "{} passes, {} does not"},
    {Saying::kWithout, "without {}"},
    {Saying::kAlso, "{}; {}"},

    {Saying::kSnapsBetween,
     "snaps and bending by verify between every sixteenth waypoint; the plan checks every pose"},
    {Saying::kClampsInDeviation,
     "errors of the clamps in the measured deviation: they have a line in the budget, and an amber verdict "
     "says what they may be"},
    {Saying::kMeltOfHeld, "melt-back of a held blade"},
    {Saying::kMeltOfSlow, "melt-back of a slow or held blade"},
    {Saying::kHotSteel,
     "how much softer hot steel hangs than the blade that is measured: a fifth of its sag stands in the "
     "budget"},
    {Saying::kArmsNotLookedAt, "arm reach and arm collision"},
    {Saying::kThermal, "thermal spring-back"},
    {Saying::kPlinthAside, "plinth outside the kept side"},
    {Saying::kJerkUnlimited, "jerk of the clamps"},
    {Saying::kJerkOfHolds, "jerk of the clamps in the ramps of a hold"},
    {Saying::kShapelessLinks, "collisions of links that have no shape, of arm {}: {}"},
    {Saying::kShapelessTool, "collisions of the tool of arm {}, which has no shape"},
    {Saying::kArmsBeyond, "the arms' approach from park, cables, load and torque"},
});

constexpr bool in_order() {
  for (std::size_t i = 0; i < kSayings.size(); ++i) {
    if (static_cast<std::size_t>(kSayings[i].saying) != i) return false;
  }
  return true;
}
static_assert(in_order() && kSayings.back().saying == Saying::kArmsBeyond,
              "kSayings has one entry for each Saying, in its order");

}  // namespace

std::span<const SayingInfo> sayings() {
  return kSayings;
}

std::string say(Saying saying, std::initializer_list<SaidValue> values) {
  fmt::dynamic_format_arg_store<fmt::format_context> store;
  for (const SaidValue& value : values)
    std::visit([&](const auto& held) { store.push_back(held); }, value.value());
  try {
    return fmt::vformat(kSayings[static_cast<std::size_t>(saying)].english, store);
  } catch (const fmt::format_error& error) {
    throw std::logic_error("the values of a saying do not go into it: " + std::string(error.what()));
  }
}

}  // namespace hotblade::pipeline

#include "robot/blade/blade_check.hpp"

#include "robot/blade/blade_section.hpp"
#include "robot/blade/common_plane.hpp"
#include "robot/pose/motion.hpp"

namespace hotblade::robot {

namespace {

BladeLimits limits_of(const ClampedBlade& blade, const BladeCheckOptions& options) {
  return {max_curvature_per_mm(blade, options.safety), options.min_margin, kMaxOffPlane_mm,
          kRegisterRounding_mm};
}

}  // namespace

BladeCheck::BladeCheck(const ClampedBlade& blade, const BladeCheckOptions& options)
    : on_(options.equilibrium),
      branch_(blade.length_mm, limits_of(blade, options)),
      offsets_(options.offsets) {}

Limit BladeCheck::next(const Waypoint& w) {
  if (!on_) return Limit::kNone;
  if (started_) {
    constexpr double kHalfway = 0.5;
    const Limit between = move_to(interpolate(last_, {w.a, w.b}, kHalfway));
    if (between != Limit::kNone) return between;
  }
  started_ = true;
  last_ = {w.a, w.b};
  return move_to(last_);
}

Limit BladeCheck::move_to(const ClampPoses& clamps) {
  if (!on_) return Limit::kNone;
  const ClampPoses holding = held(clamps, offsets_);
  return branch_.move_to(holding.a, holding.b).limit;
}

std::optional<elastica::Elastica> BladeCheck::shape() const {
  if (!on_ || branch_.lost() || branch_.shape().length <= 0) return std::nullopt;
  return branch_.shape();
}

std::optional<BladeMargins> BladeCheck::margins() {
  if (!shape()) return std::nullopt;
  return BladeMargins{branch_.exact_margin(), branch_.largest_curvature_per_mm()};
}

}  // namespace hotblade::robot

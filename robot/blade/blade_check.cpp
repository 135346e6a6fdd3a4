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
    const Limit between = move_to(interpolate(last_a_, w.a, kHalfway), interpolate(last_b_, w.b, kHalfway));
    if (between != Limit::kNone) return between;
  }
  started_ = true;
  last_a_ = w.a;
  last_b_ = w.b;
  return move_to(w.a, w.b);
}

Limit BladeCheck::move_to(const Pose& a, const Pose& b) {
  if (!on_) return Limit::kNone;
  return branch_.move_to(held(a, offsets_.a), held(b, offsets_.b)).limit;
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

// The way back: from where a strip's blade ends, around the stock, to where it started.
//
// Seen along the ribs, a blade is a point and the stock a rectangle, grown by as much as the blade hangs
// below its middle and rounded at the corner by the clearance. The blade's middle goes back on a quadratic
// Bezier of least length that touches that circle from outside (elastica/quadratic/quadratic_tangent.hpp). In
// a fan the blade turns back with the planes; offset and height then stand for the way, and the corner is
// raised until the blade, measured in space, is clear.
#pragma once

#include <optional>

#include "pipeline/plan/motion/blade_path.hpp"

namespace hotblade::pipeline {

// Returns a stretch that carries the blade, bent as in `from`, to the place of `home`; both are flat arcs in
// air, `from` behind the block and clear of it on the waste side, `home` before it. Returns nothing where no
// such way keeps the whole blade clear of the stock by settings.stock.clearance_mm.
[[nodiscard]] std::optional<Stretch> travel_home(const StripPlan& strip, const BladeShape& from,
                                                 const BladeShape& home, const Settings& settings);

// Returns true only where the blade, its width across the plane included, stays `clearance_mm` away from the
// block; false where it does not, and where it does by less than 1 mm.
[[nodiscard]] bool is_clear(const elastica::Elastica& blade, const Frame& frame, const Block& block,
                            double width_mm, double clearance_mm);

}  // namespace hotblade::pipeline

#include "pipeline/plan/sweep/sweep_turning.hpp"

#include <Eigen/Geometry>
#include <utility>

namespace hotblade::pipeline {

Layout PlaneTurning::turned(const Layout& from) const {
  Layout best = layouts_.fitted(from.planes, from.named, from.grid, close_effort(), &from);
  return best.cost_mm <= settings_.design.tolerance_mm ? best : turned_on(best);
}

Layout PlaneTurning::turned_on(Layout best) const {
  constexpr std::size_t kFew = 4;
  if (!(best.cost_mm < kHopeless_mm) || settings_.slice.direction || best.planes.turns() ||
      best.parts.size() > kFew)
    return best;
  constexpr int kLooks = 8, kWorse = 3;
  // A tenth of a degree moves no cut by what could be measured. Sections meet other samples in other
  // planes, which moves the largest distance by some percent: less is no help.
  constexpr double kLeast_rad = 2e-3, kHelps = 0.98;
  double most_rad = 0.15;  // that the fit's terms may be trusted for
  int worse = 0;
  for (int look = 0; look < kLooks && worse < kWorse; ++look) {
    const Eigen::Vector2d turn = turn_of(best, most_rad);
    if (!(turn.norm() >= kLeast_rad)) break;
    const RibAxes middle = layouts_.axes(best.planes);
    const Eigen::Vector3d n = (middle.sweep - turn.x() * middle.y + turn.y() * middle.x).normalized();
    // Once more, as surface::parallel_about() does: to the last bit the same planes.
    Layout other = layouts_.fitted(surface::PlaneFamily::parallel(n.normalized(), best.planes.centre()),
                                   best.named, best.grid, close_effort(), &best);
    const bool nearer = other.cost_mm < best.cost_mm, helps = other.cost_mm < kHelps * best.cost_mm;
    if (nearer) best = std::move(other);
    if (helps) continue;
    ++worse;
    if (!nearer) most_rad = 0.4 * turn.norm();
  }
  best.turned = true;
  return best;
}

}  // namespace hotblade::pipeline

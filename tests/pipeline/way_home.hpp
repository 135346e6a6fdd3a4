// The way home of a blade, measured by other code than the planner's.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

#include "elastica/curve/elastica.hpp"
#include "pipeline/program/program.hpp"

namespace hotblade::pipeline::testing {

// Clamps between two waypoints as the controller moves them.
inline Pose between(const Pose& p, const Pose& q, double u) {
  return {(1 - u) * p.p + u * q.p, p.q.slerp(u, q.q)};
}

struct Travelled {
  double seconds = 0, clearance_mm = 1e9;
  double bent_mm = 0, chords_mm = 0;  // of a rigid motion: what its chords alone may come to
};

// The whole blade on its way, by points seen from clamp A: the blade keeps its shape. Distances to the stock
// by Eigen's box.
inline Travelled measured_way_home(const Strip& strip, double width_mm) {
  Travelled found;
  const Frame& f = strip.block.frame;
  Eigen::Matrix3d axes;
  axes << f.x, f.y, f.normal();
  const Eigen::AlignedBox3d box(Eigen::Vector3d::Zero(), strip.block.size_mm);
  std::vector<Eigen::Vector3d> seen;  // from clamp A
  for (std::size_t i = 1; i < strip.poses.size(); ++i) {
    const BladePose &p = strip.poses[i - 1], &q = strip.poses[i];
    if (q.phase != StripPhase::kTravel) continue;
    found.seconds += q.t - p.t;
    const double turn = p.a.q().angularDistance(q.a.q());
    found.chords_mm = std::max(found.chords_mm, turn * turn / 8 * strip.blade_length_mm);
    if (seen.empty()) {
      for (const auto& point : elastica::sample(p.blade, 1000)) {
        for (const double side : {-0.5, 0.5}) {
          const Eigen::Vector3d at = p.frame.point(point.x, point.y) + side * width_mm * p.frame.normal();
          seen.push_back(p.a.q().conjugate() * (at - p.a.p));
        }
      }
    }
    for (const double u : {0.25, 0.5, 0.75, 1.0}) {
      const Pose a = between(p.a, q.a, u), b = between(p.b, q.b, u);
      const Eigen::Vector3d end = 0.5 * (seen.end()[-1] + seen.end()[-2]);
      found.bent_mm = std::max(found.bent_mm, (a.p + a.q * end - b.p).norm());
      for (const Eigen::Vector3d& s : seen) {
        const Eigen::Vector3d local = axes.transpose() * (a.p + a.q * s - f.origin);
        found.clearance_mm = std::min(found.clearance_mm, box.exteriorDistance(local));
      }
    }
  }
  return found;
}

}  // namespace hotblade::pipeline::testing

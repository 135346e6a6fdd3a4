// A short, valid motion for the tests: a flat arc sinks, turns and bends, and comes back to rest.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "robot/wire/job.hpp"

namespace hotblade::robot::testing {

inline constexpr double kBladeLength_mm = 800;
inline ClampedBlade sample_blade() {
  return {{8, 0.5, 190000, 1010}, kBladeLength_mm};
}

// Clamps of a circular arc with end tangents +-u to the chord, turned by `yaw` about the cell's z axis.
inline Waypoint arc_waypoint(std::uint32_t t_us, const Eigen::Vector3d& middle, double u, double yaw,
                             bool heat) {
  const double chord = kBladeLength_mm * std::sin(u) / u;
  const auto turn = [](double angle) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
  };
  const Eigen::Vector3d half = turn(yaw) * Eigen::Vector3d(chord / 2, 0, 0);
  return {t_us, heat, {middle - half, turn(yaw + u)}, {middle + half, turn(yaw - u)}};
}

// n waypoints, dt_us apart; heat in the middle half. Peak speed below 60 mm/s for n * dt above 5 s.
inline std::vector<Waypoint> sample_waypoints(std::size_t n, std::uint32_t dt_us = 50000) {
  std::vector<Waypoint> waypoints;
  for (std::size_t k = 0; k < n; ++k) {
    const double share = n > 1 ? static_cast<double>(k) / static_cast<double>(n - 1) : 0;
    // At rest at both ends, there and back.
    const double s = (1 - std::cos(2 * std::numbers::pi * share)) / 2;
    const Eigen::Vector3d middle(20 * s, 10 * s, 900 - 60 * s);
    waypoints.push_back(arc_waypoint(static_cast<std::uint32_t>(k) * dt_us, middle, 0.12 + 0.3 * s, 0.2 * s,
                                     share > 0.25 && share < 0.75));
  }
  return waypoints;
}

// An arch whose ends close in and whose end tangents are then turned down: it holds for a while and snaps to
// the other side between two waypoints, well inside every limit of the machine.
inline std::vector<Waypoint> snapping_waypoints() {
  const auto eased = [](double share) {
    return (1 - std::cos(std::numbers::pi * std::clamp(share, 0.0, 1.0))) / 2;
  };
  std::vector<Waypoint> waypoints;
  for (std::uint32_t k = 0; k <= 500; ++k) {
    const double t = 0.05 * k;
    Waypoint w = arc_waypoint(50000 * k, {0, 0, 900}, 0.13, 0, false);
    const auto turn = [&](double angle) {
      return Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
    };
    w.a.p.x() += 48 * eased(t / 8);
    w.b.p.x() -= 48 * eased(t / 8);
    w.a.q = turn(0.13 - 1.4 * eased((t - 8) / 17));
    w.b.q = turn(-0.13 + 1.4 * eased((t - 8) / 17));
    waypoints.push_back(w);
  }
  return waypoints;
}

inline Job sample_job(std::size_t n, const std::string& strip = "S001", std::uint32_t dt_us = 50000) {
  return make_job(sha256({}), strip, sample_waypoints(n, dt_us), sample_blade());
}

}  // namespace hotblade::robot::testing

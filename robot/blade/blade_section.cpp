#include "robot/blade/blade_section.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "elastica/blade/blade_batch.hpp"

namespace hotblade::robot {

namespace {

// Nodes of elastica/blade/gravity.hpp that cover [s0, s1].
struct NodeRange {
  std::size_t first = 0, last = 0;
};

NodeRange nodes(double length, double s0, double s1) {
  const double cells = elastica::kGravityCells;
  const double first = std::clamp(std::floor(s0 / length * cells), 0.0, cells);
  const double last = std::clamp(std::ceil(s1 / length * cells), first, cells);
  return {static_cast<std::size_t>(first), static_cast<std::size_t>(last)};
}

// Level planes carry no weight in the plane; rounding of a frame's axes is not worth a solve.
constexpr double kLevel = 1e-9;

}  // namespace

double bending_stiffness_n_mm2(const BladeSection& s) {
  return s.youngs_modulus_mpa * s.width_mm * std::pow(s.thickness_mm, 3) / 12;
}

double bending_stiffness_n_mm2(const Blade& blade) {
  return (1 + blade.stiffness_error) * bending_stiffness_n_mm2(static_cast<const BladeSection&>(blade));
}

elastica::StiffnessRatios stiffness_ratios(const Blade& s) {
  const double r = s.thickness_mm / s.width_mm;
  const double shape = 1 - 0.63 * r * (1 - std::pow(r, 4) / 12);
  // G J / B = E / (2 (1 + nu)) w t^3 / 3 / (E w t^3 / 12).
  return {1 / (r * r), 2 / (1 + s.poisson_ratio) * shape};
}

double weight_n_mm(const Blade& s) {
  constexpr double kCubicMetrePerMm3 = 1e-9;
  return s.density_kg_m3 * kCubicMetrePerMm3 * s.width_mm * s.thickness_mm * kGravity_m_s2;
}

double max_curvature_per_mm(const BladeSection& s, double safety) {
  return 2 * s.yield_strength_mpa / (safety * s.youngs_modulus_mpa * s.thickness_mm);
}

double max_curvature_per_mm(const Blade& blade) {
  return max_curvature_per_mm(blade, blade.safety);
}

BladeLoads blade_loads(const elastica::Elastica& blade, const BladeSection& section) {
  const elastica::ElasticaCurve curve(blade);
  return blade_loads(blade, curve.at(blade.length).kappa, curve.max_abs_curvature(), section);
}

BladeLoads blade_loads(const elastica::Elastica& blade, double end_per_mm, double sharpest_per_mm,
                       const BladeSection& section) {
  const double stiffness = bending_stiffness_n_mm2(section);
  BladeLoads loads;
  // B theta'' = F x tangent for a blade that clamp B pushes with F.
  loads.force_n = -stiffness * Eigen::Vector2d(blade.lambda1, blade.lambda2);
  loads.moment_a_n_mm = stiffness * blade.kappa;
  loads.moment_b_n_mm = stiffness * end_per_mm;
  loads.stress_mpa = section.youngs_modulus_mpa * section.thickness_mm / 2 * sharpest_per_mm;
  loads.smallest_radius_mm =
      sharpest_per_mm > 0 ? 1 / sharpest_per_mm : std::numeric_limits<double>::infinity();
  return loads;
}

BladeLoads blade_loads(const elastica::Elastica& blade, double end_per_mm, double sharpest_per_mm,
                       const Blade& with) {
  BladeLoads loads = blade_loads(blade, end_per_mm, sharpest_per_mm, static_cast<const BladeSection&>(with));
  loads.force_n *= 1 + with.stiffness_error;
  loads.moment_a_n_mm *= 1 + with.stiffness_error;
  loads.moment_b_n_mm *= 1 + with.stiffness_error;
  return loads;
}

namespace {

// The blades whose planes are not level, and what an even load in them does.
struct LoadedInPlane {
  std::vector<std::size_t> blades;
  std::vector<elastica::PlaneShift> shifts;

  // `load` is the weight over the stiffness; `down` says of a blade where down is in its frame.
  template <typename Down>
  LoadedInPlane(std::span<const elastica::Elastica> shapes, double load, const Down& down) {
    std::vector<elastica::Elastica> bent;
    std::vector<Eigen::Vector2d> loads;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      const Eigen::Vector2d in_plane = down(i).template head<2>();
      if (in_plane.norm() <= kLevel) continue;
      blades.push_back(i);
      bent.push_back(shapes[i]);
      loads.emplace_back(load * in_plane);
    }
    shifts = elastica::plane_shifts(bent, loads);
  }
};

}  // namespace

BladeSag blade_sag(const elastica::Elastica& shape, const Blade& blade, const Eigen::Vector3d& down,
                   double s0, double s1) {
  const SagPlace place{down, s0, s1};
  return blade_sags({&shape, 1}, blade, {&place, 1}).front();
}

std::vector<BladeSag> blade_sags(std::span<const elastica::Elastica> shapes, const Blade& blade,
                                 std::span<const SagPlace> places) {
  if (shapes.size() != places.size()) throw std::logic_error("a sag is asked for at one place of each blade");
  const double load = weight_n_mm(blade) / bending_stiffness_n_mm2(blade);
  std::vector<elastica::DroopLoad> loads;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const SagPlace& place = places[i];
    if (!(place.s0 <= place.s1))
      throw std::logic_error("the part of a blade that sags ends before it starts");
    const NodeRange range = nodes(shapes[i].length, place.s0, place.s1);
    loads.push_back({load * place.down.z(), range.first, range.last});
  }
  std::vector<elastica::DroopReach> reach(shapes.size());
  elastica::droops(shapes, loads, stiffness_ratios(blade), reach);
  std::vector<BladeSag> sags;
  for (const elastica::DroopReach& r : reach) sags.push_back({r.shift, r.twist, 0, r.stable});
  const LoadedInPlane in_plane(shapes, load, [&](std::size_t i) { return places[i].down; });
  for (std::size_t j = 0; j < in_plane.blades.size(); ++j) {
    const std::size_t i = in_plane.blades[j];
    for (std::size_t k = loads[i].first; k <= loads[i].last; ++k)
      sags[i].in_plane_mm = std::max(sags[i].in_plane_mm, in_plane.shifts[j].shift[k].norm());
  }
  return sags;
}

SagProfile::Value SagProfile::at(double share) const {
  const double place = std::clamp(share, 0.0, 1.0) * elastica::kGravityCells;
  const auto k = std::min(static_cast<std::size_t>(place), std::size_t{elastica::kGravityCells - 1});
  const double t = place - static_cast<double>(k);
  const auto between = [&](const auto& values) { return (1 - t) * values[k] + t * values[k + 1]; };
  return {between(droop_mm), between(twist_rad), between(in_plane_mm)};
}

SagProfile sag_profile(const elastica::Elastica& shape, const Blade& blade, const Eigen::Vector3d& down) {
  return sag_profiles({&shape, 1}, blade, {&down, 1}).front();
}

std::vector<SagProfile> sag_profiles(std::span<const elastica::Elastica> shapes, const Blade& blade,
                                     std::span<const Eigen::Vector3d> down) {
  if (shapes.size() != down.size())
    throw std::logic_error("a blade's profile is asked for under one gravity of each");
  const double load = weight_n_mm(blade) / bending_stiffness_n_mm2(blade);
  std::vector<double> loads;
  for (const Eigen::Vector3d& d : down) loads.push_back(load * d.z());
  std::vector<elastica::Droop> droops = elastica::droop_profiles(shapes, loads, stiffness_ratios(blade));
  std::vector<SagProfile> profiles;
  for (elastica::Droop& droop : droops) {
    std::vector<Eigen::Vector2d> none(droop.shift.size(), Eigen::Vector2d::Zero());
    profiles.push_back({std::move(droop.shift), std::move(droop.twist), std::move(none), droop.stable});
  }
  LoadedInPlane in_plane(shapes, load, [&](std::size_t i) { return down[i]; });
  for (std::size_t j = 0; j < in_plane.blades.size(); ++j)
    profiles[in_plane.blades[j]].in_plane_mm = std::move(in_plane.shifts[j].shift);
  return profiles;
}

}  // namespace hotblade::robot

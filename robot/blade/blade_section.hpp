// What bending loads the blade with, and how it hangs, from its section and material. N, mm, MPa, rad.
#pragma once

#include <span>
#include <vector>

#include "elastica/blade/gravity.hpp"
#include "elastica/curve/elastica.hpp"
#include "robot/blade/blade.hpp"

namespace hotblade::robot {

inline constexpr double kGravity_m_s2 = 9.80665;

// Returns B = E width thickness^3 / 12, the stiffness against bending in the plane, N mm^2.
[[nodiscard]] double bending_stiffness_n_mm2(const BladeSection& section);
// Returns the same with what the blade is stiffer by.
[[nodiscard]] double bending_stiffness_n_mm2(const Blade& blade);

// Returns the stiffness against upright bending and torsion over B. Upright bending: (width / thickness)^2.
// Torsion: G J with G = E / (2 (1 + nu)) and Saint-Venant's
// J = width thickness^3 / 3 (1 - 0.63 r (1 - r^4 / 12)), r = thickness / width <= 1 (Timoshenko and Goodier,
// Theory of Elasticity, art. 109: within 0.5 %).
[[nodiscard]] elastica::StiffnessRatios stiffness_ratios(const Blade& blade);

// Returns the blade's weight per length, N/mm.
[[nodiscard]] double weight_n_mm(const Blade& blade);

// Returns the largest curvature at which the bending stress E thickness / 2 |kappa| stays below yield /
// safety, 1/mm.
[[nodiscard]] double max_curvature_per_mm(const BladeSection& section, double safety);
[[nodiscard]] double max_curvature_per_mm(const Blade& blade);

// What the clamps hold and what the blade bears. The force is the same all along an elastica: clamp B pushes
// the blade with `force_n`, clamp A with its opposite. Moments turn the blade's end about the plane's normal,
// counted as B kappa: the moment in the blade there.
struct BladeLoads {
  Eigen::Vector2d force_n{0, 0};  // on the blade at clamp B, in the elastica's axes
  double moment_a_n_mm = 0, moment_b_n_mm = 0;
  double stress_mpa = 0;          // largest bending stress anywhere on the blade
  double smallest_radius_mm = 0;  // infinity for a straight blade
};
[[nodiscard]] BladeLoads blade_loads(const elastica::Elastica& blade, const BladeSection& section);
// Returns the same where the curvature at clamp B and the largest |curvature| are known.
[[nodiscard]] BladeLoads blade_loads(const elastica::Elastica& blade, double end_per_mm,
                                     double sharpest_per_mm, const BladeSection& section);
// Returns the same with what the blade is stiffer by: its force and moments grow with that. Its stress does
// not: how much of it is the modulus and how much the thickness is not known.
[[nodiscard]] BladeLoads blade_loads(const elastica::Elastica& blade, double end_per_mm,
                                     double sharpest_per_mm, const Blade& with);

// How far weight moves the clamped blade, to first order (elastica/blade/gravity.hpp).
struct BladeSag {
  double droop_mm = 0;     // largest shift out of the plane over [s0, s1]
  double twist_rad = 0;    // largest rotation of the section about the tangent there
  double in_plane_mm = 0;  // largest shift in the plane there
  bool stable = true;      // false: the blade tips out of its plane
};
// `down` is the unit vector of gravity in the elastica's axes and the plane's normal; s0 <= s1 are arc
// lengths, mm.
[[nodiscard]] BladeSag blade_sag(const elastica::Elastica& shape, const Blade& blade,
                                 const Eigen::Vector3d& down, double s0, double s1);

// Where and under what gravity a blade's sag is asked for, as above.
struct SagPlace {
  Eigen::Vector3d down{0, 0, -1};
  double s0 = 0, s1 = 0;
};
// Returns blade_sag of many shapes at once (elastica/blade/blade_batch.hpp), to 1e-9 of its size. Throws
// std::logic_error unless there is one place for each shape.
[[nodiscard]] std::vector<BladeSag> blade_sags(std::span<const elastica::Elastica> shapes, const Blade& blade,
                                               std::span<const SagPlace> places);

// Share of a sag that is not known beforehand. The modulus of spring steel falls by a tenth at 300 degrees
// and a fifth at 450, and 2 % of thickness are 6 % of stiffness.
inline constexpr double kSagUnknownShare = 0.2;

// The same at elastica::kGravityCells + 1 evenly spaced points of the whole blade: how a blade hangs.
struct SagProfile {
  std::vector<double> droop_mm;  // along the plane's normal, x cross y
  std::vector<double> twist_rad;
  std::vector<Eigen::Vector2d> in_plane_mm;  // on the elastica's axes
  bool stable = true;                        // false: the profile means nothing

  struct Value {
    double droop_mm = 0, twist_rad = 0;
    Eigen::Vector2d in_plane_mm{0, 0};
  };
  // Between the points linearly; `share` of the length, clamped to [0, 1].
  [[nodiscard]] Value at(double share) const;
};
[[nodiscard]] SagProfile sag_profile(const elastica::Elastica& shape, const Blade& blade,
                                     const Eigen::Vector3d& down);
// Returns those of many shapes at once. Throws std::logic_error unless there is one direction for each.
[[nodiscard]] std::vector<SagProfile> sag_profiles(std::span<const elastica::Elastica> shapes,
                                                   const Blade& blade, std::span<const Eigen::Vector3d> down);

}  // namespace hotblade::robot

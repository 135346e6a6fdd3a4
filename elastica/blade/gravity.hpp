// What weight does to a clamped blade, to first order: the change of its shape in its plane, and the droop
// and twist out of it.
//
// Both solve the second variation of the blade's energy for the load, with the clamps held. In the plane
// that equation is H u = f of elastica/blade/stability.hpp. Out of the plane a curved blade bends and twists
// together: for small rotations phi about the tangent and psi about the in-plane normal of an inextensible
// Kirchhoff rod that is straight when unloaded (w' = -psi, w the shift along the plane's normal),
//   Int C v^2 + A u^2 + kappa (psi v - phi u) + kappa' phi psi - (lambda1 cos theta + lambda2 sin theta)
//   psi^2 ds, twist v = phi' - kappa psi,  bending out of the plane u = psi' + kappa phi,
// in units of the stiffness B in the plane: C torsion / B, A upright bending / B. The terms without C and A
// are the work of the blade's own moment and force (our derivation; docs/elastica.md).
//
// Loads are weight per length over B, 1/length^3. Second-order finite elements on 256 cells: the relative
// error is about 1e-4 for blades that turn by less than two turns.
#pragma once

#include <span>
#include <vector>

#include "elastica/curve/elastica.hpp"

namespace hotblade::elastica {

inline constexpr int kGravityCells = 256;

// The stiffnesses of the section over its bending stiffness in the plane.
struct StiffnessRatios {
  double upright = 0;  // bending out of the plane
  double torsion = 0;
};

// The shift in the plane at kGravityCells + 1 evenly spaced points; unit of the elastica.
struct PlaneShift {
  std::vector<Eigen::Vector2d> shift;
  double largest = 0;
};

// A blade at the middles of its kGravityCells cells, and at its own middle.
struct CellMiddles {
  double turn = 0;                    // direction of the tangent at the blade's middle, rad
  std::span<const double> cos, sin;   // of the tangent, by cell
  std::span<const double> curvature;  // signed, by cell; 1/unit of the elastica
};

// The change of the shape under an even load in its plane. Throws std::logic_error when the load or the
// elastica is not finite. The answer means nothing when the shape is not stable.
[[nodiscard]] PlaneShift plane_shift(const Elastica& elastica, const Eigen::Vector2d& load);
// The same with the elastica's middles at hand; throws std::logic_error too unless there is one a cell.
[[nodiscard]] PlaneShift plane_shift(const Elastica& elastica, const Eigen::Vector2d& load,
                                     const CellMiddles& middles);

// The shift and twist out of the plane at kGravityCells + 1 evenly spaced points.
struct Droop {
  std::vector<double> shift;  // along the plane's normal, x cross y
  std::vector<double> twist;  // rotation about the tangent, rad
  double largest = 0, largest_twist = 0;
  bool stable = false;  // false: the blade tips out of its plane by itself, and the shift means nothing
};

// The droop under an even load along the plane's normal. Throws as plane_shift does, and when a ratio is not
// positive.
[[nodiscard]] Droop droop(const Elastica& elastica, double load, const StiffnessRatios& ratios);

// Turns of the section at both ends against the blade's plane, rad: `phi` about the tangent, `psi` about the
// in-plane normal (w' = -psi, w the shift along the plane's normal).
struct EndTurns {
  double phi_a = 0, psi_a = 0, phi_b = 0, psi_b = 0;
};

// Returns the shift and twist out of the plane of a weightless blade whose ends stay where they are and are
// turned, to first order in the turns. Throws as droop does.
[[nodiscard]] Droop turned_ends(const Elastica& elastica, const EndTurns& turns,
                                const StiffnessRatios& ratios);

// The smallest eigenvalue of the form above times length^2: how far the blade is from tipping out of its
// plane.
[[nodiscard]] double lateral_margin(const Elastica& elastica, const StiffnessRatios& ratios);

}  // namespace hotblade::elastica

// Where a stable blade ends: the folds of a blade of length 1.
//
// A pressed blade swings about the direction of its end force. By the force's angle `alpha` to the start
// tangent and the start curvature `kappa` as polar coordinates, alpha = size cos(phase) and kappa =
// kBendRate size sin(phase), a shape is stable between clamps up to one force, at which it folds; shallow
// ones by their phase alone, whatever their size (docs/elastica.md, Clamp errors).
#pragma once

#include <Eigen/Core>
#include <optional>

#include "elastica/blade/end_map.hpp"
#include "elastica/curve/elastica.hpp"

namespace hotblade::elastica {

// Curvature per angle: a root of the forces between those at which a clamped column buckles, 4 pi^2 to 8.18
// pi^2.
inline constexpr double kBendRate = 7;

// A blade of length 1 that starts at the origin along x.
struct PressedBlade {
  double size = 0, phase = 0;  // rad; a negative size is the mirrored shape
  double force = 0;            // over EI / length^2

  [[nodiscard]] Elastica elastica() const;
  // Of the same shape, wherever it stands; size and force are positive.
  [[nodiscard]] static PressedBlade of(const Elastica& elastica);
  // (alpha, kappa / kBendRate), rad.
  [[nodiscard]] Eigen::Vector2d bend() const;
  // Derivatives of (kappa, lambda1, lambda2) by (size, phase, force).
  [[nodiscard]] Eigen::Matrix3d slopes() const;
};

// Vanishes at folds of a blade of length 1: the determinant of its end's fields, over what it loses where the
// blade becomes a line and its end cannot move along it.
[[nodiscard]] double fold_value(const JacobiFields& end);

struct TabledFold {
  PressedBlade blade;  // of positive size, the phase in [0, pi)
  CurvePoint end;
};

// Where folds of two shapes meet: of shapes alike from both ends, which may leave that to either side. Seen
// from the space of clamps folds have an edge there.
enum class FoldEdge {
  kTangents,    // theta(s) = theta(1 - s): those of phase 0
  kCurvatures,  // kappa(s) = kappa(1 - s): arches
};

// The fold of one size and phase, its force near a guess and to a part of itself; nothing where none is.
// `slope` is a guess of fold_value()'s by the force, 0 for none, and what it is.
[[nodiscard]] std::optional<TabledFold> fold_at(double size, double phase, double force,
                                                double exactness = 1e-9, double* slope = nullptr);

// The one at an edge, near a guess of its phase and force.
[[nodiscard]] std::optional<TabledFold> edge_at(FoldEdge edge, double size, double phase, double force);

}  // namespace hotblade::elastica

// Where stable blades end, for all of them at once: the folds of a blade of length 1.
//
// A pressed blade swings about the direction of its end force. By the force's angle `alpha` to the start
// tangent and the start curvature `kappa` as polar coordinates, alpha = size cos(phase) and kappa =
// kBendRate size sin(phase), a shape is stable between clamps up to one force, at which it folds; shallow
// ones by their phase alone, whatever their size (docs/elastica.md, Clamp errors).
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

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

// Folds by rows of one size and columns of one phase, from 0 to pi. Each is computed at its first call, the
// shallow ones in 8 ms, the deep ones in 25.
class FoldTable {
 public:
  // Sizes up to 2, one fold in each cell.
  [[nodiscard]] static const FoldTable& shallow();
  // Sizes from 2.06 to 2.62, where forces of some shapes are stable again beyond those that are not; forces
  // from 41 to 161.
  [[nodiscard]] static const FoldTable& deep();
  static constexpr double kLongestDeepChord = 0.65;  // of those

  [[nodiscard]] int sizes() const { return static_cast<int>(cells_.size()) / phases_; }
  [[nodiscard]] int phases() const { return phases_; }
  [[nodiscard]] std::span<const TabledFold> at(int size, int phase) const {
    return cells_[static_cast<std::size_t>(size) * static_cast<std::size_t>(phases_) +
                  static_cast<std::size_t>(phase)];
  }
  // Of each size, of the shallow ones.
  [[nodiscard]] const std::vector<TabledFold>& edge(FoldEdge edge) const {
    return edges_[static_cast<std::size_t>(edge)];
  }

 private:
  int phases_ = 0;
  std::vector<std::vector<TabledFold>> cells_;
  std::array<std::vector<TabledFold>, 2> edges_;
};

}  // namespace hotblade::elastica

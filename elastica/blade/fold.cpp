#include "elastica/blade/fold.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>

#include "elastica/blade/end_map.hpp"
#include "elastica/curve/placement.hpp"

namespace hotblade::elastica {

namespace {

bool stable(const PressedBlade& blade) {
  return end_map(blade.elastica(), Exactness::kSearch).index == 0;
}

}  // namespace

double fold_value(const JacobiFields& end) {
  constexpr double kLeast = 1e-12;  // of a blade that is a line but for rounding
  return end.fields.determinant() / std::max(1 - end.point.position().squaredNorm(), kLeast);
}

Elastica PressedBlade::elastica() const {
  const double alpha = size * std::cos(phase), kappa = kBendRate * size * std::sin(phase);
  return {0, 0, 0, kappa, force * std::cos(alpha), force * std::sin(alpha), 1};
}

PressedBlade PressedBlade::of(const Elastica& e) {
  const Eigen::Vector2d force = force_along(e, e.theta) * (e.length * e.length);
  const double alpha = std::atan2(force.y(), force.x()), bend = e.kappa * e.length / kBendRate;
  return {std::hypot(alpha, bend), std::atan2(bend, alpha), force.norm()};
}

Eigen::Vector2d PressedBlade::bend() const {
  return size * Eigen::Vector2d(std::cos(phase), std::sin(phase));
}

Eigen::Matrix3d PressedBlade::slopes() const {
  const double c = std::cos(phase), s = std::sin(phase), alpha = size * c;
  const Eigen::Vector2d along(std::cos(alpha), std::sin(alpha)), across(-along.y(), along.x());
  Eigen::Matrix3d by;
  by << kBendRate * s, kBendRate * size * c, 0,  //
      force * c * across.x(), -force * size * s * across.x(), along.x(), force * c * across.y(),
      -force * size * s * across.y(), along.y();
  return by;
}

std::optional<TabledFold> fold_at(double size, double phase, double force, double exactness, double* slope) {
  // Secants, held between a stable shape and one that is not.
  constexpr int kMostSteps = 40;
  constexpr double kMostForce = 250, kLeastForce = 1, kBeside = 1e-4;
  double low = kLeastForce, high = kMostForce, growth = 0.02;
  double force_before = 0, value_before = 0;
  TabledFold fold{{size, phase, force}, {}};
  for (int i = 0; i < kMostSteps; ++i) {
    const JacobiFields end = end_map(fold.blade.elastica(), Exactness::kSearch);
    const double value = fold_value(end);
    double& here = fold.blade.force;
    (end.index == 0 ? low : high) = here;
    const double along = i > 0 ? (value - value_before) / (here - force_before) : slope ? *slope : 0;
    double next = here - value / along;
    if (std::abs(next - here) <= exactness * here || high - low <= exactness * here) {
      // A shape may become unstable once more, beyond the fold.
      PressedBlade less = fold.blade;
      less.force *= 1 - kBeside;
      if (low == kLeastForce && !stable(less)) return {};
      if (slope) *slope = along;
      fold.end = end.point;
      return fold;
    }
    if (!(next > low && next < high)) {
      next = high == kMostForce   ? here * (1 + growth)
             : low == kLeastForce ? here * (1 - growth)
                                  : 0.5 * (low + high);
      growth *= 2;
    }
    if (!(next > kLeastForce && next < kMostForce)) return {};
    force_before = here;
    value_before = value;
    here = next;
  }
  return {};
}

std::optional<TabledFold> edge_at(FoldEdge edge, double size, double phase, double force) {
  if (edge == FoldEdge::kTangents) return fold_at(size, 0, force);
  constexpr int kMostSteps = 12;
  constexpr double kFirst = 1e-3, kOn = 1e-7;
  auto fold = fold_at(size, phase, force);
  double before = 0, odd_before = 0;
  for (int i = 0; fold && i < kMostSteps; ++i) {
    // Over the size: curvatures of shallow shapes are as small.
    const double odd = fold->end.kappa / size - kBendRate * std::sin(phase);
    const double next = i == 0 ? phase + kFirst : phase - odd * (phase - before) / (odd - odd_before);
    if (std::abs(next - phase) <= kOn) return fold;
    constexpr double kFar = 0.5;
    if (!(std::abs(next - phase) < kFar)) return {};
    before = phase;
    odd_before = odd;
    phase = next;
    fold = fold_at(size, phase, fold->blade.force);
  }
  return {};
}

}  // namespace hotblade::elastica

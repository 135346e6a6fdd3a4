#include "elastica/blade/fold_table.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "elastica/blade/end_map.hpp"
#include "elastica/curve/placement.hpp"

namespace hotblade::elastica {

namespace {

// Columns are close where the fold's force climbs from a column's first to its second, at phases of 0.06 to
// 0.14 of shallow shapes and somewhat later of deep ones.
std::vector<double> tabled_phases() {
  struct Part {
    double to, step;
  };
  std::vector<double> phases;
  double phase = 0;
  for (const Part& part : {Part{0.045, 0.015}, Part{0.16, 0.0115}, Part{0.7, 0.06}, Part{3.13, 0.2025}}) {
    while (phase < part.to) {
      phases.push_back(phase);
      phase += part.step;
    }
  }
  return phases;
}

constexpr double kLargestShallow = 2;

// Searches start from tabled folds.
constexpr double kTabled = 1e-5;

bool stable(const PressedBlade& blade) {
  return end_map(blade.elastica(), Exactness::kSearch).index == 0;
}

// The fold at a force less than the blade's by a step at most.
TabledFold fold_before(PressedBlade blade, double step) {
  const bool after = stable(blade);
  constexpr int kHalvings = 9;  // to 0.02
  for (int i = 0; i < kHalvings; ++i) {
    step /= 2;
    PressedBlade middle = blade;
    middle.force -= step;
    if (stable(middle) == after) blade = middle;
  }
  return {blade, end_map(blade.elastica(), Exactness::kSearch).point};
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

const FoldTable& FoldTable::shallow() {
  static const FoldTable table = [] {
    constexpr double kRatio = 1.5;
    constexpr int kSizes = 21;  // down to 6e-4: smaller shapes are straight to a blade's thickness
    // Of a straight column between clamps: its first two modes, the second at the root of tan(sqrt(force)/2)
    // = sqrt(force)/2, where an arch has kappa = 2 alpha.
    constexpr double kFirst = 4 * std::numbers::pi * std::numbers::pi, kSecond = 80.7629;
    const std::vector<double> phases = tabled_phases();
    FoldTable all;
    all.phases_ = static_cast<int>(phases.size());
    std::vector<double> guesses(phases.size(), kFirst), slopes(phases.size(), 0.0);
    std::array<PressedBlade, 2> edge{PressedBlade{0, 0, kFirst},
                                     PressedBlade{0, std::atan(2 / kBendRate), kSecond}};
    double size = kLargestShallow / std::pow(kRatio, kSizes - 1);
    for (int i = 0; i < kSizes; ++i, size *= kRatio) {
      for (std::size_t j = 0; j < phases.size(); ++j) {
        const double guess = i == 0 && j > 0 ? guesses[j - 1] : guesses[j];
        const auto fold = fold_at(size, phases[j], guess, kTabled, &slopes[j]);
        all.cells_.emplace_back();
        if (!fold) continue;
        all.cells_.back().push_back(*fold);
        guesses[j] = fold->blade.force;
      }
      for (const FoldEdge kind : {FoldEdge::kTangents, FoldEdge::kCurvatures}) {
        PressedBlade& guess = edge[static_cast<std::size_t>(kind)];
        const auto fold = edge_at(kind, size, guess.phase, guess.force);
        if (!fold) continue;
        all.edges_[static_cast<std::size_t>(kind)].push_back(*fold);
        guess = fold->blade;
      }
    }
    return all;
  }();
  return table;
}

const FoldTable& FoldTable::deep() {
  static const FoldTable table = [] {
    constexpr double kFirst = 2.06, kStep = 0.14, kLeastForce = 41, kMostForce = 161, kForceStep = 8;
    constexpr int kSizes = 5, kForces = static_cast<int>((kMostForce - kLeastForce) / kForceStep);
    const std::vector<double> phases = tabled_phases();
    FoldTable all;
    all.phases_ = static_cast<int>(phases.size());
    for (int i = 0; i < kSizes; ++i) {
      for (const double phase : phases) {
        std::vector<TabledFold>& cell = all.cells_.emplace_back();
        PressedBlade blade{kFirst + kStep * i, phase, 0};
        bool before = false;
        for (int k = 0; k <= kForces; ++k) {
          blade.force = kLeastForce + kForceStep * k;
          const bool here = stable(blade);
          if (k > 0 && here != before) cell.push_back(fold_before(blade, kForceStep));
          before = here;
        }
      }
    }
    return all;
  }();
  return table;
}

}  // namespace hotblade::elastica

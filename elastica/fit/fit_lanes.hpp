// The least-squares problem under every fit, eight at a time: which shape, moved, turned and scaled at its
// best, is nearest to the given points at proportional arc length? Position, angle and length enter linearly
// (a similarity is one complex factor and one complex shift), so they are eliminated exactly and the search
// runs over z = (K, T1, T2) of shape_lanes.hpp alone. Internal to fit.cpp and fit_bezier.cpp.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "elastica/curve/elastica.hpp"
#include "elastica/kernels/simd.hpp"

namespace hotblade::elastica::lanes {

using Shape = std::array<double, 3>;  // K, T1, T2

// The places of the points along the curve, and how much each counts.
struct FitGrid {
  int points = 0;               // evenly spaced by arc length
  int stride = 1;               // integration steps between two of them; (points - 1) * stride is even
  std::vector<double> weights;  // one per point, sum 1

  [[nodiscard]] int steps() const { return (points - 1) * stride; }
};

// The points of one curve, moved so that their weighted mean is the origin and scaled to length 1. The pulls
// are those of FitOptions.
struct FitData {
  const double* x = nullptr;
  const double* y = nullptr;
  const double* cos = nullptr;  // unit tangents, where the curve has them
  const double* sin = nullptr;
  double tension_pull = 0, prior_pull = 0;  // squares of the weights
  Shape prior{};
};

struct FitTask {
  std::size_t data = 0;  // index of its FitData
  Shape z{};             // start, then result
  double cost = 0;       // weighted mean of squared distances, and the pulls; infinite: start not admissible
  int iterations = 0;
  bool converged = false;
};

// Solves every task by Levenberg and Marquardt's method. The result of a task depends on its own data alone,
// not on its company or the instruction set, which must be a supported one.
void solve(const FitGrid& grid, std::span<const FitData> data, std::span<FitTask> tasks,
           Simd simd = best_simd());

// A shape laid onto its points: the state of its middle and of its start in the data's frame.
struct Placed {
  double x = 0, y = 0, theta = 0, length = 0;                         // of the middle
  double start_x = 0, start_y = 0, start_theta = 0, start_kappa = 0;  // kappa times length
  double cost = 0;    // weighted mean of squared distances, without pulls
  double angle2 = 0;  // weighted mean of squared angles between the tangents; 0 where the data has none
};
// The shapes of the tasks laid onto their points, in the tasks' order.
[[nodiscard]] std::vector<Placed> place(const FitGrid& grid, std::span<const FitData> data,
                                        std::span<const FitTask> tasks);

// The elastica of a placed shape whose data was moved by -`origin` and divided by `scale`.
[[nodiscard]] Elastica unit_removed(const Placed& placed, const Shape& z, const Eigen::Vector2d& origin,
                                    double scale);

// More starts for a search whose answer is doubtful: the arc of the mean curvature (times length), and a
// coarse grid over shapes with and without inflections, bent either way.
[[nodiscard]] std::array<Shape, 13> other_starts(double mean_curvature);

// Whether that many steps resolve the shape well enough to search from it, or to be its answer.
[[nodiscard]] bool admissible(const Shape& z, int steps);
[[nodiscard]] bool resolved_finely(const Shape& z, int steps);

}  // namespace hotblade::elastica::lanes

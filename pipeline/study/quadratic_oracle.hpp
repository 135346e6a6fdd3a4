// What the study of quadratic Beziers compares with: quadrature in 34 digits, and dense sampling of the
// loci of tangent curves.
#pragma once

#include <array>
#include <vector>

#include "elastica/quadratic/quadratic_tangent.hpp"
#include "pipeline/study/random_curves.hpp"

namespace hotblade::pipeline::study {

inline constexpr std::array kTriangleKinds{"uniform in a square", "edges log-uniform, nine decades",
                                           "nearly collinear, down to 1e-12", "nearly uniform, down to 1e-12",
                                           "middle near an end, to 1e-12"};

// The random triangle `index` of a seed; its kind is index modulo their number.
[[nodiscard]] elastica::Quadratic random_triangle(std::uint64_t seed, std::uint64_t index);

// The integrals of the curve with exactly these control points, which may not be collinear, by 22-point Gauss
// quadrature on graded panels in 113-bit arithmetic, rounded at the end.
struct QuadraticIntegrals {
  double length = 0, energy = 0;
};
[[nodiscard]] QuadraticIntegrals quadrature(const elastica::Quadratic& curve);

// The kinds of tangency: to the line, and to a circle by the paper's figure 6, a to f.
inline constexpr std::array kTangentKinds{"line",
                                          "circle, outside and outside",
                                          "circle, outside and inside",
                                          "circle, outside and on",
                                          "circle, inside and inside",
                                          "circle, on and inside",
                                          "circle, on and on"};
struct TangentProblem {
  Eigen::Vector2d b0, b2;
  bool circle = false;
  Eigen::Vector2d place;            // on the line, or the centre
  Eigen::Vector2d direction{1, 0};  // of the line
  double radius = 0;
  elastica::Objective objective = elastica::Objective::kLength;
  [[nodiscard]] elastica::TangentCurves solve() const;
  [[nodiscard]] double value(const Eigen::Vector2d& b1) const;
};

// The random problem `index` of a seed; its kind is index modulo 7, and seven lengths and seven energies
// take turns.
[[nodiscard]] TangentProblem random_problem(std::uint64_t seed, std::uint64_t index);

// The middle control point for a contact at angle theta of the circle (equation 6); NaN where there is none.
[[nodiscard]] Eigen::Vector2d locus(const TangentProblem& problem, double theta);

// The local minima among `samples` points of every component of the locus; `step` is how far b1 moves over
// the neighbouring samples.
struct SampledMinimum {
  Eigen::Vector2d b1;
  double value = 0, step = 0;
};
[[nodiscard]] std::vector<SampledMinimum> sampled_minima(const TangentProblem& problem, int samples);

// The error of a curve's tangency where it says that it touches: how far it is off the line or circle, or
// across it, as a share of its size.
[[nodiscard]] double tangency_error(const TangentProblem& problem, const elastica::TangentMinimum& minimum);

}  // namespace hotblade::pipeline::study

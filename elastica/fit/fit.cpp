#include "elastica/fit/fit.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "elastica/curve/placement.hpp"
#include "elastica/curve/taylor.hpp"
#include "elastica/fit/fit_lanes.hpp"
#include "elastica/linear/solve.hpp"

namespace hotblade::elastica {

namespace {

using lanes::Shape;

// No blade winds through more than this between its ends; a start that does is not tried.
constexpr double kMostTurn = 60;
// Coarser steps would bend the descent directions of the fit (shape_lanes.hpp).
constexpr int kLeastSteps = 32;

Shape shape_of(const MidState& m) {
  const double square = m.length * m.length;
  return {m.kappa * m.length, m.tension1 * square, m.tension2 * square};
}

double rate(const Shape& z) {
  return taylor_rate(0, z[0], z[1], z[2]);
}

// The points with their mean, as they count, at the origin, divided by the length of their polyline.
struct Unit {
  std::vector<double> x, y;
  Eigen::Vector2d origin{0, 0};
  double scale = 0;

  Unit(std::span<const Eigen::Vector2d> points, std::span<const double> weights) {
    if (weights.empty()) {
      for (const Eigen::Vector2d& q : points) origin += q;
      origin /= static_cast<double>(points.size());
    }
    for (std::size_t i = 0; i < weights.size(); ++i) origin += weights[i] * points[i];
    for (std::size_t i = 1; i < points.size(); ++i) scale += (points[i] - points[i - 1]).norm();
    if (!(scale > 0) || !std::isfinite(scale)) {
      throw std::logic_error("fit_elastica needs finite points that are not all the same");
    }
    for (const Eigen::Vector2d& q : points) {
      x.push_back((q.x() - origin.x()) / scale);
      y.push_back((q.y() - origin.y()) / scale);
    }
  }
};

// Starts that need no Bezier: curvature by differences, affine in position by least squares, read off at the
// middle; and the circular arc of the mean curvature.
std::array<Shape, 2> own_starts(const Unit& q) {
  const auto n = static_cast<Eigen::Index>(q.x.size());
  const double h = 1.0 / static_cast<double>(n - 1);
  Eigen::MatrixX3d a(n - 2, 3);
  Eigen::VectorXd k(n - 2);
  for (Eigen::Index i = 1; i + 1 < n; ++i) {
    const auto u = static_cast<std::size_t>(i);
    const double x0 = q.x[u] - q.x[u - 1], y0 = q.y[u] - q.y[u - 1];
    const double x1 = q.x[u + 1] - q.x[u], y1 = q.y[u + 1] - q.y[u];
    k[i - 1] = std::atan2(x0 * y1 - y0 * x1, x0 * x1 + y0 * y1) / h;
    a.row(i - 1) << 1, -q.y[u], q.x[u];
  }
  const Eigen::Vector3d v = shortest_solution(a, k);
  const std::size_t middle = q.x.size() / 2;
  const double dx = q.x[middle + 1] - q.x[middle - 1], dy = q.y[middle + 1] - q.y[middle - 1];
  const double norm = std::hypot(dx, dy), c = norm > 0 ? dx / norm : 1, s = norm > 0 ? dy / norm : 0;
  return {Shape{v[0] - v[1] * q.y[middle] + v[2] * q.x[middle], c * v[1] + s * v[2], c * v[2] - s * v[1]},
          Shape{k.mean(), 0, 0}};
}

// Starts as shapes; those too wild to be evaluated are left out.
std::vector<Shape> admissible_starts(const Unit& q, std::span<const Elastica> starts) {
  std::vector<Shape> shapes;
  for (const Elastica& e : starts) {
    if (taylor_rate(e.theta, e.kappa, e.lambda1, e.lambda2) * e.length < kMostTurn) {
      shapes.push_back(shape_of(mid_state(e)));
    }
  }
  for (const Shape& z : own_starts(q)) shapes.push_back(z);
  std::erase_if(shapes, [](const Shape& z) { return !(rate(z) < kMostTurn); });
  return shapes;
}

std::vector<double> weights_of(std::size_t points, const FitOptions& options) {
  if (!options.weights.empty()) return {options.weights.begin(), options.weights.end()};
  return std::vector<double>(points, 1.0 / static_cast<double>(points));
}

// Steps that resolve the wildest of the shapes finely, in an even number.
lanes::FitGrid grid_for(const std::vector<double>& weights, double rate) {
  lanes::FitGrid grid{static_cast<int>(weights.size()), 1, weights};
  while (grid.steps() < kLeastSteps || !lanes::resolved_finely({rate, 0, 0}, grid.steps())) ++grid.stride;
  grid.stride += grid.steps() % 2;
  return grid;
}

// The best answer of a search from every shape, on a grid that resolves it.
lanes::FitTask best_of(const std::vector<Shape>& starts, const lanes::FitData& data, lanes::FitGrid& grid) {
  std::vector<lanes::FitTask> tasks;
  double wildest = 0;
  for (const Shape& z : starts) {
    tasks.push_back({0, z, 0, 0, false});
    wildest = std::max(wildest, rate(z));
  }
  grid = grid_for(grid.weights, wildest);
  lanes::solve(grid, std::span(&data, 1), tasks);
  auto best = *std::min_element(tasks.begin(), tasks.end(),
                                [](const auto& a, const auto& b) { return a.cost < b.cost; });
  // Twice: a search that goes on winding is no blade's.
  for (int i = 0; i < 2 && std::isfinite(best.cost) && !lanes::resolved_finely(best.z, grid.steps()); ++i) {
    grid = grid_for(grid.weights, rate(best.z));
    lanes::solve(grid, std::span(&data, 1), std::span(&best, 1));
  }
  return best;
}

struct FootPoint {
  double distance_sq, s;
};

FootPoint foot_point(const ElasticaCurve& curve, const std::vector<CurvePoint>& samples,
                     const Eigen::Vector2d& q) {
  std::size_t best = 0;
  double best_sq = (samples[0].position() - q).squaredNorm();
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double d = (samples[i].position() - q).squaredNorm();
    if (d < best_sq) {
      best_sq = d;
      best = i;
    }
  }
  const double length = curve.elastica().length;
  double s = length * static_cast<double>(best) / static_cast<double>(samples.size() - 1);
  for (int k = 0; k < 3; ++k) {
    const CurvePoint p = curve.at(s);
    const Eigen::Vector2d r = p.position() - q, t = p.tangent();
    const double df = 1 + p.kappa * (r.y() * t.x() - r.x() * t.y());
    if (!(df > 0)) break;
    const double last = s;
    s = std::clamp(s - r.dot(t) / df, 0.0, length);
    // On the curve itself the distance is off by the whole of what is left.
    constexpr double kSettled = 1e-12;
    if (std::abs(s - last) < kSettled * length) return {std::min(best_sq, r.squaredNorm()), s};
  }
  return {std::min(best_sq, (curve.at(s).position() - q).squaredNorm()), s};
}

}  // namespace

MidState mid_state(const Elastica& e) {
  const CurvePoint p = point_at(e, 0.5 * e.length);
  const Eigen::Vector2d force = force_along(e, p.theta);
  return {p.x, p.y, p.theta, p.kappa, force.x(), force.y(), e.length};
}

Elastica half_from_middle(const MidState& m) {
  const double c = std::cos(m.theta), s = std::sin(m.theta);
  return {
      m.x,           m.y, m.theta, m.kappa, c * m.tension1 - s * m.tension2, s * m.tension1 + c * m.tension2,
      0.5 * m.length};
}

Elastica from_mid_state(const MidState& m) {
  return segment(half_from_middle(m), -0.5 * m.length, 0.5 * m.length);
}

double max_distance(std::span<const Eigen::Vector2d> points, const Elastica& e) {
  const ElasticaCurve curve(e);
  const std::vector<CurvePoint> samples = sample(e, 129);
  double worst = 0;
  for (const Eigen::Vector2d& q : points) {
    const double d = foot_point(curve, samples, q).distance_sq;
    if (!(d <= worst)) worst = d;  // not a number counts as worst
  }
  return std::sqrt(worst);
}

ElasticaFit fit_elastica(std::span<const Eigen::Vector2d> points, std::span<const Elastica> starts,
                         const FitOptions& options) {
  if (points.size() < 8) throw std::logic_error("fit_elastica needs at least 8 points");
  if (!options.weights.empty() && options.weights.size() != points.size()) {
    throw std::logic_error("fit_elastica needs a weight for each point or none");
  }
  const Unit unit(points, options.weights);
  lanes::FitData data;
  data.x = unit.x.data();
  data.y = unit.y.data();
  data.tension_pull = options.tension_weight * options.tension_weight;
  if (options.prior) {
    data.prior = shape_of(*options.prior);
    data.prior_pull = options.prior_weight * options.prior_weight;
  }
  lanes::FitGrid grid{static_cast<int>(points.size()), 1, weights_of(points.size(), options)};
  std::vector<Shape> shapes = admissible_starts(unit, starts);
  if (shapes.empty()) shapes.push_back({0, 0, 0});
  ElasticaFit fit;
  fit.starts_tried = static_cast<int>(shapes.size());
  lanes::FitTask best = best_of(shapes, data, grid);
  // Farther off than a rib that an elastica serves: a wrong minimum, or a curve no elastica follows.
  constexpr double kDoubtful = 1e-3;
  if (!(best.cost < kDoubtful * kDoubtful)) {
    const auto others = lanes::other_starts(0);
    shapes.assign(others.begin() + 1, others.end());  // the arc has been tried
    shapes.push_back(best.z);
    const lanes::FitGrid first = grid;
    const lanes::FitTask second = best_of(shapes, data, grid);
    fit.starts_tried += static_cast<int>(others.size()) - 1;
    if (second.cost < best.cost) {
      best = second;
    } else {
      grid = first;
    }
  }
  const lanes::Placed placed = lanes::place(grid, std::span(&data, 1), std::span(&best, 1)).front();
  fit.elastica = lanes::unit_removed(placed, best.z, unit.origin, unit.scale);
  fit.converged = best.converged;
  fit.rms = std::sqrt(placed.cost) * unit.scale;
  fit.max = max_distance(points, fit.elastica);
  return fit;
}

}  // namespace hotblade::elastica

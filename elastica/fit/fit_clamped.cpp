#include "elastica/fit/fit_clamped.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "elastica/curve/taylor.hpp"
#include "elastica/fit/fit_lanes.hpp"
#include "elastica/fit/shape_lanes.hpp"
#include "elastica/linear/solve.hpp"

namespace hotblade::elastica {

namespace {

using Complex = std::complex<double>;
using lanes::Shape;
using Vector4 = Eigen::Vector4d;  // K, T1, T2 and the logarithm of the length

constexpr int kMostIterations = 100;
constexpr int kUnknowns = 4, kConditions = 3;
// Ends met to this share of the points' length, and to as many radians, are met: rounding of the trace.
constexpr double kMet = 1e-10;

// The task in units of the points' length, the start at the origin in direction (1, 0).
struct Problem {
  std::vector<Complex> points;
  std::vector<double> weights;  // sum 1
  bool clamped_end = false;
  Complex end;
  double turning = 0;
  double tension_pull = 0, prior_pull = 0;
  Shape prior{};
};

// A start's search. The quadratic model: cost + b.v + v.A v / 2; conditions h + J v = 0.
struct Search {
  Vector4 v = Vector4::Zero();
  double cost = std::numeric_limits<double>::infinity(), merit = cost, damping = 1e-3;
  Eigen::Matrix4d a = Eigen::Matrix4d::Zero();
  Vector4 b = Vector4::Zero();
  Eigen::Matrix<double, kConditions, kUnknowns> j = Eigen::Matrix<double, kConditions, kUnknowns>::Zero();
  Eigen::Vector3d h = Eigen::Vector3d::Zero();
  int iterations = 0;
  bool done = false, converged = false;
};

// Turning from the first node to the last; no step of a resolved shape turns by half a circle.
double total_turning(const lanes::ShapeNodes& g, int lane) {
  double sum = 0;
  for (int n = 1; n <= g.steps; ++n) {
    const double c = g.c[n - 1][lane], s = g.s[n - 1][lane], d = g.c[n][lane], t = g.s[n][lane];
    sum += std::atan2(c * t - s * d, c * d + s * t);
  }
  return sum;
}

// Weight of a missed condition in the merit: far above any multiplier of costs around 1e-4.
constexpr double kMissWeight = 1;

// Fills cost, model and conditions of `s` at its v from the traced shape of a lane.
void linearise(const Problem& p, const lanes::FitGrid& grid, const lanes::ShapeNodes& g, int lane,
               Search& s) {
  const double length = std::exp(s.v[3]);
  const Complex start(g.x[0][lane], g.y[0][lane]), i(0, 1);
  const Complex turn = length * Complex(g.c[0][lane], -g.s[0][lane]);  // conjugate: the start's tangent is 1
  std::array<Complex, 3> start_dz;
  for (std::size_t k = 0; k < 3; ++k) start_dz[k] = {g.dx[k][0][lane], g.dy[k][0][lane]};
  s.cost = 0;
  s.a.setZero();
  s.b.setZero();
  Complex at;
  std::array<Complex, kUnknowns> d;
  for (int q = 0; q < grid.points; ++q) {
    const int n = q * grid.stride;
    const Complex rel = Complex(g.x[n][lane], g.y[n][lane]) - start;
    at = turn * rel;
    for (std::size_t k = 0; k < 3; ++k) {
      const Complex moved = Complex(g.dx[k][n][lane], g.dy[k][n][lane]) - start_dz[k];
      d[k] = turn * (moved - i * g.dtheta[k][0][lane] * rel);
    }
    d[3] = at;
    const Complex r = at - p.points[static_cast<std::size_t>(q)];
    const double weight = p.weights[static_cast<std::size_t>(q)];
    s.cost += weight * std::norm(r);
    for (int k = 0; k < kUnknowns; ++k) {
      const Complex dk = weight * std::conj(d[static_cast<std::size_t>(k)]);
      s.b[k] += (dk * r).real();
      for (int l = k; l < kUnknowns; ++l) s.a(k, l) += (dk * d[static_cast<std::size_t>(l)]).real();
    }
  }
  for (int k = 0; k < 3; ++k) {
    const double pull = k == 0 ? 0 : p.tension_pull, off = s.v[k] - p.prior[static_cast<std::size_t>(k)];
    s.cost += pull * s.v[k] * s.v[k] + p.prior_pull * off * off;
    s.b[k] += pull * s.v[k] + p.prior_pull * off;
    s.a(k, k) += pull + p.prior_pull;
  }
  s.a = s.a.selfadjointView<Eigen::Upper>();
  s.merit = s.cost;
  if (!p.clamped_end) return;
  s.h << at.real() - p.end.real(), at.imag() - p.end.imag(), total_turning(g, lane) - p.turning;
  for (int k = 0; k < kUnknowns; ++k) {
    const Complex dk = d[static_cast<std::size_t>(k)];
    s.j.col(k) << dk.real(), dk.imag(), k < 3 ? g.dtheta[k][g.steps][lane] - g.dtheta[k][0][lane] : 0.0;
  }
  s.merit += kMissWeight * s.h.lpNorm<1>();
}

// The damped step of the model under its conditions. These are met by least change in the damping's own
// measure where they contradict each other to rounding.
Vector4 model_step(const Problem& p, const Search& s) {
  constexpr double kFloor = 1e-12;
  Eigen::Matrix4d a = s.a;
  const double floor = kFloor * a.trace() + 1e-300;
  for (int k = 0; k < kUnknowns; ++k) a(k, k) += s.damping * (a(k, k) + floor) + floor;
  if (!p.clamped_end) return -solve_symmetric(a, s.b);
  Eigen::Matrix<double, 7, 7> kkt = Eigen::Matrix<double, 7, 7>::Zero();
  kkt.topLeftCorner<4, 4>() = a;
  kkt.topRightCorner<4, 3>() = s.j.transpose();
  kkt.bottomLeftCorner<3, 4>() = s.j;
  Eigen::Matrix<double, 7, 1> rhs;
  rhs << -s.b, -s.h;
  return kkt.fullPivLu().solve(rhs).head<4>();
}

// Longest steps: half the curve's turning by a force, half its length.
Vector4 bounded(Vector4 step) {
  const double most =
      std::max({std::abs(step[0]) / 2, std::hypot(step[1], step[2]) / 20, std::abs(step[3]) / 0.3});
  if (most > 1) step /= most;
  return step;
}

bool resolved(const Vector4& v, int steps) {
  return v.allFinite() && std::abs(v[3]) < 3 && lanes::admissible({v[0], v[1], v[2]}, steps);
}

// Takes the trial in place of the search where its merit is lower; the end of a search is a step that would
// gain nothing, or one that cannot be taken.
void judge(Search& s, Search&& trial, const Vector4& step) {
  constexpr double kSmallGain = 1e-10, kMostDamping = 1e10;
  ++s.iterations;
  const bool met = trial.h.cwiseAbs().maxCoeff() <= kMet;
  const double gain = s.merit - trial.merit;
  // Once the ends are met to rounding, the merit is rounding too: the step's own size decides.
  const bool settled = met && step.cwiseAbs().maxCoeff() <= 1e-7 * (1 + s.v.cwiseAbs().maxCoeff());
  if (gain > 0 || settled) {
    trial.iterations = s.iterations;
    trial.damping = std::max(1e-12, s.damping * 0.2);
    trial.done = trial.converged = met && (settled || gain <= kSmallGain * trial.cost || trial.cost < 1e-26);
    s = std::move(trial);
  } else {
    s.damping *= 6;
    if (s.damping > kMostDamping) {
      s.done = true;
      s.converged = s.h.cwiseAbs().maxCoeff() <= kMet;
    }
  }
  if (s.iterations >= kMostIterations) s.done = true;
}

// All starts, eight traces at a time.
std::vector<Search> search(const Problem& p, const lanes::FitGrid& grid, std::span<const Shape> starts) {
  std::vector<Search> all;
  lanes::ShapeNodes nodes(grid.steps());
  for (std::size_t first = 0; first < starts.size(); first += lanes::kLanes) {
    const auto some = starts.subspan(first, std::min<std::size_t>(lanes::kLanes, starts.size() - first));
    std::vector<Search> block(some.size());
    for (std::size_t i = 0; i < some.size(); ++i) block[i].v << some[i][0], some[i][1], some[i][2], 0;
    for (bool begun = false; !std::all_of(block.begin(), block.end(), [](const Search& s) { return s.done; });
         begun = true) {
      std::vector<Vector4> steps(some.size(), Vector4::Zero());
      lanes::Lanes z[3] = {};
      for (std::size_t i = 0; i < some.size(); ++i) {
        if (begun && !block[i].done) steps[i] = bounded(model_step(p, block[i]));
        const Vector4 v = block[i].v + steps[i];
        if (!resolved(v, grid.steps())) continue;  // traced as a line, and refused below
        for (int k = 0; k < 3; ++k) z[k][i] = v[k];
      }
      lanes::trace_all(z, nodes);
      for (std::size_t i = 0; i < some.size(); ++i) {
        if (block[i].done) continue;
        Search trial = block[i];
        trial.v += steps[i];
        if (resolved(trial.v, grid.steps())) {
          linearise(p, grid, nodes, static_cast<int>(i), trial);
        } else {
          trial.merit = std::numeric_limits<double>::infinity();
        }
        if (begun) {
          judge(block[i], std::move(trial), steps[i]);
        } else {
          block[i] = trial;
          block[i].done = !std::isfinite(trial.merit);
        }
      }
    }
    all.insert(all.end(), block.begin(), block.end());
  }
  return all;
}

bool keeps_ends(const Search& s) {
  return std::isfinite(s.merit) && s.h.cwiseAbs().maxCoeff() <= kMet;
}

// Curves that keep the ends before those that miss, then the nearer ones.
bool better(const Search& a, const Search& b) {
  if (keeps_ends(a) != keeps_ends(b)) return keeps_ends(a);
  return keeps_ends(a) ? a.cost < b.cost : a.merit < b.merit;
}

Shape shape_of(const Elastica& e) {
  const MidState m = mid_state(e);
  return {m.kappa * m.length, m.tension1 * m.length * m.length, m.tension2 * m.length * m.length};
}

Problem make_problem(std::span<const Eigen::Vector2d> points, const ClampedEnds& ends,
                     const FitOptions& options, double scale) {
  Problem p;
  const Complex back = std::polar(1.0 / scale, -ends.start.theta);
  const auto local = [&](double x, double y) { return back * Complex(x - ends.start.x, y - ends.start.y); };
  for (const Eigen::Vector2d& q : points) p.points.push_back(local(q.x(), q.y()));
  p.weights.assign(options.weights.begin(), options.weights.end());
  if (p.weights.empty()) p.weights.assign(points.size(), 1.0 / static_cast<double>(points.size()));
  if (ends.end) {
    p.clamped_end = true;
    p.end = local(ends.end->x, ends.end->y);
    p.turning = ends.end->theta - ends.start.theta;
  }
  p.tension_pull = options.tension_weight * options.tension_weight;
  if (options.prior) {
    const MidState& m = *options.prior;
    p.prior = {m.kappa * m.length, m.tension1 * m.length * m.length, m.tension2 * m.length * m.length};
    p.prior_pull = options.prior_weight * options.prior_weight;
  }
  return p;
}

// The curve of a search in the input's units and place, with what it keeps and misses.
ClampedFit answer(const Search& s, std::span<const Eigen::Vector2d> points, const ClampedEnds& ends,
                  const std::vector<double>& weights, double scale) {
  ClampedFit fit;
  const double length = scale * std::exp(s.v[3]);
  const MidState mid{0,     0, 0, s.v[0] / length, s.v[1] / (length * length), s.v[2] / (length * length),
                     length};
  const Elastica e = from_mid_state(mid);
  const Eigen::Vector2d force = force_along(e, e.theta - ends.start.theta);
  fit.elastica = {ends.start.x, ends.start.y, ends.start.theta, e.kappa, force.x(), force.y(), length};
  const std::vector<CurvePoint> samples = sample(fit.elastica, static_cast<int>(points.size()));
  double mean = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    mean += weights[i] * (samples[i].position() - points[i]).squaredNorm();
  fit.rms = std::sqrt(mean);
  fit.max = max_distance(points, fit.elastica);
  if (ends.end) {
    fit.end_miss = (samples.back().position() - Eigen::Vector2d(ends.end->x, ends.end->y)).norm();
    fit.angle_miss = std::abs(samples.back().theta - ends.end->theta);
  }
  fit.status = !keeps_ends(s) ? ClampedStatus::kNoCurve
               : s.converged  ? ClampedStatus::kOk
                              : ClampedStatus::kNotConverged;
  return fit;
}

}  // namespace

ClampedFit fit_clamped(std::span<const Eigen::Vector2d> points, const ClampedEnds& ends,
                       std::span<const Elastica> starts, const FitOptions& options) {
  double scale = 0;
  for (std::size_t i = 1; i < points.size(); ++i) scale += (points[i] - points[i - 1]).norm();
  if (points.size() < 8 || !(scale > 0) || !std::isfinite(scale)) {
    throw std::logic_error("fit_clamped needs at least 8 finite points that are not all the same");
  }
  if (!options.weights.empty() && options.weights.size() != points.size()) {
    throw std::logic_error("fit_clamped needs a weight for each point or none");
  }
  const Problem problem = make_problem(points, ends, options, scale);
  std::vector<Shape> shapes;
  for (const Elastica& e : starts) shapes.push_back(shape_of(e));
  if (shapes.empty()) shapes.push_back(shape_of(fit_elastica(points, {}, options).elastica));
  lanes::FitGrid grid{static_cast<int>(points.size()), 1, {}};
  constexpr int kLeastSteps = 48, kMostStride = 16;
  while (grid.steps() < kLeastSteps ||
         (!lanes::resolved_finely(shapes.front(), grid.steps()) && grid.stride < kMostStride)) {
    ++grid.stride;
  }
  grid.stride += grid.steps() % 2;
  std::vector<Search> found = search(problem, grid, shapes);
  Search best = *std::min_element(found.begin(), found.end(), better);
  int tried = static_cast<int>(found.size());
  constexpr double kDoubtful = 1e-3;
  const bool doubtful = starts.empty() && !(best.cost < kDoubtful * kDoubtful);
  if (doubtful || !keeps_ends(best)) {
    const auto other = lanes::other_starts(problem.turning);
    std::vector<Shape> others(other.begin(), other.end());
    if (!starts.empty()) others.push_back(shape_of(fit_elastica(points, {}, options).elastica));
    found = search(problem, grid, others);
    tried += static_cast<int>(found.size());
    const Search second = *std::min_element(found.begin(), found.end(), better);
    if (better(second, best)) best = second;
  }
  ClampedFit fit = answer(best, points, ends, problem.weights, scale);
  fit.starts_tried = tried;
  return fit;
}

ClampedFit fit_clamped(const Bezier& b) {
  constexpr int kPoints = 49;
  const Eigen::Vector2d first = b[1] - b[0], last = b[3] - b[2];
  double polygon = 0;
  for (std::size_t i = 1; i < 4; ++i) polygon += (b[i] - b[i - 1]).norm();
  constexpr double kNoEdge = 1e-12;
  if (!std::isfinite(polygon) || !(std::min(first.norm(), last.norm()) > kNoEdge * polygon)) return {};
  std::vector<Eigen::Vector2d> points;
  for (const double t : even_parameters(b, kPoints)) points.push_back(evaluate(b, t).p);
  const double theta = std::atan2(first.y(), first.x());
  const double turning = true_turning(points, theta, std::atan2(last.y(), last.x()));
  return fit_clamped(points, {{b[0].x(), b[0].y(), theta}, PlanarPose{b[3].x(), b[3].y(), theta + turning}},
                     {}, {0, nullptr, 0});
}

double true_turning(std::span<const Eigen::Vector2d> points, double start_theta, double end_theta) {
  double direction = start_theta;
  const auto towards = [&](double theta) {
    direction += std::remainder(theta - direction, 2 * std::numbers::pi);
  };
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Eigen::Vector2d d = points[i] - points[i - 1];
    if (d.squaredNorm() > 0) towards(std::atan2(d.y(), d.x()));
  }
  towards(end_theta);
  return direction - start_theta;
}

}  // namespace hotblade::elastica

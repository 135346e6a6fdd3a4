#include "elastica/fit/fit_lanes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "elastica/curve/taylor.hpp"
#include "elastica/fit/shape_lanes.hpp"

namespace hotblade::elastica::lanes {

namespace {

constexpr int kMostIterations = 80;
constexpr double kFirstDamping = 1e-3, kLeastDamping = 1e-12, kMostDamping = 1e12;
// A step that would lower the cost by less than this share of it ends the search: distances then agree to
// 1e-9 of themselves.
constexpr double kSmallGain = 1e-9;
// Squared distances below this are rounding of points of size 1.
constexpr double kRoundingCost = 1e-28;

// Normal equations at one z: a the upper triangle 00 01 02 11 12 22, b the descent side.
struct Normal {
  Lanes cost, a[6], b[3];
};

struct Workspace {
  Workspace(const FitGrid& grid)
      : nodes(grid.steps()), x(static_cast<std::size_t>(grid.points)), y(x.size()) {}
  ShapeNodes nodes;
  Column x, y;  // the data
  Lanes tension_pull{}, prior_pull{}, prior[3]{};
};

// The similarity p -> c p + shift that lays the shapes on their data: c = <G, B> / <G, G>, centred.
struct Similarity {
  Lanes mean_x, mean_y, c_x, c_y, norm2;
};

HOTBLADE_INLINE Similarity best_similarity(const FitGrid& grid, const Workspace& w) {
  const Lanes zero = w.x[0].v * 0.0;
  Similarity q{zero, zero, zero, zero, zero};
  for (int i = 0; i < grid.points; ++i) {
    const double weight = grid.weights[static_cast<std::size_t>(i)];
    q.mean_x += weight * w.nodes.x[i * grid.stride];
    q.mean_y += weight * w.nodes.y[i * grid.stride];
  }
  Lanes cx = zero, cy = zero;
  for (int i = 0; i < grid.points; ++i) {
    const auto u = static_cast<std::size_t>(i);
    const Lanes gx = (w.nodes.x[i * grid.stride] - q.mean_x), gy = (w.nodes.y[i * grid.stride] - q.mean_y);
    q.norm2 += grid.weights[u] * (gx * gx + gy * gy);
    cx += grid.weights[u] * (gx * w.x[u].v + gy * w.y[u].v);
    cy += grid.weights[u] * (gx * w.y[u].v - gy * w.x[u].v);
  }
  q.c_x = cx / q.norm2;
  q.c_y = cy / q.norm2;
  return q;
}

// Adds FitOptions' pulls, which act on z itself.
HOTBLADE_INLINE void add_pulls(const Workspace& w, const Lanes* z, Normal& out) {
  constexpr int kDiagonal[3] = {0, 3, 5};
#pragma GCC unroll 3
  for (int k = 0; k < 3; ++k) {
    const Lanes off = z[k] - w.prior[k];
    out.cost += w.prior_pull * off * off;
    out.b[k] -= w.prior_pull * off;
    out.a[kDiagonal[k]] += w.prior_pull;
    if (k == 0) continue;
    out.cost += w.tension_pull * z[k] * z[k];
    out.b[k] -= w.tension_pull * z[k];
    out.a[kDiagonal[k]] += w.tension_pull;
  }
}

// Weighted sums over the points, positions and derivatives centred.
struct Sums {
  Lanes mean_x[3], mean_y[3];   // of the derivatives
  Lanes along[3], across[3];    // <derivative, shape>, a complex number
  Lanes square[6], b[3], cost;  // <derivative, derivative>, <derivative, residual>, <residual, residual>
};

HOTBLADE_INLINE void add_point(const ShapeNodes& g, const Similarity& q, int n, double weight, const Cell& x,
                               const Cell& y, Sums& sums) {
  const Lanes gx = g.x[n] - q.mean_x, gy = g.y[n] - q.mean_y;
  const Lanes rx = x.v - (q.c_x * gx - q.c_y * gy), ry = y.v - (q.c_x * gy + q.c_y * gx);
  sums.cost += weight * (rx * rx + ry * ry);
  // The residual turned back into the shape's frame: <c d, r> = <d, conj(c) r>.
  const Lanes tx = weight * (q.c_x * rx + q.c_y * ry), ty = weight * (q.c_x * ry - q.c_y * rx);
  const Lanes wx = weight * gx, wy = weight * gy;
  Lanes dx[3], dy[3];
  int entry = 0;
#pragma GCC unroll 3
  for (int k = 0; k < 3; ++k) {
    dx[k] = g.dx[k][n] - sums.mean_x[k];
    dy[k] = g.dy[k][n] - sums.mean_y[k];
    sums.b[k] += dx[k] * tx + dy[k] * ty;
    sums.along[k] += dx[k] * wx + dy[k] * wy;
    sums.across[k] += dy[k] * wx - dx[k] * wy;
  }
#pragma GCC unroll 3
  for (int k = 0; k < 3; ++k) {
#pragma GCC unroll 3
    for (int l = k; l < 3; ++l) sums.square[entry++] += weight * (dx[k] * dx[l] + dy[k] * dy[l]);
  }
}

// Residuals are orthogonal to the shape and to shifts, so the derivatives' parts along them drop out of b;
// in a they are taken off (Kaufman's variable projection).
HOTBLADE_INLINE void normal_equations(const FitGrid& grid, Workspace& w, const Lanes* z, Normal& out) {
  trace(z, w.nodes);
  const Similarity q = best_similarity(grid, w);
  Sums sums{};
  for (int i = 0; i < grid.points; ++i) {
    const double weight = grid.weights[static_cast<std::size_t>(i)];
#pragma GCC unroll 3
    for (int k = 0; k < 3; ++k) {
      sums.mean_x[k] += weight * w.nodes.dx[k][i * grid.stride];
      sums.mean_y[k] += weight * w.nodes.dy[k][i * grid.stride];
    }
  }
  for (int i = 0; i < grid.points; ++i) {
    const auto u = static_cast<std::size_t>(i);
    add_point(w.nodes, q, i * grid.stride, grid.weights[u], w.x[u], w.y[u], sums);
  }
  const Lanes scale2 = q.c_x * q.c_x + q.c_y * q.c_y, share = 1.0 / q.norm2;
  out.cost = sums.cost;
  int entry = 0;
#pragma GCC unroll 3
  for (int k = 0; k < 3; ++k) {
    out.b[k] = sums.b[k];
#pragma GCC unroll 3
    for (int l = k; l < 3; ++l, ++entry) {
      const Lanes taken = sums.along[k] * sums.along[l] + sums.across[k] * sums.across[l];
      out.a[entry] = scale2 * (sums.square[entry] - taken * share);
    }
  }
  add_pulls(w, z, out);
}

// The damped step, and the fall of the cost that it promises. Damping scales with the diagonal, and with its
// largest entry a little, so that a direction the points say nothing about stays still.
HOTBLADE_INLINE void damped_step(const Normal& n, const Lanes& damping, Lanes* step, Lanes& promised) {
  constexpr double kFloor = 1e-12;
  const Lanes floor = (n.a[0] + n.a[3] + n.a[5]) * kFloor + 1e-300;
  const Lanes d0 = n.a[0] + damping * (n.a[0] + floor) + floor;
  const Lanes l1 = n.a[1] / d0, l2 = n.a[2] / d0;
  const Lanes d1 = n.a[3] + damping * (n.a[3] + floor) + floor - l1 * n.a[1];
  const Lanes m = (n.a[4] - l1 * n.a[2]) / d1;
  const Lanes d2 = n.a[5] + damping * (n.a[5] + floor) + floor - l2 * n.a[2] - m * m * d1;
  const Lanes y0 = n.b[0], y1 = n.b[1] - l1 * y0, y2 = n.b[2] - l2 * y0 - m * y1;
  step[2] = y2 / d2;
  step[1] = y1 / d1 - m * step[2];
  step[0] = y0 / d0 - l1 * step[1] - l2 * step[2];
  promised = n.b[0] * step[0] + n.b[1] * step[1] + n.b[2] * step[2];
}

// omega^2 of taylor_rate at the middle against the most the grid resolves.
HOTBLADE_INLINE Mask resolved(const Lanes* z, double most) {
  Lanes tension = z[1] * z[1] + z[2] * z[2];
  for (int i = 0; i < kLanes; ++i) tension[i] = std::sqrt(tension[i]);
  return z[0] * z[0] + 3.0 * tension - 2.0 * z[1] <= most * most;
}

// The searches under way, one a lane.
struct Search {
  Lanes z[3], damping, cost;
  Normal at;
  std::size_t task[kLanes];
  int iterations[kLanes];
  bool busy[kLanes];
};

HOTBLADE_INLINE void load(const FitTask& task, const FitData& d, int lane, Workspace& w, Search& s) {
  for (std::size_t i = 0; i < w.x.size(); ++i) {
    w.x[i].v[lane] = d.x[i];
    w.y[i].v[lane] = d.y[i];
  }
  w.tension_pull[lane] = d.tension_pull;
  w.prior_pull[lane] = d.prior_pull;
  for (std::size_t k = 0; k < 3; ++k) {
    w.prior[k][lane] = d.prior[k];
    s.z[k][lane] = task.z[k];
    s.at.b[k][lane] = 0;  // the first step then stays at the start and measures it
  }
  for (Lanes& a : s.at.a) a[lane] = 0;
  s.damping[lane] = kFirstDamping;
  s.cost[lane] = std::numeric_limits<double>::infinity();
  s.iterations[lane] = 0;
}

// The next admissible task into the lane; false when none is left.
HOTBLADE_INLINE bool refill(const FitGrid& grid, std::span<const FitData> data, std::span<FitTask> tasks,
                            std::size_t& next, int lane, Workspace& w, Search& s) {
  s.busy[lane] = false;
  for (; next < tasks.size() && !s.busy[lane]; ++next) {
    FitTask& task = tasks[next];
    task.cost = std::numeric_limits<double>::infinity();
    if (!admissible(task.z, grid.steps())) continue;
    load(task, data[task.data], lane, w, s);
    s.task[lane] = next;
    s.busy[lane] = true;
  }
  return s.busy[lane];
}

// One step of every lane; returns the fall of the cost that was promised, as a share of the cost before.
HOTBLADE_INLINE Lanes advance(const FitGrid& grid, Workspace& w, Search& s) {
  Lanes step[3], promised, trial[3];
  damped_step(s.at, s.damping, step, promised);
  for (int k = 0; k < 3; ++k) trial[k] = s.z[k] + step[k];
  Normal n;
  normal_equations(grid, w, trial, n);
  const Mask better = (n.cost < s.cost) & resolved(trial, kMostOmegaStep * grid.steps());
  const Lanes gain = s.cost - n.cost, share = promised / s.cost;
  for (int k = 0; k < 3; ++k) s.z[k] = pick(better, trial[k], s.z[k]);
  for (int k = 0; k < 3; ++k) s.at.b[k] = pick(better, n.b[k], s.at.b[k]);
  for (int k = 0; k < 6; ++k) s.at.a[k] = pick(better, n.a[k], s.at.a[k]);
  s.cost = pick(better, n.cost, s.cost);
  // A step that keeps its promise frees the next one quickly.
  const Lanes freer = pick(gain > 0.75 * promised, s.damping * 0.1, s.damping * 0.5);
  s.damping = pick(better, pick(freer > kLeastDamping, freer, s.damping), s.damping * 8.0);
  return share;
}

HOTBLADE_INLINE void solve_body(const FitGrid& grid, std::span<const FitData> data,
                                std::span<FitTask> tasks) {
  Workspace w(grid);
  Search s{};
  std::size_t next = 0;
  int busy = 0;
  for (int lane = 0; lane < kLanes; ++lane) busy += refill(grid, data, tasks, next, lane, w, s);
  while (busy > 0) {
    const Lanes share = advance(grid, w, s);
    for (int lane = 0; lane < kLanes; ++lane) {
      if (!s.busy[lane]) continue;
      const bool measured = s.iterations[lane]++ > 0;
      const bool done = (measured && share[lane] <= kSmallGain) || s.cost[lane] < kRoundingCost ||
                        s.damping[lane] > kMostDamping;
      if (!done && s.iterations[lane] < kMostIterations) continue;
      FitTask& task = tasks[s.task[lane]];
      task.z = {s.z[0][lane], s.z[1][lane], s.z[2][lane]};
      task.cost = s.cost[lane];
      task.iterations = s.iterations[lane];
      task.converged = done;
      busy -= !refill(grid, data, tasks, next, lane, w, s);
    }
  }
}

// Where the similarity lays a lane's shape.
HOTBLADE_INLINE Placed laid(const FitGrid& grid, const ShapeNodes& g, const Similarity& q, const FitData& d,
                            const Shape& z, int lane) {
  Placed p;
  const double cx = q.c_x[lane], cy = q.c_y[lane], mx = q.mean_x[lane], my = q.mean_y[lane];
  p.length = std::sqrt(cx * cx + cy * cy);
  p.theta = std::atan2(cy, cx);
  p.x = cy * my - cx * mx;
  p.y = -cx * my - cy * mx;
  p.start_x = p.x + cx * g.x[0][lane] - cy * g.y[0][lane];
  p.start_y = p.y + cx * g.y[0][lane] + cy * g.x[0][lane];
  p.start_theta = p.theta + std::atan2(g.s[0][lane], g.c[0][lane]);
  p.start_kappa = z[0] - z[1] * g.y[0][lane] + z[2] * g.x[0][lane];
  for (int i = 0; i < grid.points; ++i) {
    const auto u = static_cast<std::size_t>(i);
    const int n = i * grid.stride;
    const double gx = g.x[n][lane], gy = g.y[n][lane];
    const double rx = d.x[i] - (p.x + cx * gx - cy * gy), ry = d.y[i] - (p.y + cx * gy + cy * gx);
    p.cost += grid.weights[u] * (rx * rx + ry * ry);
    if (!d.cos) continue;
    const double tx = cx * g.c[n][lane] - cy * g.s[n][lane], ty = cx * g.s[n][lane] + cy * g.c[n][lane];
    const double angle = std::atan2(d.cos[i] * ty - d.sin[i] * tx, d.cos[i] * tx + d.sin[i] * ty);
    p.angle2 += grid.weights[u] * angle * angle;
  }
  return p;
}

#if defined(__x86_64__)
HOTBLADE_AVX512 void solve_512(const FitGrid& grid, std::span<const FitData> data, std::span<FitTask> tasks) {
  solve_body(grid, data, tasks);
}

HOTBLADE_AVX2 void solve_256(const FitGrid& grid, std::span<const FitData> data, std::span<FitTask> tasks) {
  solve_body(grid, data, tasks);
}

HOTBLADE_AVX512 void trace_512(const Lanes* z, ShapeNodes& out) {
  trace(z, out);
}

HOTBLADE_AVX2 void trace_256(const Lanes* z, ShapeNodes& out) {
  trace(z, out);
}
#endif

}  // namespace

Elastica unit_removed(const Placed& p, const Shape& z, const Eigen::Vector2d& origin, double scale) {
  const double length = p.length * scale, c = std::cos(p.theta), s = std::sin(p.theta);
  const double t1 = z[1] / (length * length), t2 = z[2] / (length * length);
  return {origin.x() + p.start_x * scale,
          origin.y() + p.start_y * scale,
          p.start_theta,
          p.start_kappa / length,
          c * t1 - s * t2,
          s * t1 + c * t2,
          length};
}

std::array<Shape, 13> other_starts(double mean_curvature) {
  std::array<Shape, 13> starts;
  std::size_t n = 0;
  starts[n++] = {mean_curvature, 0, 0};
  for (const double kappa : {-5.0, 0.0, 5.0}) {
    for (const double along : {-25.0, 25.0}) {
      for (const double across : {-30.0, 30.0}) starts[n++] = {kappa, along, across};
    }
  }
  return starts;
}

bool admissible(const Shape& z, int steps) {
  return taylor_rate(0, z[0], z[1], z[2]) <= kMostOmegaStep * steps;
}

bool resolved_finely(const Shape& z, int steps) {
  return taylor_rate(0, z[0], z[1], z[2]) <= kFineOmegaStep * steps;
}

void solve(const FitGrid& grid, std::span<const FitData> data, std::span<FitTask> tasks, Simd simd) {
#if defined(__x86_64__)
  if (simd == Simd::kAvx512) return solve_512(grid, data, tasks);
  if (simd == Simd::kAvx2) return solve_256(grid, data, tasks);
#endif
  static_cast<void>(simd);
  solve_body(grid, data, tasks);
}

void trace_all(const Lanes* z, ShapeNodes& out) {
#if defined(__x86_64__)
  if (best_simd() == Simd::kAvx512) return trace_512(z, out);
  if (best_simd() == Simd::kAvx2) return trace_256(z, out);
#endif
  trace(z, out);
}

std::vector<Placed> place(const FitGrid& grid, std::span<const FitData> data,
                          std::span<const FitTask> tasks) {
  std::vector<Placed> out;
  out.reserve(tasks.size());
  Workspace w(grid);
  Search s{};
  for (std::size_t first = 0; first < tasks.size(); first += kLanes) {
    const auto some = tasks.subspan(first, std::min<std::size_t>(kLanes, tasks.size() - first));
    int lane = 0;
    for (const FitTask& task : some) load(task, data[task.data], lane++, w, s);
    trace_side(s.z, 1, w.nodes);
    trace_side(s.z, -1, w.nodes);
    const Similarity q = best_similarity(grid, w);
    lane = 0;
    for (const FitTask& task : some) {
      out.push_back(laid(grid, w.nodes, q, data[task.data], task.z, lane++));
    }
  }
  return out;
}

}  // namespace hotblade::elastica::lanes

#include "elastica/fit/fit_bezier.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "elastica/fit/fit_lanes.hpp"

namespace hotblade::elastica {

namespace {

constexpr int kSteps = 48, kPoints = kSteps + 1;

// Weights of the trapezoidal rule with Gregory's end corrections to fifth differences: integrates smooth
// functions over [0, 1] at evenly spaced nodes with an error of order h^7.
std::vector<double> gregory_weights() {
  std::vector<double> w(kPoints, 1.0 / kSteps);
  constexpr std::array<double, 6> kEnd{19087. / 60480, 84199. / 60480, 18869. / 30240,
                                       37621. / 30240, 55031. / 60480, 61343. / 60480};
  for (std::size_t i = 0; i < kEnd.size(); ++i) {
    w[i] = kEnd[i] / kSteps;
    w[kPoints - 1 - i] = kEnd[i] / kSteps;
  }
  return w;
}

const lanes::FitGrid& grid() {
  static const lanes::FitGrid g{kPoints, 1, gregory_weights()};
  return g;
}

// The same points with four times the steps between them: tightly wound curves.
const lanes::FitGrid& fine_grid() {
  static const lanes::FitGrid g{kPoints, 4, gregory_weights()};
  return g;
}

// A Bezier at evenly spaced arc lengths: moved so that the weighted mean is 0, and scaled to length 1.
struct EvenBezier {
  std::array<double, kPoints> x{}, y{}, cos{}, sin{}, kappa{};
  Eigen::Vector2d mean{0, 0};
  double length = 0;
  bool supported = false;
};

struct Speed {
  Eigen::Vector2d a, b, c;  // B' = a + b t + c t^2
  explicit Speed(const Bezier& q)
      : a(3 * (q[1] - q[0])), b(6 * (q[0] - 2 * q[1] + q[2])), c(3 * (q[3] - q[0] + 3 * (q[1] - q[2]))) {}
  [[nodiscard]] Eigen::Vector2d at(double t) const { return a + t * (b + t * c); }
  [[nodiscard]] double operator()(double t) const {
    const double x = a.x() + t * (b.x() + t * c.x()), y = a.y() + t * (b.y() + t * c.y());
    return std::sqrt(x * x + y * y);
  }
  // Arc length from t to t + h by four Gauss nodes.
  [[nodiscard]] double length(double t, double h) const {
    constexpr double kX1 = 0.3399810435848563, kX2 = 0.8611363115940526;
    constexpr double kW1 = 0.6521451548625461, kW2 = 0.3478548451374538;
    const double m = t + 0.5 * h, r = 0.5 * h;
    return r * (kW1 * ((*this)(m - kX1 * r) + (*this)(m + kX1 * r)) +
                kW2 * ((*this)(m - kX2 * r) + (*this)(m + kX2 * r)));
  }
};

// Parameters of evenly spaced arc lengths: panels of the parameter, inverse cubic in each, one Newton step.
void even_parameters(const Speed& speed, std::array<double, kPoints>& t, double& length) {
  constexpr int kPanels = 16;
  constexpr double kH = 1.0 / kPanels;
  std::array<double, kPanels + 1> s{}, v{};
  for (int i = 0; i <= kPanels; ++i) v[static_cast<std::size_t>(i)] = speed(i * kH);
  for (std::size_t i = 0; i < kPanels; ++i) s[i + 1] = s[i] + speed.length(static_cast<double>(i) * kH, kH);
  length = s[kPanels];
  t.front() = 0;
  t.back() = 1;
  std::size_t i = 0;
  for (std::size_t k = 1; k + 1 < kPoints; ++k) {
    const double want = length * static_cast<double>(k) / kSteps;
    while (i + 1 < kPanels && s[i + 1] < want) ++i;
    const double width = s[i + 1] - s[i], u = (want - s[i]) / width;
    // Hermite: t and dt/ds at both ends of the panel.
    const double d0 = width / v[i], d1 = width / v[i + 1];
    double x = u * u * (3 - 2 * u) * kH + u * (1 - u) * ((1 - u) * d0 - u * d1);
    if (!(x >= 0 && x <= kH)) x = u * kH;  // an end of the panel nearly stands still
    const double t0 = static_cast<double>(i) * kH;
    for (int step = 0; step < 2; ++step) {
      const double off = s[i] + speed.length(t0, x) - want;
      x = std::clamp(x - off / speed(t0 + x), 0.0, kH);
      if (std::abs(off) < 1e-8 * length) break;  // the step just taken leaves its square
    }
    t[k] = t0 + x;
  }
}

EvenBezier even_bezier(const Bezier& b) {
  EvenBezier e;
  const Speed speed(b);
  std::array<double, kPoints> t;
  even_parameters(speed, t, e.length);
  if (!(e.length > 0) || !std::isfinite(e.length)) return e;
  const double scale = 1 / e.length;
  double slowest = e.length;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double u = t[i], v = 1 - u;
    const Eigen::Vector2d p = v * v * (v * b[0] + 3 * u * b[1]) + u * u * (3 * v * b[2] + u * b[3]);
    const Eigen::Vector2d d = speed.at(u), dd = speed.b + 2 * u * speed.c;
    const double rate = std::sqrt(d.squaredNorm());
    slowest = std::min(slowest, rate);
    e.x[i] = p.x();
    e.y[i] = p.y();
    e.cos[i] = d.x() / rate;
    e.sin[i] = d.y() / rate;
    e.kappa[i] = (d.x() * dd.y() - d.y() * dd.x()) / (rate * rate * rate) * e.length;
    e.mean += grid().weights[i] * p;
  }
  for (std::size_t i = 0; i < kPoints; ++i) {
    e.x[i] = (e.x[i] - e.mean.x()) * scale;
    e.y[i] = (e.y[i] - e.mean.y()) * scale;
  }
  // A speed this small is a cusp at a node: its tangent and curvature are rounding.
  constexpr double kCuspShare = 1e-9;
  e.supported = slowest > kCuspShare * e.length;
  return e;
}

// Curvature affine in position, by least squares over the nodes (positions are centred).
struct AffineCurvature {
  double mean = 0, by_x = 0, by_y = 0;  // kappa ~ mean + by_x x + by_y y
  double residual = 0;                  // the lambda-residual
};

AffineCurvature affine_curvature(const EvenBezier& e) {
  const std::vector<double>& w = grid().weights;
  double k = 0, kk = 0, xx = 0, xy = 0, yy = 0, xk = 0, yk = 0;
  for (std::size_t i = 0; i < kPoints; ++i) k += w[i] * e.kappa[i];
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double d = e.kappa[i] - k;
    kk += w[i] * d * d;
    xx += w[i] * e.x[i] * e.x[i];
    xy += w[i] * e.x[i] * e.y[i];
    yy += w[i] * e.y[i] * e.y[i];
    xk += w[i] * e.x[i] * d;
    yk += w[i] * e.y[i] * d;
  }
  // Nearly straight curves leave one direction open: it gets no share of the curvature.
  const double ridge = 1e-12 * (xx + yy), det = (xx + ridge) * (yy + ridge) - xy * xy;
  AffineCurvature a;
  a.mean = k;
  a.by_x = ((yy + ridge) * xk - xy * yk) / det;
  a.by_y = ((xx + ridge) * yk - xy * xk) / det;
  const double left = kk - a.by_x * xk - a.by_y * yk, all = kk + k * k;
  a.residual = all > 1e-24 ? std::sqrt(std::max(0.0, left / all)) : 0;
  return a;
}

// The paper's first guess, read off at the middle of the curve instead of its start.
lanes::Shape affine_start(const EvenBezier& e, const AffineCurvature& a) {
  constexpr std::size_t kMiddle = kPoints / 2;
  const double c = e.cos[kMiddle], s = e.sin[kMiddle];
  // theta'' = by_x cos + by_y sin; in the tangent's frame lambda2 = T2, lambda1 = T1.
  return {a.mean + a.by_x * e.x[kMiddle] + a.by_y * e.y[kMiddle], a.by_x * s - a.by_y * c,
          a.by_x * c + a.by_y * s};
}

// L2 above this share of the lambda-residual asks for the other starts. Right answers stay below 0.028 on
// 40,000 curves of the paper's constraints, wrong ones were seen at 0.1 and more.
constexpr double kSuspiciousShare = 0.03;
// A search of the coarse grid that took longer than this has been somewhere else.
constexpr int kManyIterations = 40;

bool suspicious(const lanes::FitTask& task, double residual) {
  constexpr double kRounding = 1e-9;
  return !task.converged || task.iterations > kManyIterations ||
         !(std::sqrt(task.cost) <= kSuspiciousShare * residual + kRounding);
}

// Curves fitted together; bounds the memory, not the answers.
constexpr std::size_t kBlock = 64;

struct Block {
  std::vector<EvenBezier> curves;
  std::vector<AffineCurvature> affine;
  std::vector<lanes::FitData> data;
  std::vector<lanes::FitTask> best;  // one per curve
  std::vector<int> starts;
};

Block prepare(std::span<const Bezier> beziers) {
  Block block;
  block.curves.reserve(beziers.size());
  for (const Bezier& b : beziers) {
    const EvenBezier& e = block.curves.emplace_back(even_bezier(b));
    lanes::FitData data{e.x.data(), e.y.data(), e.cos.data(), e.sin.data(), 0, 0, {}};
    // No shape to start from until the curve is known to be supported.
    constexpr double kNone = std::numeric_limits<double>::infinity();
    lanes::FitTask task{block.data.size(), {kNone, kNone, kNone}, 0, 0, false};
    block.affine.push_back(e.supported ? affine_curvature(e) : AffineCurvature{});
    if (e.supported) task.z = affine_start(e, block.affine.back());
    block.data.push_back(data);
    block.best.push_back(task);
  }
  return block;
}

// The second look: doubtful answers against all other starts, tightly wound ones once more in finer steps.
std::vector<lanes::FitTask> second_tasks(const Block& block, bool all_starts) {
  std::vector<lanes::FitTask> tasks;
  for (std::size_t i = 0; i < block.best.size(); ++i) {
    if (!block.curves[i].supported) continue;
    const lanes::FitTask& first = block.best[i];
    const bool doubtful = all_starts || suspicious(first, block.affine[i].residual);
    if (!doubtful && lanes::resolved_finely(first.z, kSteps)) continue;
    tasks.push_back(first);
    if (!doubtful) continue;
    if (!(first.cost < 1)) tasks.back().z = affine_start(block.curves[i], block.affine[i]);
    for (const lanes::Shape& z : lanes::other_starts(block.affine[i].mean)) {
      tasks.push_back({i, z, 0, 0, false});
    }
  }
  return tasks;
}

BezierElasticaFit answer(const EvenBezier& e, const lanes::FitTask& task, const lanes::Placed& p) {
  BezierElasticaFit fit;
  fit.elastica = unit_removed(p, task.z, e.mean, e.length);
  fit.l2 = std::sqrt(std::max(0.0, p.cost));
  fit.h1 = std::sqrt(std::max(0.0, p.cost + p.angle2));
  fit.status = task.converged ? FitStatus::kOk : FitStatus::kNotConverged;
  return fit;
}

void fit_block(std::span<const Bezier> beziers, const BezierFitOptions& options,
               std::vector<BezierElasticaFit>& out) {
  Block block = prepare(beziers);
  lanes::solve(grid(), block.data, block.best);
  block.starts.assign(beziers.size(), 1);
  std::vector<lanes::FitTask> second = second_tasks(block, options.all_starts);
  lanes::solve(fine_grid(), block.data, second);
  std::vector<bool> fine(beziers.size(), false);
  for (const lanes::FitTask& task : second) {
    lanes::FitTask& best = block.best[task.data];
    if (fine[task.data]) ++block.starts[task.data];
    // The first of a curve's second tasks stands for its first answer, in finer steps.
    if (!fine[task.data] || task.cost < best.cost) best = task;
    fine[task.data] = true;
  }
  std::vector<lanes::FitTask> coarse_tasks, fine_tasks;
  for (const lanes::FitTask& task : block.best) (fine[task.data] ? fine_tasks : coarse_tasks).push_back(task);
  const std::vector<lanes::Placed> coarse = place(grid(), block.data, coarse_tasks);
  const std::vector<lanes::Placed> finer = place(fine_grid(), block.data, fine_tasks);
  std::size_t next[2] = {0, 0};
  for (std::size_t i = 0; i < beziers.size(); ++i) {
    const lanes::Placed& p = fine[i] ? finer[next[1]++] : coarse[next[0]++];
    BezierElasticaFit fit;
    fit.status = FitStatus::kUnsupported;
    if (block.curves[i].supported && block.best[i].cost < 1) fit = answer(block.curves[i], block.best[i], p);
    fit.starts_tried = block.curves[i].supported ? block.starts[i] : 0;
    out.push_back(fit);
  }
}

}  // namespace

BezierElasticaFit fit_bezier_elastica(const Bezier& bezier, const BezierFitOptions& options) {
  return fit_bezier_elastica(std::span(&bezier, 1), options).front();
}

std::vector<BezierElasticaFit> fit_bezier_elastica(std::span<const Bezier> beziers,
                                                   const BezierFitOptions& options) {
  std::vector<BezierElasticaFit> fits;
  fits.reserve(beziers.size());
  for (std::size_t first = 0; first < beziers.size(); first += kBlock) {
    fit_block(beziers.subspan(first, std::min(kBlock, beziers.size() - first)), options, fits);
  }
  return fits;
}

}  // namespace hotblade::elastica

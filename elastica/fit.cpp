#include "elastica/fit.hpp"

#include <ceres/jet.h>
#include <ceres/tiny_solver.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace hotblade::elastica {

namespace {

using Jet = ceres::Jet<double, 3>;  // derivatives by kappa, tension1, tension2

// Points of the curve on both sides of the middle, in the middle's frame, with derivatives.
struct HalfCurve {
  std::vector<TaylorPiece<Jet>> pieces;
  std::vector<TaylorPoint<Jet>> starts;
  double step = 0;

  HalfCurve(const Jet& kappa, const Jet& tension1, const Jet& tension2, double length) {
    const double omega = taylor_rate(0, kappa.a, tension1.a, tension2.a);
    const int n =
        std::clamp(static_cast<int>(std::ceil(length * omega / kStepOmega)), 1, ElasticaCurve::kMaxPieces);
    step = length / n;
    TaylorPoint<Jet> start{Jet(0.0), Jet(0.0), Jet(0.0), kappa};
    for (int i = 0; i < n; ++i) {
      pieces.push_back(expand(start.theta, start.kappa, tension1, tension2));
      starts.push_back(start);
      const TaylorPoint<Jet> end = evaluate(pieces.back(), step);
      start = {start.x + end.x, start.y + end.y, end.theta, end.kappa};
    }
  }

  [[nodiscard]] TaylorPoint<Jet> at(double s) const {
    const auto i = std::min(pieces.size() - 1, static_cast<std::size_t>(std::max(0.0, s / step)));
    TaylorPoint<Jet> p = evaluate(pieces[i], s - static_cast<double>(i) * step);
    p.x += starts[i].x;
    p.y += starts[i].y;
    return p;
  }
};

// Residuals of the points against the elastica at proportional arc length, and of the prior. Parameters: x,
// y, theta, kappa, tension1, tension2, length, in units of the data's length.
class FitFunction {
 public:
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = 7 };

  FitFunction(const std::vector<Eigen::Vector2d>& points, double tension_weight, const Eigen::Vector3d& prior,
              double prior_weight)
      : points_(points),
        prior_(prior),
        tension_weight_(tension_weight * std::sqrt(static_cast<double>(points.size()))),
        prior_weight_(prior_weight * std::sqrt(static_cast<double>(points.size()))) {}

  // Lengths and turnings worth evaluating; a start outside is not tried.
  [[nodiscard]] static bool admissible(const double* m) {
    constexpr double kMaxTurn = 60;
    return m[6] > 0.1 && m[6] < 10 && taylor_rate(0, m[3], m[4], m[5]) * m[6] < kMaxTurn;
  }

  [[nodiscard]] int NumResiduals() const { return static_cast<int>(2 * points_.size()) + 5; }

  bool operator()(const double* m, double* residuals, double* jacobian) const {
    // Steps to curves no blade can take cost too much, which makes the solver shorten them (it ignores a
    // refusal).
    constexpr double kTooMuch = 1e6;
    if (!admissible(m)) {
      std::fill_n(residuals, NumResiduals(), kTooMuch);
      return jacobian == nullptr;
    }
    const Jet kappa(m[3], 0), t1(m[4], 1), t2(m[5], 2);
    const HalfCurve ahead(kappa, t1, t2, 0.55 * m[6]);
    // The curve run backwards is the elastica of -kappa and the same tensions in its own frame, turned by pi.
    const HalfCurve behind(-kappa, t1, t2, 0.55 * m[6]);
    const int rows = NumResiduals();
    Jacobian j(jacobian, jacobian ? rows : 0, 7);
    if (jacobian) j.setZero();
    const double c = std::cos(m[2]), s = std::sin(m[2]);
    const double last = static_cast<double>(points_.size() - 1);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const double u = static_cast<double>(i) / last - 0.5;
      const bool forward = u >= 0;
      const TaylorPoint<Jet> q = forward ? ahead.at(u * m[6]) : behind.at(-u * m[6]);
      const double sign = forward ? 1 : -1;
      const double x = sign * q.x.a, y = sign * q.y.a;
      const auto r = static_cast<Eigen::Index>(2 * i);
      residuals[r] = m[0] + c * x - s * y - points_[i].x();
      residuals[r + 1] = m[1] + s * x + c * y - points_[i].y();
      if (!jacobian) continue;
      j(r, 0) = 1;
      j(r + 1, 1) = 1;
      j(r, 2) = -s * x - c * y;
      j(r + 1, 2) = c * x - s * y;
      for (Eigen::Index k = 0; k < 3; ++k) {
        const double dx = sign * q.x.v[k], dy = sign * q.y.v[k];
        j(r, 3 + k) = c * dx - s * dy;
        j(r + 1, 3 + k) = s * dx + c * dy;
      }
      const double tx = std::cos(q.theta.a), ty = std::sin(q.theta.a);
      j(r, 6) = u * (c * tx - s * ty);
      j(r + 1, 6) = u * (s * tx + c * ty);
    }
    add_pulls(m, residuals, jacobian ? &j : nullptr);
    return true;
  }

 private:
  using Jacobian = Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 7>>;

  // The last five rows: tensions towards zero, curvature and tensions towards the prior.
  void add_pulls(const double* m, double* residuals, Jacobian* j) const {
    const Eigen::Index row = NumResiduals() - 5;
    for (Eigen::Index k = 0; k < 2; ++k) {
      residuals[row + k] = tension_weight_ * m[4 + k];
      if (j) (*j)(row + k, 4 + k) = tension_weight_;
    }
    for (Eigen::Index k = 0; k < 3; ++k) {
      residuals[row + 2 + k] = prior_weight_ * (m[3 + k] - prior_[k]);
      if (j) (*j)(row + 2 + k, 3 + k) = prior_weight_;
    }
  }

  const std::vector<Eigen::Vector2d>& points_;
  Eigen::Vector3d prior_;
  double tension_weight_, prior_weight_;
};

using Parameters = Eigen::Matrix<double, 7, 1>;

// To and from the units and place of the normalised data.
Parameters to_parameters(const MidState& m, const Eigen::Vector2d& origin, double scale) {
  Parameters p;
  p << (m.x - origin.x()) / scale, (m.y - origin.y()) / scale, m.theta, m.kappa * scale,
      m.tension1 * scale * scale, m.tension2 * scale * scale, m.length / scale;
  return p;
}

MidState to_mid_state(const Parameters& p, const Eigen::Vector2d& origin, double scale) {
  return {origin.x() + p[0] * scale, origin.y() + p[1] * scale, p[2],        p[3] / scale,
          p[4] / (scale * scale),    p[5] / (scale * scale),    p[6] * scale};
}

// A guess may be too wild to be evaluated at all.
bool evaluable(const Elastica& e) {
  const double turn = taylor_rate(e.theta, e.kappa, e.lambda1, e.lambda2) * e.length;
  return turn < kStepOmega * ElasticaCurve::kMaxPieces;
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
    s = std::clamp(s - r.dot(t) / df, 0.0, length);
  }
  return {std::min(best_sq, (curve.at(s).position() - q).squaredNorm()), s};
}

double polyline_length(std::span<const Eigen::Vector2d> q) {
  double length = 0;
  for (std::size_t i = 1; i < q.size(); ++i) length += (q[i] - q[i - 1]).norm();
  return length;
}

// Starts that need no Bezier: curvature by differences, affine in position by least squares, about the
// middle; and the circular arc of the mean curvature. `q` is normalised (length 1, middle point at the
// origin).
std::array<Parameters, 2> own_starts(const std::vector<Eigen::Vector2d>& q) {
  const auto n = static_cast<Eigen::Index>(q.size());
  const double h = 1.0 / static_cast<double>(n - 1);
  Eigen::MatrixX3d a(n - 2, 3);
  Eigen::VectorXd k(n - 2);
  for (Eigen::Index i = 1; i + 1 < n; ++i) {
    const auto u = static_cast<std::size_t>(i);
    const Eigen::Vector2d d0 = q[u] - q[u - 1], d1 = q[u + 1] - q[u];
    k[i - 1] = std::atan2(d0.x() * d1.y() - d0.y() * d1.x(), d0.dot(d1)) / h;
    a.row(i - 1) << 1, -q[u].y(), q[u].x();
  }
  const Eigen::Vector3d x = a.completeOrthogonalDecomposition().solve(k);
  const auto middle = q.size() / 2;
  const Eigen::Vector2d d = q[middle + 1] - q[middle - 1];
  const double theta = std::atan2(d.y(), d.x()), c = std::cos(theta), s = std::sin(theta);
  Parameters affine, arc;
  affine << 0, 0, theta, x[0], c * x[1] + s * x[2], c * x[2] - s * x[1], 1;
  arc << 0, 0, theta, k.mean(), 0, 0, 1;
  return {affine, arc};
}

}  // namespace

MidState mid_state(const Elastica& e) {
  const CurvePoint p = point_at(e, 0.5 * e.length);
  const double c = std::cos(p.theta), s = std::sin(p.theta);
  return {p.x,     p.y, p.theta, p.kappa, c * e.lambda1 + s * e.lambda2, -s * e.lambda1 + c * e.lambda2,
          e.length};
}

Elastica from_mid_state(const MidState& m) {
  const double c = std::cos(m.theta), s = std::sin(m.theta);
  const Elastica middle{
      m.x, m.y, m.theta, m.kappa, c * m.tension1 - s * m.tension2, s * m.tension1 + c * m.tension2, 0};
  return segment(middle, -0.5 * m.length, 0.5 * m.length);
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
  const double scale = polyline_length(points);
  const Eigen::Vector2d origin = points[points.size() / 2];
  std::vector<Eigen::Vector2d> normalised;
  normalised.reserve(points.size());
  for (const Eigen::Vector2d& q : points) normalised.push_back((q - origin) / scale);
  Eigen::Vector3d prior = Eigen::Vector3d::Zero();
  if (options.prior) prior = to_parameters(*options.prior, origin, scale).segment<3>(3);
  const FitFunction function(normalised, options.tension_weight, prior,
                             options.prior ? options.prior_weight : 0);
  ElasticaFit best;
  best.elastica =
      from_mid_state({origin.x(), origin.y(), 0, 0, 0, 0, scale});  // when no start gives a finite cost
  double best_cost = std::numeric_limits<double>::infinity();
  std::vector<Parameters> from;
  for (const Elastica& start : starts) {
    if (evaluable(start)) from.push_back(to_parameters(mid_state(start), origin, scale));
  }
  for (const Parameters& own : own_starts(normalised)) from.push_back(own);
  for (Parameters p : from) {
    if (!FitFunction::admissible(p.data())) continue;
    ceres::TinySolver<FitFunction> solver;
    solver.options.max_num_iterations = 60;
    solver.options.gradient_tolerance = 1e-14;
    solver.options.parameter_tolerance = 1e-12;
    solver.options.function_tolerance = 1e-12;
    solver.options.cost_threshold = 1e-24;
    ++best.starts_tried;
    const auto& summary = solver.Solve(function, &p);
    if (!(summary.final_cost < best_cost)) continue;
    best_cost = summary.final_cost;
    best.elastica = from_mid_state(to_mid_state(p, origin, scale));
    best.converged = summary.status != ceres::TinySolver<FitFunction>::HIT_MAX_ITERATIONS;
  }
  const std::vector<CurvePoint> samples = sample(best.elastica, static_cast<int>(points.size()));
  double sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i) sum += (samples[i].position() - points[i]).squaredNorm();
  best.rms = std::sqrt(sum / static_cast<double>(points.size()));
  best.max = max_distance(points, best.elastica);
  return best;
}

CurveDistance distance(const Bezier& b, const Elastica& e) {
  constexpr int kSamples = 200;
  const std::vector<double> t = even_parameters(b, kSamples + 1);
  const double length = arc_lengths(b, 64).back();
  const ElasticaCurve curve(e);
  std::vector<Eigen::Vector2d> on_bezier;
  double l2 = 0, angle2 = 0;
  for (int i = 0; i <= kSamples; ++i) {
    const BezierPoint p = evaluate(b, t[static_cast<std::size_t>(i)]);
    const CurvePoint q = curve.at(e.length * i / kSamples);
    const double weight = (i == 0 || i == kSamples ? 1 : i % 2 ? 4 : 2) / (3.0 * kSamples);  // Simpson
    l2 += weight * (p.p - q.position()).squaredNorm() / (length * length);
    const double turn = std::remainder(std::atan2(p.d1.y(), p.d1.x()) - q.theta, 2 * std::numbers::pi);
    angle2 += weight * turn * turn;
    on_bezier.push_back(p.p);
  }
  CurveDistance d{std::sqrt(l2), std::sqrt(l2 + angle2), max_distance(on_bezier, e)};
  // The other way round: samples of the elastica against the Bezier's polyline segments.
  for (const CurvePoint& q : sample(e, kSamples + 1)) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i + 1 < on_bezier.size(); ++i) {
      const Eigen::Vector2d a = on_bezier[i], ab = on_bezier[i + 1] - a;
      const double u = std::clamp((q.position() - a).dot(ab) / std::max(ab.squaredNorm(), 1e-300), 0.0, 1.0);
      nearest = std::min(nearest, (a + u * ab - q.position()).squaredNorm());
    }
    d.hausdorff = std::max(d.hausdorff, std::sqrt(nearest));
  }
  return d;
}

}  // namespace hotblade::elastica

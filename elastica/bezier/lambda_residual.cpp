#include "elastica/bezier/lambda_residual.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "elastica/kernels/graded_residual.h"

namespace hotblade::elastica {

namespace {

using Column = Eigen::VectorXd;

// A column of values at all nodes each, times the square root of ds.
struct Columns {
  explicit Columns(Eigen::Index nodes) : one(nodes), x(nodes), y(nodes), kappa(nodes) {}
  Column one, x, y, kappa;
};

// Parameters t and weights of all nodes.
struct Nodes {
  std::vector<double> t, w;
  // Adds the Gauss rule of 24 nodes from one u = t - 1/2 to another.
  void add_panel(double from, double to) {
    for (const auto& node : hb_gauss) {
      for (const double sign : {-1.0, 1.0}) {
        t.push_back(0.5 + 0.5 * (from + to) + sign * node[0] * (to - from));
        w.push_back(node[HB_GAUSS_WEIGHT] * (to - from));
      }
    }
  }
};

struct Affine {
  double one = 0, x = 0, y = 0, residual = 0;
};

// Least squares of kappa by one, x and y: Gram-Schmidt, twice, the wider of x and y first. A column that the
// others explain to rounding (a curve along a line) is left out.
Affine fit_affine(const Columns& c) {
  constexpr double kDependent = 1e-13;
  const Column q0 = c.one / c.one.norm();
  const auto without = [](const Column& v, const Column& q) -> Column { return v - q * q.dot(v); };
  const Column cx = without(without(c.x, q0), q0), cy = without(without(c.y, q0), q0);
  const bool swap = cy.squaredNorm() > cx.squaredNorm();
  const Column& first = swap ? cy : cx;
  const Column& second = swap ? cx : cy;
  Column rest = without(c.kappa, q0);
  double f1 = 0, f2 = 0;
  if (const double n1 = first.norm(); n1 > 0) {
    const Column q1 = first / n1;
    const double along = q1.dot(second);
    const Column left = without(second - along * q1, q1);
    const double k1 = q1.dot(rest);
    rest -= k1 * q1;
    if (const double n2 = left.norm(); n2 > kDependent * n1) {
      const Column q2 = left / n2;
      const double k2 = q2.dot(rest);
      rest -= k2 * q2;
      f2 = k2 / n2;
    }
    f1 = (k1 - f2 * along) / n1;
  }
  Affine a;
  a.x = swap ? f2 : f1;
  a.y = swap ? f1 : f2;
  a.one = q0.dot(c.kappa - a.x * c.x - a.y * c.y) / c.one.norm();
  a.residual = rest.norm();
  return a;
}

// Legs in a unit frame, and what the batch kernels say of them: status, bound, and the panels that they take.
struct Kernel {
  hb_residual residual{};
  Nodes nodes;
};

Kernel kernel_of(const Bezier& b) {
  const Eigen::Vector2d d1 = b[1] - b[0], d2 = b[2] - b[0], d3 = b[3] - b[0];
  hb_legs legs{d1.x(), d1.y(), d2.x(), d2.y(), d3.x(), d3.y()};
  const double frame = hb_unit_frame(&legs);
  Kernel k;
  k.residual = hb_plain_residual(&legs, frame);
  if (!hb_wants_panels(k.residual.bound, k.residual.status)) {
    k.nodes.add_panel(-0.5, 0.5);
    return k;
  }
  k.residual = hb_graded_residual(&legs, frame);
  const hb_cubic cubic = hb_cubic_of_legs(&legs);
  const hb_speed_roots roots = hb_speed_roots_of(&cubic, 0);
  double from = -0.5;
  for (int i = 0; i < HB_MOST_PANELS && from < 0.5; ++i) {
    const double to = hb_panel_end(&roots, from);
    k.nodes.add_panel(from, to);
    from = to;
  }
  return k;
}

}  // namespace

LambdaResidual lambda_residual(const Bezier& b) {
  const Kernel kernel = kernel_of(b);
  LambdaResidual result;
  result.status = static_cast<ResidualStatus>(kernel.residual.status);
  if (result.status != ResidualStatus::kOk) return result;
  result.bound = kernel.residual.bound;
  // Rows sqrt(ds) (1, x, y | kappa), from the first point, in units of the polygon.
  const double polygon = (b[1] - b[0]).norm() + (b[2] - b[1]).norm() + (b[3] - b[2]).norm();
  const Bezier from_start{b[0] - b[0], b[1] - b[0], b[2] - b[0], b[3] - b[0]};
  const std::size_t count = kernel.nodes.t.size();
  Columns c(static_cast<Eigen::Index>(count));
  for (std::size_t n = 0; n < count; ++n) {
    const auto i = static_cast<Eigen::Index>(n);
    const BezierPoint p = evaluate(from_start, kernel.nodes.t[n]);
    const double root = std::sqrt(kernel.nodes.w[n] * p.d1.norm() / polygon);
    const Eigen::Vector2d r = p.p / polygon;
    c.one[i] = root;
    c.x[i] = root * r.x();
    c.y[i] = root * r.y();
    c.kappa[i] = root * curvature(p) * polygon;
  }
  const Affine fit = fit_affine(c);
  result.value = std::min(1.0, fit.residual / c.kappa.norm());
  result.lambda2 = fit.x / (polygon * polygon);
  result.lambda1 = -fit.y / (polygon * polygon);
  result.alpha = fit.one / polygon + result.lambda1 * b[0].y() - result.lambda2 * b[0].x();
  return result;
}

Elastica first_guess(const Bezier& b, const LambdaResidual& r) {
  const Eigen::Vector2d d = evaluate(b, 0).d1;
  Elastica e;
  e.x = b[0].x();
  e.y = b[0].y();
  e.theta = std::atan2(d.y(), d.x());
  e.kappa = r.alpha - r.lambda1 * e.y + r.lambda2 * e.x;
  e.lambda1 = r.lambda1;
  e.lambda2 = r.lambda2;
  e.length = arc_lengths(b, 32).back();
  return e;
}

}  // namespace hotblade::elastica

#include "gpu/curve/pair_frame.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "elastica/kernels/curve_pair.h"

namespace hotblade::gpu {
namespace {

using Eigen::Vector2d;
using Bezier = std::array<Vector2d, 4>;
using elastica::hausdorff_search::HausdorffRange;
using elastica::hausdorff_search::Point;

// Extents whose squares and cubes neither overflow nor vanish.
constexpr double kGreatestExtent = 1e140;

bool all_finite(const Bezier& b, const ElasticaState& e) {
  for (const double v : {e.x, e.y, e.theta, e.kappa, e.lambda1, e.lambda2, e.length}) {
    if (!std::isfinite(v)) return false;
  }
  return std::all_of(b.begin(), b.end(), [](const Vector2d& p) { return p.allFinite(); });
}

// The power of two that brings an extent into [1/2, 1).
double pair_scale(double extent) {
  int exponent = 0;
  (void)std::frexp(extent, &exponent);
  return extent > 0 ? std::ldexp(1.0, std::clamp(-exponent, -500, 500)) : 1;
}

void set_elastica(const ElasticaState& e, PairFrame& f) {
  const double c = std::cos(e.theta), s = std::sin(e.theta), length = e.length * f.scale;
  const double kappa = e.kappa / f.scale, l1 = e.lambda1 / f.scale / f.scale,
               l2 = e.lambda2 / f.scale / f.scale;
  const double lambda = std::hypot(l1, l2);
  // kappa^2/2 - (lambda1 cos + lambda2 sin) is constant along the curve, and |kappa'| <= |lambda|.
  const double crest = std::sqrt(kappa * kappa + 2 * std::max(0.0, lambda - (l1 * c + l2 * s)));
  f.omega = std::sqrt(crest * crest + lambda);
  const double bend = std::min(crest, std::abs(kappa) + lambda * length);
  // A straight one may be run through in one step.
  const double step = f.omega > HB_STEP_OMEGA / 4 ? HB_STEP_OMEGA / f.omega : 4;
  const double values[] = {kappa, l1, l2, step, c, s, length, bend};
  std::copy(std::begin(values), std::end(values), f.numbers.v + 8);
}

// The least power of two times `least` that reaches `wanted`.
int rounded_up(double wanted, int least) {
  double n = least;
  while (n < wanted && n < 4 * kMostPairSamples) n *= 2;
  return static_cast<int>(n);
}

class BezierSide {
 public:
  explicit BezierSide(const PairFrame& f) : v_(f.numbers.v) {}
  [[nodiscard]] Point at(double u) const {
    Point p;
    p.u = u;
    for (int axis = 0; axis < 2; ++axis) {
      const double* v = v_ + 4 * axis;
      p.p[axis] = ((v[3] * u + v[2]) * u + v[1]) * u + v[0];
      p.d1[axis] = (3 * v[3] * u + 2 * v[2]) * u + v[1];
      p.d2[axis] = 6 * v[3] * u + 2 * v[2];
    }
    return p;
  }
  // The second derivative is affine.
  [[nodiscard]] static double bend(const Point& a, const Point& b) {
    return std::max(a.d2.norm(), b.d2.norm());
  }

 private:
  const double* v_;
};

// The elastica by one step from the nearest of even nodes.
class ElasticaSide {
 public:
  explicit ElasticaSide(const PairFrame& f)
      : field_{f.numbers.v[8], f.numbers.v[9], f.numbers.v[10], f.numbers.v[11]},
        length_(f.numbers.v[14]),
        tension_(std::hypot(f.numbers.v[9], f.numbers.v[10])) {
    const int steps = 1 + static_cast<int>(length_ / field_.most_step);
    node_step_ = length_ / steps;
    hb_elastica_point p{0, 0, f.numbers.v[12], f.numbers.v[13]};
    for (int i = 0; i <= steps; ++i) {
      nodes_.push_back(p);
      hb_elastica_step(&field_, node_step_, &p);
    }
  }
  [[nodiscard]] Point at(double u) const {
    const double place = u * static_cast<double>(nodes_.size() - 1), node = std::round(place);
    hb_elastica_point q = nodes_[static_cast<std::size_t>(node)];
    hb_elastica_step(&field_, (place - node) * node_step_, &q);
    const double pull = length_ * length_ * hb_elastica_curvature(&field_, &q);
    return {u, {q.x, q.y}, length_ * Vector2d(q.c, q.s), pull * Vector2d(-q.s, q.c)};
  }
  // |kappa'| <= |lambda|.
  [[nodiscard]] double bend(const Point& a, const Point& b) const {
    const double slack = tension_ * length_ * length_ * length_ * std::abs(b.u - a.u);
    return 0.5 * (a.d2.norm() + b.d2.norm() + slack);
  }

 private:
  hb_elastica_field field_;
  double length_, tension_, node_step_ = 0;
  std::vector<hb_elastica_point> nodes_;
};

}  // namespace

PairFrame pair_frame(const Bezier& bezier, const ElasticaState& e, double tolerance) {
  PairFrame f;
  f.status = PairStatus::kInvalid;
  if (!all_finite(bezier, e) || e.length < 0) return f;
  const Vector2d start(e.x, e.y);
  double extent = e.length;
  for (const Vector2d& p : bezier) extent = std::max(extent, (p - start).lpNorm<Eigen::Infinity>());
  if (!(extent < kGreatestExtent)) return f;
  f.scale = pair_scale(extent);
  f.tolerance = tolerance * f.scale;
  for (int axis = 0; axis < 2; ++axis) {
    double b[4];
    for (std::size_t k = 0; k < 4; ++k) b[k] = (bezier[k][axis] - start[axis]) * f.scale;
    double* v = f.numbers.v + 4 * axis;
    v[0] = b[0];
    v[1] = 3 * (b[1] - b[0]);
    v[2] = 3 * ((b[2] - b[1]) - (b[1] - b[0]));
    v[3] = (b[3] - b[0]) - 3 * (b[2] - b[1]);
  }
  const double* v = f.numbers.v;
  f.bezier_bend =
      std::max(std::hypot(2 * v[2], 2 * v[6]), std::hypot(2 * v[2] + 6 * v[3], 2 * v[6] + 6 * v[7]));
  set_elastica(e, f);
  f.status = f.omega * f.numbers.v[14] <= kMostWinding ? PairStatus::kOk : PairStatus::kTooTight;
  return f;
}

int pair_panels(const PairFrame& f) {
  return rounded_up(f.omega * f.numbers.v[14], kLeastPairPanels);
}

// As many as suffice for curves that follow each other, by the third derivatives of kernels/curve_pair.h's
// bound; others take more in the next rounds, or the search.
int pair_samples(const PairFrame& f) {
  const double* v = f.numbers.v;
  const double length = v[14], bend = v[15] * length, tension = std::hypot(v[9], v[10]) * length * length;
  const double third =
      6 * std::hypot(v[3], v[7]) + (tension + bend * bend) * length + 3 * bend * f.bezier_bend;
  return rounded_up(std::cbrt(third / (16 * 0.5 * f.tolerance)), kLeastPairSamples);
}

HausdorffRange search_pair(const PairFrame& frame, double tolerance) {
  return elastica::hausdorff_search::both_ways(BezierSide(frame), ElasticaSide(frame), tolerance);
}

}  // namespace hotblade::gpu

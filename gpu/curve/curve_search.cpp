#include "gpu/curve/curve_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace hotblade::gpu {
namespace {

using Eigen::Vector2d;

// Pieces a cubic is cut into: more make the proofs' pieces gentler, fewer are searched faster.
constexpr int kCubicPieces = 16;

// B(u) = c0 + c1 u + c2 u^2 + c3 u^3.
struct Cubic {
  std::array<Vector2d, 4> c;

  [[nodiscard]] Vector2d value(double u) const { return ((c[3] * u + c[2]) * u + c[1]) * u + c[0]; }
  [[nodiscard]] Vector2d velocity(double u) const { return (3 * c[3] * u + 2 * c[2]) * u + c[1]; }
  [[nodiscard]] Vector2d acceleration(double u) const { return 6 * c[3] * u + 2 * c[2]; }
  // The acceleration is linear in u, so its size is largest at an end.
  [[nodiscard]] double largest_acceleration(double from, double to) const {
    return std::max(acceleration(from).norm(), acceleration(to).norm());
  }
  // The part of [from, to] as a curve over [0, 1].
  [[nodiscard]] Cubic part(double from, double to) const {
    const double h = to - from;
    return {{value(from), h * velocity(from), h * h / 2 * acceleration(from), h * h * h * c[3]}};
  }
};

Cubic cubic_of(const hb_curve_piece& p) {
  return {{Vector2d(p.from_x, p.from_y), Vector2d(p.c1_x, p.c1_y), Vector2d(p.c2_x, p.c2_y),
           Vector2d(p.c3_x, p.c3_y)}};
}

// |B'|^2 + (B - B(0)).B'' over [0, 1]: coefficients of powers, and of Bernstein polynomials.
std::array<double, 5> bend_powers(const Cubic& b) {
  const auto dot = [&](std::size_t i, std::size_t j) { return b.c[i].dot(b.c[j]); };
  return {dot(1, 1), 6 * dot(1, 2), 6 * dot(2, 2) + 12 * dot(1, 3), 20 * dot(2, 3), 15 * dot(3, 3)};
}
std::array<double, 5> bernstein(const std::array<double, 5>& powers) {
  constexpr double kChoose[5][5] = {
      {1, 0, 0, 0, 0}, {1, 1, 0, 0, 0}, {1, 2, 1, 0, 0}, {1, 3, 3, 1, 0}, {1, 4, 6, 4, 1}};
  std::array<double, 5> b{};
  for (std::size_t k = 0; k < 5; ++k) {
    for (std::size_t j = 0; j <= k; ++j) b[k] += kChoose[k][j] / kChoose[4][j] * powers[j];
  }
  return b;
}

double inverse(double squared_length) {
  return squared_length > std::numeric_limits<double>::min() ? 1 / squared_length : 0;
}

hb_curve_piece piece_of(const Cubic& b, double t, double dt, double size) {
  const Vector2d leg = b.c[1] + b.c[2] + b.c[3], first = b.acceleration(0), last = b.acceleration(1);
  const double bend_most = b.largest_acceleration(0, 1);
  hb_curve_piece p{};
  const auto set = [](const Vector2d& v, double& x, double& y) {
    x = v.x();
    y = v.y();
  };
  set(b.c[0], p.from_x, p.from_y);
  set(leg, p.leg_x, p.leg_y);
  set(b.c[1], p.c1_x, p.c1_y);
  set(b.c[2], p.c2_x, p.c2_y);
  set(b.c[3], p.c3_x, p.c3_y);
  set(first, p.first_x, p.first_y);
  set(last, p.last_x, p.last_y);
  p.inv = inverse(leg.squaredNorm());
  // A curve strays from its chord by at most an eighth of its largest acceleration.
  p.sag = bend_most / 8;
  const std::array<double, 5> powers = bend_powers(b), bend = bernstein(powers);
  std::copy(bend.begin(), bend.end(), p.bend);
  double sum = 0;
  for (const double a : powers) sum += std::abs(a);
  // Ten roundings of every term at most, and r = query - from is no longer than the distance and the piece.
  constexpr double kRounding = 64 * std::numeric_limits<double>::epsilon();
  p.guard0 = kRounding * (sum + bend_most * (b.c[1].norm() + b.c[2].norm() + b.c[3].norm()));
  p.guard1 = kRounding * bend_most;
  p.t = t;
  p.dt = dt;
  p.size = size;
  return p;
}

hb_curve_whole whole_of(const Cubic& b, double size) {
  hb_curve_whole whole{};
  whole.piece = piece_of(b, 0, 1, size);
  for (int i = 0; i < HB_CURVE_STARTS; ++i) {
    const Vector2d p = b.value(i / (HB_CURVE_STARTS - 1.0));
    whole.start_x[i] = p.x();
    whole.start_y[i] = p.y();
    whole.half_sq[i] = 0.5 * p.squaredNorm();
  }
  return whole;
}

template <typename Points>
double largest_coordinate(const Points& points, const Vector2d& origin, double size = 0) {
  for (const Vector2d& p : points) {
    if (!p.allFinite()) throw std::logic_error("CurveDistance: a control point is not finite");
    size = std::max(size, (p - origin).cwiseAbs().maxCoeff());
  }
  return size;
}

// A power of two that brings `size` below 1, so that squares of squares neither overflow nor vanish.
double scale_of(double size) {
  int exponent = 0;
  if (size > 0) std::frexp(size, &exponent);
  return std::ldexp(1.0, std::clamp(-exponent, -1000, 1000));
}

// Pieces that may hold a nearer point than the best are halved until the squared distance is convex over
// them, and there its minimum is found by halving and Newton's method.
class CarefulSearch {
 public:
  CarefulSearch(const CurvePieces& curve, const Vector2d& q, double rounding) : curve_(curve), q_(q) {
    const double largest = std::max(curve.pieces[0].size, q.cwiseAbs().maxCoeff());
    rounding_ = rounding * largest;
    far_ = largest > 1e100;
  }

  CurveNearest run() {
    // Starts of all pieces and the last one's end give a first best; the piece that can be nearest is
    // searched next, and leaves few of the others in question.
    thread_local std::vector<double> at_least_of;
    at_least_of.clear();
    for (const hb_curve_piece& p : curve_.pieces) {
      take(p);
      consider(0, -r_);
      const Vector2d leg(p.leg_x, p.leg_y);
      const double s = std::clamp(r_.dot(leg) * p.inv, 0.0, 1.0);
      at_least_of.push_back(length(r_ - s * leg) - p.sag);
    }
    consider(1, offset(1));
    const auto nearest = static_cast<std::size_t>(std::min_element(at_least_of.begin(), at_least_of.end()) -
                                                  at_least_of.begin());
    for (std::size_t k = 0; k <= curve_.pieces.size(); ++k) {
      const std::size_t i = k == 0 ? nearest : k - 1;
      if ((k > 0 && i == nearest) || out_of_reach(at_least_of[i])) continue;
      take(curve_.pieces[i]);
      look(0, 1);
    }
    return best_;
  }

 private:
  void take(const hb_curve_piece& p) {
    piece_ = &p;
    b_ = cubic_of(p);
    r_ = q_ - b_.c[0];
  }

  // Offset from the query, without the detour by the frame's origin.
  [[nodiscard]] Vector2d offset(double u) const { return ((b_.c[3] * u + b_.c[2]) * u + b_.c[1]) * u - r_; }

  // Without the detour of std::hypot where squares neither overflow nor lose the curve.
  [[nodiscard]] double length(const Vector2d& v) const { return far_ ? std::hypot(v.x(), v.y()) : v.norm(); }

  void consider(double u, const Vector2d& off) {
    const double d = length(off);
    if (d < best_.distance) best_ = {d, piece_->t + u * piece_->dt};
  }

  // A part that can gain no more than rounding is done with.
  [[nodiscard]] bool out_of_reach(double least) const { return least >= best_.distance - rounding_; }

  [[nodiscard]] double at_least(double from, double to) const {
    const Vector2d a = offset(from), leg = offset(to) - a;
    const double s = std::clamp(-a.dot(leg) * inverse(leg.squaredNorm()), 0.0, 1.0), width = to - from;
    const Vector2d foot = a + s * leg;
    return length(foot) - b_.largest_acceleration(from, to) * width * width / 8;
  }

  [[nodiscard]] bool convex(double from, double to) const {
    const Cubic part = b_.part(from, to);
    const std::array<double, 5> b = bernstein(bend_powers(part));
    const Vector2d r = r_ - (part.c[0] - b_.c[0]);
    const double first = r.dot(part.acceleration(0)), last = r.dot(part.acceleration(1));
    for (std::size_t k = 0; k < 5; ++k) {
      if (!(b[k] > first + 0.25 * static_cast<double>(k) * (last - first))) return false;
    }
    return true;
  }

  void minimise(double from, double to) {
    double low = from, high = to, u = 0.5 * (from + to);
    for (int n = 0; n < 100 && low < high; ++n) {
      const Vector2d x = offset(u), v = b_.velocity(u);
      const double slope = x.dot(v);
      (slope > 0 ? high : low) = u;
      double next = u - slope / (v.squaredNorm() + x.dot(b_.acceleration(u)));
      if (!(next > low && next < high)) next = 0.5 * (low + high);
      if (next == u) break;
      u = next;
    }
    consider(u, offset(u));
  }

  void look(double from, double to) {
    if (out_of_reach(at_least(from, to))) return;
    const double middle = 0.5 * (from + to);
    consider(middle, offset(middle));
    // At this width the sag is below 2^-60 of the curve's size.
    if (to - from < 0x1p-30) return;
    if (convex(from, to)) {
      minimise(from, to);
      return;
    }
    look(from, middle);
    look(middle, to);
  }

  const CurvePieces& curve_;
  const Vector2d q_;
  double rounding_ = 0;  // of a distance
  bool far_ = false;
  const hb_curve_piece* piece_ = nullptr;
  Cubic b_;
  Vector2d r_{0, 0};
  CurveNearest best_{std::numeric_limits<double>::infinity(), 0};
};

}  // namespace

CurvePieces pieces_of_cubic(const std::array<Vector2d, 4>& control) {
  CurvePieces curve;
  curve.origin = control[0];
  const double unscaled = largest_coordinate(control, curve.origin);
  curve.scale = scale_of(unscaled);
  const double size = curve.scale * unscaled;
  const Vector2d d0 = curve.scale * (control[1] - control[0]), d1 = curve.scale * (control[2] - control[1]),
                 d2 = curve.scale * (control[3] - control[2]);
  const Cubic b{{Vector2d::Zero(), 3 * d0, 3 * (d1 - d0), (d2 - d1) - (d1 - d0)}};
  curve.whole = whole_of(b, size);
  constexpr double kStep = 1.0 / kCubicPieces;
  for (int i = 0; i < kCubicPieces; ++i) {
    curve.pieces.push_back(piece_of(b.part(i * kStep, (i + 1) * kStep), i * kStep, kStep, size));
    curve.sag = std::max(curve.sag, curve.pieces.back().sag);
  }
  return curve;
}

CurvePieces pieces_of_quadratics(std::span<const std::array<Vector2d, 3>> chain) {
  if (chain.empty()) throw std::logic_error("CurveDistance: no quadratic");
  CurvePieces curve;
  curve.origin = chain[0][0];
  double unscaled = 0;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    unscaled = largest_coordinate(chain[i], curve.origin, unscaled);
    if (i > 0 && chain[i][0] != chain[i - 1][2]) {
      throw std::logic_error("CurveDistance: quadratic " + std::to_string(i) +
                             " does not begin where the one before ends");
    }
  }
  curve.scale = scale_of(unscaled);
  const double size = curve.scale * unscaled;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const Vector2d d0 = curve.scale * (chain[i][1] - chain[i][0]),
                   d1 = curve.scale * (chain[i][2] - chain[i][1]);
    const Cubic b{{curve.local(chain[i][0]), 2 * d0, d1 - d0, Vector2d::Zero()}};
    curve.pieces.push_back(piece_of(b, static_cast<double>(i), 1, size));
    curve.sag = std::max(curve.sag, curve.pieces.back().sag);
    if (chain.size() == 1) curve.whole = whole_of(b, size);
  }
  return curve;
}

CurveNearest nearest_by_search(const CurvePieces& curve, const Vector2d& q, double rounding) {
  return CarefulSearch(curve, q, rounding).run();
}

}  // namespace hotblade::gpu

#include "elastica/blade/stability.hpp"

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <limits>

#include "elastica/blade/end_map.hpp"
#include "elastica/curve/placement.hpp"

namespace hotblade::elastica {

namespace {

constexpr int kCells = 128;
constexpr std::size_t kInner = kCells - 1;
// A Rayleigh quotient that moves by less than this is right to its third power, far below what is asked for.
constexpr double kNearlySettled = 1e-3;

using Values = std::array<double, kInner>;

double dot(const Values& a, const Values& b) {
  double sum = 0;
  for (std::size_t i = 0; i < kInner; ++i) sum += a[i] * b[i];
  return sum;
}

void add(Values& to, double times, const Values& v) {
  for (std::size_t i = 0; i < kInner; ++i) to[i] += times * v[i];
}

void scale(Values& v, double by) {
  for (double& x : v) x *= by;
}

struct Discrete {
  Values diagonal;                    // of H times length^2; off-diagonal is -1/h^2
  std::array<Values, 2> constraints;  // orthonormal
  std::size_t rank = 0;
};

Discrete discretise(const ElasticaCurve& curve) {
  const Elastica& e = curve.elastica();
  const double h = 1.0 / kCells, l2 = e.length * e.length;
  const double middle = curve.at(0.5 * e.length).theta;
  // The force along and across the middle tangent.
  const Eigen::Vector2d force = force_along(e, middle) * l2;
  const double along = force.x(), across = force.y();
  Discrete d;
  for (std::size_t i = 0; i < kInner; ++i) {
    const double theta = curve.at(e.length * static_cast<double>(i + 1) * h).theta - middle;
    const double c = std::cos(theta), s = std::sin(theta);
    d.diagonal[i] = 2 / (h * h) - (along * c + across * s);
    d.constraints[0][i] = c;
    d.constraints[1][i] = s;
  }
  // On a straight blade the second constraint is empty: the end point cannot move along the chord to first
  // order.
  constexpr double kEmpty = 1e-7;
  auto& [first, second] = d.constraints;
  scale(first, 1 / std::sqrt(dot(first, first)));
  add(second, -dot(first, second), first);
  const double rest = std::sqrt(dot(second, second));
  d.rank = rest > kEmpty * std::sqrt(static_cast<double>(kInner)) ? 2 : 1;
  if (d.rank == 2) scale(second, 1 / rest);
  return d;
}

// H - sigma on the space of the constraints: the tridiagonal matrix eliminated, and the Schur complement of
// the constraints that border it.
class Shifted {
 public:
  Shifted(const Discrete& d, double sigma) : d_(d), reduced_(d.constraints) {
    double before = 0;
    for (std::size_t i = 0; i < kInner; ++i) {
      const double factor = i > 0 ? kOff * before : 0;
      double pivot = d.diagonal[i] - sigma - factor * kOff;
      // An exact zero pivot is moved by rounding's own size: sigma is then an eigenvalue of a leading block.
      if (pivot == 0) pivot = -kOff * 1e-16;
      if (pivot < 0) ++negative_;
      before = 1 / pivot;
      inverse_[i] = before;
      if (i == 0) continue;
      reduced_[0][i] -= factor * reduced_[0][i - 1];
      reduced_[1][i] -= factor * reduced_[1][i - 1];
    }
    for (std::size_t i = 0; i < kInner; ++i) {
      const double a = reduced_[0][i], b = reduced_[1][i], p = inverse_[i];
      schur_(0, 0) -= a * a * p;
      schur_(0, 1) -= a * b * p;
      schur_(1, 1) -= b * b * p;
    }
    schur_(1, 0) = schur_(0, 1);
  }

  // Number of eigenvalues below sigma: inertia of the bordered matrix (Sturm's sequence, Haynsworth's
  // additivity).
  [[nodiscard]] int eigenvalues_below() const {
    if (d_.rank == 1) return negative_ + (schur_(0, 0) < 0 ? 1 : 0) - 1;
    const double det = schur_.determinant();
    return negative_ + (det < 0 ? 1 : schur_.trace() < 0 ? 2 : 0) - 2;
  }

  // x with (H - sigma) x = v up to a multiple of the constraints, orthogonal to them.
  [[nodiscard]] Values solve(const Values& v) const {
    Values x = v;
    for (std::size_t i = 1; i < kInner; ++i) x[i] -= kOff * inverse_[i - 1] * x[i - 1];
    Eigen::Vector2d right(0, 0);
    for (std::size_t i = 0; i < kInner; ++i) {
      right[0] += reduced_[0][i] * inverse_[i] * x[i];
      right[1] += reduced_[1][i] * inverse_[i] * x[i];
    }
    Eigen::Vector2d held(0, 0);  // multipliers of the constraints
    if (d_.rank == 2) {
      const double det = schur_.determinant();
      held = Eigen::Vector2d(schur_(1, 1) * right[0] - schur_(0, 1) * right[1],
                             schur_(0, 0) * right[1] - schur_(0, 1) * right[0]) /
             -(det != 0 ? det : kTiny);
    } else {
      held[0] = -right[0] / (schur_(0, 0) != 0 ? schur_(0, 0) : kTiny);
    }
    for (std::size_t c = 0; c < d_.rank; ++c) add(x, -held[static_cast<Eigen::Index>(c)], reduced_[c]);
    double after = 0;
    for (std::size_t i = kInner; i-- > 0;) {
      x[i] = (x[i] - kOff * after) * inverse_[i];
      after = x[i];
    }
    return x;
  }

 private:
  static constexpr double kOff = -static_cast<double>(kCells) * kCells;
  static constexpr double kTiny = 1e-300;  // sigma is an eigenvalue: any large multiple of its vector will do
  const Discrete& d_;
  Values inverse_;                 // of the pivots
  std::array<Values, 2> reduced_;  // constraints after the elimination
  Eigen::Matrix2d schur_ = Eigen::Matrix2d::Zero();
  int negative_ = 0;
};

// A start with a share of every low mode, of either symmetry.
Values start_vector(const Discrete& d) {
  Values v;
  for (std::size_t i = 0; i < kInner; ++i) {
    const double s = static_cast<double>(i + 1) / kCells;
    v[i] = s * (1 - s) * (1 + 2.3 * s * s * s);
  }
  for (std::size_t c = 0; c < d.rank; ++c) add(v, -dot(v, d.constraints[c]), d.constraints[c]);
  scale(v, 1 / std::sqrt(dot(v, v)));
  return v;
}

// `nearby` is a guess, or not a number.
double smallest_eigenvalue(const ElasticaCurve& curve, double nearby) {
  const Elastica& e = curve.elastica();
  if (!(e.length > 0)) return 0;
  const Discrete d = discretise(curve);
  const double load = std::hypot(e.lambda1, e.lambda2) * e.length * e.length;
  // The free operator's eigenvalues lie above -load; with two constraints the smallest is at most the third
  // of the unloaded clamped string, 9 pi^2, plus the load.
  double low = -load - 1, high = 100 + load;
  if (std::isfinite(nearby)) {
    // Neighbouring waypoints differ by less, mostly.
    const double reach = 1e-3 * (1 + std::abs(nearby));
    for (const double at : {nearby - reach, nearby + reach}) {
      if (at > low && at < high) (Shifted(d, at).eigenvalues_below() > 0 ? high : low) = at;
    }
  }
  constexpr double kRelative = 1e-6;
  const auto slack = [](double a, double b) { return kRelative * (1 + std::abs(a) + std::abs(b)); };
  // Rayleigh quotients bound the smallest eigenvalue from above and converge with the third power; inertia
  // says whether it is the smallest one, and halving goes on where it is not.
  Values v = start_vector(d);
  double sigma = low, last = high;
  bool third_power = false;  // sigma is a quotient itself
  while (high - low > slack(low, high)) {
    const Shifted shifted(d, sigma);
    (shifted.eigenvalues_below() > 0 ? high : low) = sigma;
    v = shifted.solve(v);
    const double size = std::sqrt(dot(v, v));
    if (!(size > 0) || !std::isfinite(size)) {
      v = start_vector(d);
      sigma = 0.5 * (low + high);
      third_power = false;
      continue;
    }
    scale(v, 1 / size);
    double energy = 0, before = 0;
    for (std::size_t i = 0; i < kInner; ++i) {
      const double slope = (v[i] - before) * kCells;
      energy += slope * slope + (d.diagonal[i] - 2.0 * kCells * kCells) * v[i] * v[i];
      before = v[i];
    }
    const double quotient = energy + before * before * kCells * kCells;
    const bool settled = third_power && std::abs(quotient - last) < kNearlySettled * (1 + std::abs(quotient));
    last = quotient;
    third_power = quotient > low && quotient < high + slack(quotient, high);
    if (!third_power) {
      sigma = 0.5 * (low + high);
      continue;
    }
    const double below = quotient - 0.5 * slack(quotient, quotient);
    if (settled) {
      if (below <= low || Shifted(d, below).eigenvalues_below() == 0) return quotient;
      high = below;
      sigma = 0.5 * (low + high);
      third_power = false;
      continue;
    }
    sigma = quotient;
  }
  // A quotient there is far closer than both are to each other.
  return last > low - slack(last, low) && last < high + slack(last, high) ? last : 0.5 * (low + high);
}

}  // namespace

double stability_margin(const Elastica& e) {
  return stability_margin(e, std::numeric_limits<double>::quiet_NaN());
}

double stability_margin(const Elastica& e, double nearby) {
  return e.length > 0 ? smallest_eigenvalue(ElasticaCurve(e), nearby) : 0;
}

double stability_margin(const ElasticaCurve& curve) {
  return smallest_eigenvalue(curve, std::numeric_limits<double>::quiet_NaN());
}

std::optional<double> first_conjugate_point(const Elastica& elastica, double furthest) {
  if (!(furthest > 0)) return std::nullopt;
  Elastica start = elastica;
  start.length = furthest;
  // The index only grows along the curve, and of the fields at the pieces' ends the first with one is near
  // the place.
  double stable = 0, unstable = 0;
  for (const JacobiFields& f : jacobi_fields(start)) {
    if (f.index > 0) {
      unstable = f.s;
      break;
    }
    stable = f.s;
  }
  if (unstable == 0) return std::nullopt;
  constexpr double kExact = 1e-9;
  while (unstable - stable > kExact * furthest) {
    start.length = 0.5 * (stable + unstable);
    (end_map(start).index > 0 ? unstable : stable) = start.length;
  }
  return 0.5 * (stable + unstable);
}

}  // namespace hotblade::elastica

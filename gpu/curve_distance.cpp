#include "gpu/curve_distance.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "gpu/cubic_lanes.hpp"

namespace hotblade::gpu {
namespace {

using Eigen::Vector2d;

// Points of one task, whose unsure ones are settled while they are in the cache.
constexpr std::size_t kBlock = 2048;

Vector2d value(const CubicChords& c, double t) {
  const auto k = [&](int i) { return Vector2d(c.c[i][0], c.c[i][1]); };
  return ((k(3) * t + k(2)) * t + k(1)) * t + k(0);
}
Vector2d velocity(const CubicChords& c, double t) {
  const auto k = [&](int i) { return Vector2d(c.c[i][0], c.c[i][1]); };
  return (3 * k(3) * t + 2 * k(2)) * t + k(1);
}
Vector2d acceleration(const CubicChords& c, double t) {
  return {6 * c.c[3][0] * t + 2 * c.c[2][0], 6 * c.c[3][1] * t + 2 * c.c[2][1]};
}
// The acceleration is linear in t, so its size is largest at an end.
double largest_acceleration(const CubicChords& c, double from, double to) {
  return std::max(acceleration(c, from).norm(), acceleration(c, to).norm());
}

// |B'|^2 + B.B'' over [from, to] by Bernstein coefficients.
std::array<double, 5> bend(const CubicChords& c, double from, double to) {
  const auto dot = [&](int i, int j) { return c.c[i][0] * c.c[j][0] + c.c[i][1] * c.c[j][1]; };
  std::array<double, 5> a{dot(1, 1), 6 * dot(1, 2), 6 * dot(2, 2) + 12 * dot(1, 3), 20 * dot(2, 3),
                          15 * dot(3, 3)};
  // In powers of t - from, then of (t - from) / (to - from).
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 4; j > i; --j) a[j - 1] += from * a[j];
  }
  const double width = to - from;
  double power = 1;
  for (double& coefficient : a) {
    coefficient *= power;
    power *= width;
  }
  constexpr double kChoose[5][5] = {
      {1, 0, 0, 0, 0}, {1, 1, 0, 0, 0}, {1, 2, 1, 0, 0}, {1, 3, 3, 1, 0}, {1, 4, 6, 4, 1}};
  std::array<double, 5> b{};
  for (std::size_t k = 0; k < 5; ++k) {
    for (std::size_t j = 0; j <= k; ++j) b[k] += kChoose[k][j] / kChoose[4][j] * a[j];
  }
  return b;
}

struct Best {
  double distance = std::numeric_limits<double>::infinity(), t = 0;
};

// Branch and bound: parts of the curve that may hold a nearer point than the best are halved until the
// squared distance is convex over them, and there its minimum is found by halving and Newton's method.
class CarefulSearch {
 public:
  CarefulSearch(const CubicChords& chords, const Vector2d& q) : c_(chords), q_(q) {
    double size = q.cwiseAbs().maxCoeff();
    for (const auto& from : c_.from) size = std::max({size, std::abs(from[0]), std::abs(from[1])});
    rounding_ = CubicDistance::kErrorRel / 8 * size;
  }

  Best run() {
    consider(0);
    consider(1);
    for (int i = 0; i < HOTBLADE_CHORDS; ++i) {
      look(static_cast<double>(i) / HOTBLADE_CHORDS, (i + 1.0) / HOTBLADE_CHORDS);
    }
    return best_;
  }

 private:
  void consider(double t) {
    const double d = (value(c_, t) - q_).norm();
    if (d < best_.distance) best_ = {d, t};
  }

  // Half the derivative of the squared distance.
  double slope(double t) const { return (value(c_, t) - q_).dot(velocity(c_, t)); }

  bool convex(double from, double to) const {
    const std::array<double, 5> b = bend(c_, from, to);
    const double first = q_.dot(acceleration(c_, from)), last = q_.dot(acceleration(c_, to));
    for (std::size_t k = 0; k < 5; ++k) {
      if (!(b[k] > first + 0.25 * static_cast<double>(k) * (last - first))) return false;
    }
    return true;
  }

  void minimise(double from, double to) {
    double low = from, high = to, t = 0.5 * (from + to);
    for (int n = 0; n < 100 && low < high; ++n) {
      const double f = slope(t);
      (f > 0 ? high : low) = t;
      const double bend = velocity(c_, t).squaredNorm() + (value(c_, t) - q_).dot(acceleration(c_, t));
      double next = t - f / bend;
      if (!(next > low && next < high)) next = 0.5 * (low + high);
      if (next == t) break;
      t = next;
    }
    consider(t);
  }

  void look(double from, double to) {
    const Vector2d a = value(c_, from), leg = value(c_, to) - a;
    const double sq = leg.squaredNorm(), width = to - from;
    const double s = sq > 0 ? std::clamp((q_ - a).dot(leg) / sq, 0.0, 1.0) : 0;
    const double chord = (a + s * leg - q_).norm();
    // A part that can gain no more than rounding is done with.
    if (chord - largest_acceleration(c_, from, to) * width * width / 8 >= best_.distance - rounding_) return;
    consider(from + s * width);
    // At this width the sag is below 2^-60 of the curve's size.
    if (width < 0x1p-30) return;
    if (convex(from, to)) {
      minimise(from, to);
      return;
    }
    look(from, 0.5 * (from + to));
    look(0.5 * (from + to), to);
  }

  const CubicChords& c_;
  Vector2d q_;
  double rounding_ = 0;  // of a distance
  Best best_;
};

NearestOnCubic nearest_on_cubic() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl")) {
    return nearest_on_cubic_avx512;
  }
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return nearest_on_cubic_avx2;
#endif
  return nearest_on_cubic_baseline;
}

}  // namespace

CubicChords make_chords(const std::array<Vector2d, 4>& p) {
  CubicChords c{};
  const Vector2d coefficients[4] = {Vector2d::Zero(), 3 * (p[1] - p[0]), 3 * ((p[2] - p[1]) - (p[1] - p[0])),
                                    (p[3] - p[2]) - 2 * (p[2] - p[1]) + (p[1] - p[0])};
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < 2; ++k) c.c[i][k] = coefficients[i][k];
  }
  constexpr double kStep = 1.0 / HOTBLADE_CHORDS;
  for (int i = 0; i < HOTBLADE_CHORDS; ++i) {
    const Vector2d from = value(c, i * kStep), leg = value(c, (i + 1) * kStep) - from;
    const double sq = leg.squaredNorm();
    for (int k = 0; k < 2; ++k) {
      c.from[i][k] = from[k];
      c.leg[i][k] = leg[k];
    }
    c.inv[i] = sq > std::numeric_limits<double>::min() ? 1 / sq : 0;
    const double first = std::max(0.0, (i - 1) * kStep), last = std::min(1.0, (i + 2) * kStep);
    const std::array<double, 5> b = bend(c, first, last);
    std::copy(b.begin(), b.end(), c.bend[i]);
    for (int k = 0; k < 2; ++k) {
      c.first[i][k] = acceleration(c, first)[k];
      c.last[i][k] = acceleration(c, last)[k];
    }
    // A curve strays from its chord by at most an eighth of its largest acceleration times the step squared.
    c.sag = std::max(c.sag, largest_acceleration(c, i * kStep, (i + 1) * kStep) * kStep * kStep / 8);
  }
  return c;
}

CubicDistance::CubicDistance(const std::array<Vector2d, 4>& control) : origin_(control[0]) {
  for (const Vector2d& p : control) {
    if (!p.allFinite()) throw std::logic_error("CubicDistance: a control point is not finite");
  }
  chords_ = make_chords(control);
}

std::size_t CubicDistance::query(std::span<const double> x, std::span<const double> y,
                                 std::span<double> distance, std::span<double> t) const {
  if (y.size() != x.size() || distance.size() != x.size() || t.size() != x.size()) {
    throw std::logic_error("CubicDistance::query: spans of different sizes");
  }
  const NearestOnCubic fast = nearest_on_cubic();
  std::atomic<std::size_t> careful = 0;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, x.size(), kBlock), [&](const auto& range) {
    std::array<unsigned, kBlock + 8> unsure;
    for (std::size_t first = range.begin(); first < range.end(); first += kBlock) {
      const std::size_t n = std::min(kBlock, range.end() - first);
      const std::size_t count = fast(chords_, &x[first], &y[first], origin_.x(), origin_.y(), n,
                                     &distance[first], &t[first], unsure.data());
      careful += count;
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t at = first + unsure[i];
        const Vector2d q = Vector2d(x[at], y[at]) - origin_;
        const Best best = q.allFinite() ? CarefulSearch(chords_, q).run()
                                        : Best{std::numeric_limits<double>::quiet_NaN(),
                                               std::numeric_limits<double>::quiet_NaN()};
        distance[at] = best.distance;
        t[at] = best.t;
      }
    }
  });
  return careful;
}

}  // namespace hotblade::gpu

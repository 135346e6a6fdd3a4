// One step along an elastica with its variational equations, by the classical fourth-order rule of Runge and
// Kutta, on a type of number that stands for several curves or several sides of one at once. Internal to
// sweep_curve.cpp, sweep_walk.cpp and sweep_lanes.cpp: always inlined.
#pragma once

#include <cmath>
#include <cstddef>

#include "elastica/kernels/lanes.hpp"

namespace hotblade::pipeline::sweep_step {

// Up to here the series below are off by 1e-10; a division takes as long as ten products. They cost a fifth
// of the library's functions, which take over beyond: of blades on their way to a fit.
inline constexpr double kSmallAngle = 0.5;

// Newton's way to a nearest point: no farther at once than the curve's series reach in two steps, and not
// where it would lead away, beyond the centre of curvature. A distance changes by the square of what its foot
// is off.
inline constexpr int kNearestSteps = 30;
inline constexpr double kLongestNearest_mm = 60, kNearEnough_mm = 1e-4, kLeastBent = 0.3;

template <typename T>
HOTBLADE_INLINE T small_cosine(const T& square) {
  return 1 - square * (1 / 2.0) *
                 (1 - square * (1 / 12.0) * (1 - square * (1 / 30.0) * (1 - square * (1 / 56.0))));
}
template <typename T>
HOTBLADE_INLINE T small_sine(const T& angle, const T& square) {
  return angle * (1 - square * (1 / 6.0) *
                          (1 - square * (1 / 20.0) * (1 - square * (1 / 42.0) * (1 - square * (1 / 72.0)))));
}

// Cosines and sines of `count` angles, one in each lane of T.
template <typename T>
struct Turn {
  T c, n;
};
template <int count, typename T>
HOTBLADE_INLINE Turn<T> turn_of(const T& angle) {
  const T square = angle * angle;
  Turn<T> turn{small_cosine(square), small_sine(angle, square)};
  const auto large = square > kSmallAngle * kSmallAngle;
  long found = 0;
  for (int i = 0; i < count; ++i) found |= large[i];
  if (found == 0) return turn;
  for (int i = 0; i < count; ++i) {
    if (!large[i]) continue;
    turn.c[i] = std::cos(angle[i]);
    turn.n[i] = std::sin(angle[i]);
  }
  return turn;
}

// What bends each curve.
template <typename T>
struct Bends {
  T kappa, tension1, tension2;
};

// Cosine and sine of each direction.
template <typename T>
struct Tangents {
  T c, n;

  [[nodiscard]] HOTBLADE_INLINE Tangents turned(const Turn<T>& by) const {
    return {by.c * c - by.n * n, by.n * c + by.c * n};
  }
};

// x, y, theta, and each one's derivatives by kappa, tension1, tension2 behind it.
template <typename T>
struct State {
  T v[12];

  [[nodiscard]] HOTBLADE_INLINE const T& x() const { return v[0]; }
  [[nodiscard]] HOTBLADE_INLINE const T& y() const { return v[4]; }
  [[nodiscard]] HOTBLADE_INLINE const T& theta() const { return v[8]; }
  [[nodiscard]] HOTBLADE_INLINE State moved(const State& by, const T& way) const {
    State t;
    for (std::size_t i = 0; i < 12; ++i) t.v[i] = v[i] + way * by.v[i];
    return t;
  }
};

// By arc length; `t` is the state's direction.
template <typename T>
HOTBLADE_INLINE State<T> rate(const State<T>& s, const Tangents<T>& t, const Bends<T>& bend) {
  State<T> r;
  r.v[0] = t.c;
  r.v[4] = t.n;
  r.v[8] = bend.kappa + bend.tension2 * s.x() - bend.tension1 * s.y();
  for (std::size_t i = 1; i < 4; ++i) {
    r.v[i] = -t.n * s.v[8 + i];
    r.v[4 + i] = t.c * s.v[8 + i];
    r.v[8 + i] = bend.tension2 * s.v[i] - bend.tension1 * s.v[4 + i];
  }
  r.v[9] += 1;
  r.v[10] -= s.y();
  r.v[11] += s.x();
  return r;
}

// A step of h, of `count` curves; `t` is the state's direction before and after.
template <int count, typename T>
HOTBLADE_INLINE State<T> stepped(const State<T>& s, Tangents<T>& t, const Bends<T>& bend, const T& h) {
  const T half = h * (1 / 2.0), sixth = h * (1 / 6.0);
  const State<T> a = rate(s, t, bend), on_a = s.moved(a, half);
  const State<T> b = rate(on_a, t.turned(turn_of<count>(on_a.theta() - s.theta())), bend),
                 on_b = s.moved(b, half);
  const State<T> c = rate(on_b, t.turned(turn_of<count>(on_b.theta() - s.theta())), bend),
                 on_c = s.moved(c, h);
  const State<T> d = rate(on_c, t.turned(turn_of<count>(on_c.theta() - s.theta())), bend);
  State<T> next;
  for (std::size_t i = 0; i < 12; ++i) next.v[i] = s.v[i] + sixth * (a.v[i] + 2 * (b.v[i] + c.v[i]) + d.v[i]);
  t = t.turned(turn_of<count>(next.theta() - s.theta()));
  return next;
}

}  // namespace hotblade::pipeline::sweep_step

// The lanes of cubic_nearest.h, compiled once for each instruction set; see mesh_search.h for what the
// including file may use.
#pragma once

#include "gpu/cubic_lanes.hpp"

namespace hotblade::gpu {
namespace {

constexpr int kLanes = 8;
typedef double Real __attribute__((vector_size(8 * kLanes)));
typedef long long Mask __attribute__((vector_size(8 * kLanes)));

inline Real broadcast(double a) {
  return Real{} + a;
}

inline Real root(Real v) {
  Real r;
  for (int i = 0; i < kLanes; ++i) r[i] = __builtin_sqrt(v[i]);
  return r;
}

inline Real larger(Real a, Real b) {
  return a > b ? a : b;
}
inline Real smaller(Real a, Real b) {
  return a < b ? a : b;
}

// What is known of eight queries.
struct Eight {
  Real distance, t;
  Mask unsure;
};

struct Foot {
  Real distance_sq, t, chord;
  Mask rival;
};

inline Foot nearest_chord(const CubicChords& c, Real x, Real y) {
  Real sq[HOTBLADE_CHORDS];
  Foot foot = {broadcast(__builtin_inf()), Real{}, Real{}, Mask{}};
  for (int i = 0; i < HOTBLADE_CHORDS; ++i) {
    const Real rx = x - c.from[i][0], ry = y - c.from[i][1];
    const Real s = smaller(larger((rx * c.leg[i][0] + ry * c.leg[i][1]) * c.inv[i], Real{}), broadcast(1));
    const Real dx = rx - s * c.leg[i][0], dy = ry - s * c.leg[i][1];
    sq[i] = dx * dx + dy * dy;
    const Mask nearer = sq[i] < foot.distance_sq;
    foot.distance_sq = nearer ? sq[i] : foot.distance_sq;
    foot.t = nearer ? s + static_cast<double>(i) : foot.t;
    foot.chord = nearer ? broadcast(i) : foot.chord;
  }
  const Real reach = (root(foot.distance_sq) + 2 * c.sag) * (1 + 0x1p-48);
  for (int i = 0; i < HOTBLADE_CHORDS; ++i) {
    const Real apart = foot.chord - static_cast<double>(i);
    foot.rival |= (sq[i] <= reach * reach) & (apart * apart > 1.5);
  }
  return foot;
}

// table[chord] a lane.
template <int kStride>
inline Real pick(const double* table, Mask chord) {
  Real v;
  for (int i = 0; i < kLanes; ++i) v[i] = table[kStride * chord[i]];
  return v;
}

// Whether the squared distance is convex over the chord and its neighbours.
inline Mask is_convex(const CubicChords& c, Real chord, Real x, Real y) {
  const Mask i = __builtin_convertvector(chord, Mask);
  const Real first = x * pick<2>(&c.first[0][0], i) + y * pick<2>(&c.first[0][1], i);
  const Real last = x * pick<2>(&c.last[0][0], i) + y * pick<2>(&c.last[0][1], i);
  Mask convex = pick<5>(&c.bend[0][0], i) > first;
  for (int k = 1; k < 5; ++k) {
    convex &= pick<5>(&c.bend[0][k], i) > first + 0.25 * k * (last - first);
  }
  return convex;
}

inline Real value(const CubicChords& c, int k, Real t) {
  return ((c.c[3][k] * t + c.c[2][k]) * t + c.c[1][k]) * t + c.c[0][k];
}

inline Eight nearest_of_eight(const CubicChords& c, Real x, Real y) {
  const Foot foot = nearest_chord(c, x, y);
  const double h = 1.0 / HOTBLADE_CHORDS;
  const Real low = larger((foot.chord - 1.0) * h, Real{}),
             high = smaller((foot.chord + 2.0) * h, broadcast(1));
  Real t = foot.t * h, step = {};
  for (int n = 0; n < HOTBLADE_NEWTON_STEPS; ++n) {
    const Real px = value(c, 0, t) - x, py = value(c, 1, t) - y;
    const Real vx = (3 * c.c[3][0] * t + 2 * c.c[2][0]) * t + c.c[1][0];
    const Real vy = (3 * c.c[3][1] * t + 2 * c.c[2][1]) * t + c.c[1][1];
    const Real ax = 6 * c.c[3][0] * t + 2 * c.c[2][0], ay = 6 * c.c[3][1] * t + 2 * c.c[2][1];
    const Real bend = vx * vx + vy * vy + px * ax + py * ay;
    const Real next = smaller(larger(t - (px * vx + py * vy) / bend, low), high);
    step = next - t;
    t = next;
  }
  const Real px = value(c, 0, t) - x, py = value(c, 1, t) - y;
  // The last step's square is what is left: 1e-9 leaves rounding. NaN is unsure.
  const Mask settled = (step < 1e-9) & (step > -1e-9) & is_convex(c, foot.chord, x, y) & ~foot.rival;
  return {root(px * px + py * py), t, ~settled};
}

inline std::size_t nearest_on_cubic(const CubicChords& c, const double* x, const double* y, double ox,
                                    double oy, std::size_t n, double* distance, double* t, unsigned* unsure) {
  std::size_t count = 0;
  for (std::size_t first = 0; first < n; first += kLanes) {
    const std::size_t lanes = n - first < kLanes ? n - first : kLanes;
    Real qx = {}, qy = {};
    __builtin_memcpy(&qx, x + first, lanes * sizeof(double));
    __builtin_memcpy(&qy, y + first, lanes * sizeof(double));
    const Eight eight = nearest_of_eight(c, qx - ox, qy - oy);
    __builtin_memcpy(distance + first, &eight.distance, lanes * sizeof(double));
    __builtin_memcpy(t + first, &eight.t, lanes * sizeof(double));
    for (std::size_t i = 0; i < lanes; ++i) {
      unsure[count] = static_cast<unsigned>(first + i);
      count += eight.unsure[i] != 0;
    }
  }
  return count;
}

}  // namespace
}  // namespace hotblade::gpu

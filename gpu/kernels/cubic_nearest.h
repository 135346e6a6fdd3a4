// A cubic Bezier prepared for nearest-point queries, as it lies in memory on the host and on a device.
//
// The curve is cut into chords once. A query takes the nearest chord; no point of the curve lies farther from its
// chord than `sag`, so every other chord that is over 2 sag farther is out. When the chords left are neighbours and
// the squared distance is convex over them, Newton's method from the chord's foot finds the one minimum there.
// Otherwise the query is left to the careful search (gpu/curve_distance.cpp).
#ifndef HOTBLADE_GPU_KERNELS_CUBIC_NEAREST_H
#define HOTBLADE_GPU_KERNELS_CUBIC_NEAREST_H

#define HOTBLADE_CHORDS 16

// B(t) = c0 + c1 t + c2 t^2 + c3 t^3, coefficients for x and y. Chord i runs from `from` along `leg`, inv is 1 / |leg|^2
// or 0. Half the second derivative of the squared distance to q is |B'|^2 + (B - q).B''; over chord i and its
// neighbours its Bernstein coefficients, between the least and largest of which it lies, are
// bend[i][k] - q.((1 - k/4) first[i] + k/4 last[i]).
struct CubicChords {
  double c[4][2];
  double from[HOTBLADE_CHORDS][2], leg[HOTBLADE_CHORDS][2], inv[HOTBLADE_CHORDS];
  double bend[HOTBLADE_CHORDS][5], first[HOTBLADE_CHORDS][2], last[HOTBLADE_CHORDS][2];
  double sag;
};

// Newton steps: the foot is off by a share h^2 of a chord of length h, and each step squares that; the fourth leaves
// rounding.
#define HOTBLADE_NEWTON_STEPS 4

#endif

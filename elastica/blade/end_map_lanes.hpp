// The interface between end_map.cpp and its sources per instruction set: plain numbers.
#pragma once

namespace hotblade::elastica {

// A curve and how many pieces it is run over, of one length each.
struct FieldRun {
  double x, y, theta, kappa, lambda1, lambda2, piece;
  int pieces;
};

// At the end of a piece: the point, theta and curvature, and by (kappa, lambda1, lambda2) at the start the
// derivatives of x, y and theta and the rates of the last.
struct FieldState {
  double x, y, theta, kappa;
  double dx[3], dy[3], dtheta[3], rates[3];
  int zeros;            // of d theta/d kappa between start and end
  double largest_turn;  // from the start
};

// Writes the states at the ends of the last `count` pieces.
using RunFields = void (*)(const FieldRun& run, FieldState* out, int count);

struct EndMapKernels {
  RunFields to_rounding, in_searches;  // Exactness
};

// The second is the first where the target is not x86-64.
extern const EndMapKernels kEndMapBaseline, kEndMapAvx2;

}  // namespace hotblade::elastica

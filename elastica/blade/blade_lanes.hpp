// The interface between blade_batch.cpp and its sources per instruction set: plain arrays over n blades, each
// scaled to length 1 and moved to the origin with its tangent along x.
#pragma once

#include <stddef.h>

namespace hotblade::elastica {

struct UnitBlades {
  const double *kappa, *lambda1, *lambda2;
};

// `points` even points on [first, last] of each blade, blade after blade. Where `turn` is null so are `cos`
// and `sin`.
struct PartLanes {
  UnitBlades blades;
  const double *first, *last;
  size_t points;
  double *x = nullptr, *y = nullptr, *cos = nullptr, *sin = nullptr, *turn = nullptr;
};

struct MarginLanes {
  UnitBlades blades;
  double* margin;
  double* scratch;
};

struct DroopLanes {
  UnitBlades blades;
  const double* load;
  const double *first, *last;  // nodes, whole numbers
  double upright, torsion;
  double *shift, *twist, *stable;  // stable: 1 or 0
  double* scratch;
  // Where not null, what they are at the nodes 1 to kDroopCells: of blade i at node k [(k - 1) * stride + i].
  double *shifts = nullptr, *twists = nullptr;
  size_t stride = 0;
};

// The number of doubles that the kernels write intermediate values to, for the widest lanes; they are
// aligned to kScratchAlignment.
inline constexpr size_t kScratchDoubles = 11 * 256 * 8, kScratchAlignment = 64;
// Cells of stability.hpp and gravity.hpp.
inline constexpr int kMarginCells = 128, kDroopCells = 256;

struct BladeKernels {
  void (*parts)(const PartLanes& batch, size_t n);
  void (*margins)(const MarginLanes& batch, size_t n);
  void (*droops)(const DroopLanes& batch, size_t n);
};

// All three are the baseline where the target is not x86-64.
extern const BladeKernels kBladeBaseline, kBladeAvx2, kBladeAvx512;

}  // namespace hotblade::elastica

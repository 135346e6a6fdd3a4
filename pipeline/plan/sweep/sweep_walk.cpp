#include "pipeline/plan/sweep/sweep_walk.hpp"

#include <algorithm>
#include <array>

#include "elastica/kernels/lanes.hpp"
#include "elastica/kernels/simd.hpp"
#include "pipeline/plan/sweep/sweep_step.hpp"

namespace hotblade::pipeline {

namespace {

using elastica::lanes::kLanes;
using elastica::lanes::Lanes;
using sweep_step::Bends;
using sweep_step::State;
using sweep_step::Tangents;

// One curve: its nodes on both sides of the middle one.
struct Walk {
  Bend bend;
  double step_mm = 0;
  int before = 0, behind = 0;
  SweepPoint* middle = nullptr;
};

// Node `i` of each curve that has one.
HOTBLADE_INLINE void store(const State<Lanes>& s, const Tangents<Lanes>& t, const Bends<Lanes>& bends,
                           std::span<const Walk> walks, int i, int side) {
  const Lanes kappa = bends.kappa + bends.tension2 * s.x() - bends.tension1 * s.y();
  Lanes by[3];
  for (int k = 0; k < 3; ++k) by[k] = bends.tension2 * s.v[1 + k] - bends.tension1 * s.v[5 + k];
  by[0] += 1;
  by[1] -= s.y();
  by[2] += s.x();
  int lane = 0;
  for (const Walk& walk : walks) {
    if (i <= (side < 0 ? walk.before : walk.behind)) {
      SweepPoint& p = *(side < 0 ? walk.middle - i : walk.middle + i);
      p.position = {s.x()[lane], s.y()[lane]};
      p.tangent = {t.c[lane], t.n[lane]};
      p.theta = s.theta()[lane];
      p.kappa = kappa[lane];
      for (int k = 0; k < 3; ++k) {
        p.by_bend(0, k) = s.v[1 + k][lane];
        p.by_bend(1, k) = s.v[5 + k][lane];
        p.theta_by_bend[k] = s.v[9 + k][lane];
        p.kappa_by_bend[k] = by[k][lane];
      }
    }
    ++lane;
  }
}

// At most kLanes curves. One that ends before the others is walked on and not looked at.
HOTBLADE_INLINE void walk_body(std::span<const Walk> walks) {
  Bends<Lanes> bends{};
  Lanes step{};
  int most[2] = {0, 0};
  for (int lane = 0; lane < kLanes; ++lane) {
    const Walk& walk = walks[std::min(static_cast<std::size_t>(lane), walks.size() - 1)];
    bends.kappa[lane] = walk.bend.kappa;
    bends.tension1[lane] = walk.bend.tension1;
    bends.tension2[lane] = walk.bend.tension2;
    step[lane] = walk.step_mm;
    most[0] = std::max(most[0], walk.before);
    most[1] = std::max(most[1], walk.behind);
  }
  for (const int side : {-1, 1}) {
    const Lanes h = side < 0 ? -step : step;
    State<Lanes> state{};
    Tangents<Lanes> tangents{Lanes{} + 1, Lanes{}};
    for (int i = 0;; ++i) {
      store(state, tangents, bends, walks, i, side);
      if (i >= most[side < 0 ? 0 : 1]) break;
      state = sweep_step::stepped<kLanes>(state, tangents, bends, h);
    }
  }
}

#if defined(__x86_64__)
HOTBLADE_AVX512 void walk_512(std::span<const Walk> walks) {
  walk_body(walks);
}
HOTBLADE_AVX2 void walk_256(std::span<const Walk> walks) {
  walk_body(walks);
}
#endif

void walk_some(std::span<const Walk> walks, elastica::Simd simd) {
#if defined(__x86_64__)
  if (simd == elastica::Simd::kAvx512) return walk_512(walks);
  if (simd == elastica::Simd::kAvx2) return walk_256(walks);
#endif
  static_cast<void>(simd);
  walk_body(walks);
}

}  // namespace

void SweepWalk::walk(std::span<SweepCurve> curves, elastica::Simd simd) {
  std::array<Walk, kLanes> walks;
  for (std::size_t first = 0; first < curves.size(); first += kLanes) {
    const std::size_t count = std::min<std::size_t>(kLanes, curves.size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      SweepCurve& c = curves[first + i];
      const int nodes = c.before_ + c.behind_ + 1;
      c.nodes_.resize(static_cast<std::size_t>(nodes));
      walks[i] = {c.bend_, c.step_mm_, c.before_, c.behind_, c.nodes_.data() + c.before_};
    }
    walk_some(std::span(walks).first(count), simd);
  }
}

}  // namespace hotblade::pipeline

// The walk along many curves, eight at a time (elastica/kernels/lanes.hpp). Internal to sweep_curve.cpp.
#pragma once

#include <span>

#include "pipeline/plan/sweep/sweep_curve.hpp"

namespace hotblade::pipeline {

class SweepWalk {
 public:
  // Fills the curves' nodes: the same, to the bit, as SweepCurve::walk().
  static void walk(std::span<SweepCurve> curves, elastica::Simd simd);
};

}  // namespace hotblade::pipeline

// Random blades of a swept family.
#pragma once

#include <random>

#include "pipeline/plan/sweep/sweep_curve.hpp"

namespace hotblade::pipeline {

// Bends of formwork blades: radii from 120 mm, tensions that change them by as much over half a metre.
class Bends {
 public:
  Bend next() { return {number(1.0 / 120), number(2e-5), number(2e-5)}; }
  double number(double most) { return std::uniform_real_distribution<double>(-most, most)(random_); }

 private:
  std::mt19937 random_{7};
};

}  // namespace hotblade::pipeline

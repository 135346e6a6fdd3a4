// Ribs to fit elastica to.
#pragma once

#include <Eigen/Core>
#include <random>
#include <vector>

#include "elastica/curve/elastica.hpp"
#include "elastica/fit/fit.hpp"

namespace hotblade::elastica {

constexpr FitOptions kNoPull{0, nullptr, 0};

inline std::vector<Eigen::Vector2d> positions(const Elastica& e, int n) {
  std::vector<Eigen::Vector2d> q;
  for (const CurvePoint& p : sample(e, n)) q.push_back(p.position());
  return q;
}

// As blades cut them: up to 2 rad of turning, with and without an inflection, 300 to 1200 mm.
inline Elastica random_rib(std::mt19937_64& random) {
  std::uniform_real_distribution<double> u(-1, 1);
  const double length = 750 + 450 * u(random);
  return {500 * u(random),
          500 * u(random),
          3 * u(random),
          2 * u(random) / length,
          8 * u(random) / (length * length),
          8 * u(random) / (length * length),
          length};
}

}  // namespace hotblade::elastica

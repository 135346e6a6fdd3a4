// Points to an elastica by way of its chain of quadratics, against the elastica itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "elastica/quadratic/quadratic_chain.hpp"
#include "gpu/curve/curve_distance.hpp"

namespace hotblade::gpu {
namespace {

using Eigen::Vector2d;
using elastica::Elastica;
using elastica::ElasticaCurve;

// Newton's method from every local minimum of dense samples.
double brute_force(const ElasticaCurve& curve, const Vector2d& q) {
  constexpr int kSamples = 2000;
  const double length = curve.elastica().length;
  std::vector<double> d;
  for (int i = 0; i <= kSamples; ++i) d.push_back((curve.at(length * i / kSamples).position() - q).norm());
  double best = *std::min_element(d.begin(), d.end());
  for (std::size_t i = 1; i < kSamples; ++i) {
    if (d[i] > d[i - 1] || d[i] > d[i + 1]) continue;
    double s = length * static_cast<double>(i) / kSamples;
    for (int n = 0; n < 6; ++n) {
      const elastica::CurvePoint p = curve.at(s);
      const Vector2d r = p.position() - q, t = p.tangent(), normal(-t.y(), t.x());
      s = std::clamp(s - r.dot(t) / (1 + p.kappa * r.dot(normal)), 0.0, length);
      best = std::min(best, (curve.at(s).position() - q).norm());
    }
  }
  return best;
}

class ElasticaDistanceOnEachBackend : public testing::TestWithParam<Backend> {};

TEST_P(ElasticaDistanceOnEachBackend, IsWithinTheChainsBound) {
  std::mt19937_64 rng(1);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int n = 0; n < 12; ++n) {
    const Elastica e{u(rng), u(rng), 3 * u(rng), 4 * u(rng), 12 * u(rng), 12 * u(rng), 1 + 0.5 * u(rng)};
    const ElasticaCurve curve(e);
    std::vector<double> x, y;
    for (int i = 0; i < 40; ++i) {
      x.push_back(e.x + 1.5 * u(rng));
      y.push_back(e.y + 1.5 * u(rng));
    }
    std::vector<double> distance(x.size()), t(x.size());
    for (const double tolerance : {1e-2, 1e-5, 1e-8}) {
      const elastica::QuadraticChain chain = elastica::quadratic_chain(e, tolerance);
      const CurveDistance to = CurveDistance::to_quadratics(chain.pieces, GetParam());
      (void)to.query(x, y, distance, t);
      for (std::size_t i = 0; i < x.size(); ++i) {
        EXPECT_NEAR(distance[i], brute_force(curve, {x[i], y[i]}), chain.bound + 1e-12);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, ElasticaDistanceOnEachBackend, testing::Values(Backend::kCpu, Backend::kOpenCl),
                         [](const auto& instantiation) {
                           return instantiation.param == Backend::kCpu ? "Cpu" : "OpenCl";
                         });

}  // namespace
}  // namespace hotblade::gpu

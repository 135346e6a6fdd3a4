// Curves and samples eight at a time against one at a time, on every instruction set that this machine runs.
#include "pipeline/plan/sweep/sweep_lanes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "elastica/kernels/simd_pin.hpp"
#include "tests/pipeline/plan/sweep/bends.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector2d;
using elastica::Simd;

class SweepLanes : public ::testing::TestWithParam<Simd> {
 protected:
  void SetUp() override {
    if (!supported(GetParam())) GTEST_SKIP() << "not on this machine";
  }
};

INSTANTIATE_TEST_SUITE_P(Every, SweepLanes, ::testing::Values(Simd::kBaseline, Simd::kAvx2, Simd::kAvx512),
                         [](const ::testing::TestParamInfo<Simd>& simd) {
                           return std::string(elastica::name(simd.param));
                         });

// Of gentle ones and of some that turn by a radian in a step, of several reaches.
std::vector<SweepCurve::Ask> many_asked() {
  Bends bends;
  std::vector<SweepCurve::Ask> asked;
  for (int i = 0; i < 61; ++i) {
    Bend bend = bends.next();
    if (i % 7 == 3) bend.kappa = 0.05;
    asked.push_back({bend, 200.0 + 37 * (i % 5)});
  }
  return asked;
}

TEST_P(SweepLanes, WalkEachCurveAsIfAlone) {
  const std::vector<SweepCurve::Ask> asked = many_asked();
  const std::vector<SweepCurve> curves = SweepCurve::all(asked, GetParam());
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const SweepCurve alone(asked[i].bend, asked[i].reach_mm);
    ASSERT_EQ(curves[i].nodes().size(), alone.nodes().size());
    for (std::size_t n = 0; n < alone.nodes().size(); ++n) {
      const SweepPoint &a = curves[i].nodes()[n], &b = alone.nodes()[n];
      ASSERT_EQ(a.position, b.position) << i << " " << n;
      ASSERT_EQ(a.tangent, b.tangent) << i << " " << n;
      ASSERT_EQ(a.theta, b.theta) << i << " " << n;
      ASSERT_EQ(a.kappa, b.kappa) << i << " " << n;
      ASSERT_EQ(a.by_bend, b.by_bend) << i << " " << n;
      ASSERT_EQ(a.theta_by_bend, b.theta_by_bend) << i << " " << n;
      ASSERT_EQ(a.kappa_by_bend, b.kappa_by_bend) << i << " " << n;
    }
  }
}

// Samples up to 15 mm off a curve, some beyond its ends; their feet are sought from some mm off.
struct Sampled {
  SweepState state;
  std::vector<SweepSample> samples;
  std::vector<double> feet;
};

constexpr double kSampledX_mm = 31;

Sampled sampled(const SweepCurve& curve, int count, Bends& bends) {
  Sampled s;
  s.state = {bends.number(20), bends.number(0.4), curve.bend()};
  const Eigen::Rotation2Dd turn(s.state.theta);
  for (int i = 0; i < count; ++i) {
    const double at = bends.number(1.1 * curve.reach_mm());
    const SweepPoint p = curve.at(at);
    const Vector2d q =
        turn * (p.position + bends.number(15) * p.normal()) + Vector2d(kSampledX_mm, s.state.y);
    s.samples.push_back({q, 1 - std::abs(bends.number(0.5))});
    s.feet.push_back(at + bends.number(10));
  }
  return s;
}

TEST_P(SweepLanes, SayOfEachSampleWhatIsSaidOfItAlone) {
  Bends bends;
  int count = 0;
  for (const SweepCurve& curve : SweepCurve::all(many_asked(), GetParam())) {
    const Sampled s = sampled(curve, ++count % 19 + 1, bends);
    std::vector<SampleTerm> terms(s.samples.size());
    sample_terms(s.samples, s.state, curve, kSampledX_mm, s.feet, terms, GetParam());
    for (std::size_t i = 0; i < terms.size(); ++i) {
      const SampleTerm alone = sample_term(s.samples[i], s.state, curve, kSampledX_mm, s.feet[i]);
      ASSERT_EQ(terms[i].foot_mm, alone.foot_mm) << count << " " << i;
      ASSERT_EQ(terms[i].away_mm, alone.away_mm) << count << " " << i;
      ASSERT_EQ(terms[i].by, alone.by) << count << " " << i;
      ASSERT_EQ(terms[i].by_point, alone.by_point) << count << " " << i;
    }
  }
}

// The sums of a section, distance by distance, by std::pow.
TEST_P(SweepLanes, SumWhatTheSamplesSay) {
  Bends bends;
  int count = 0;
  for (const SweepCurve& curve : SweepCurve::all(many_asked(), GetParam())) {
    const Sampled s = sampled(curve, ++count % 19 + 1, bends);
    const DistancePower power{2 << count % 4, 3.5, 300};
    std::vector<double> feet = s.feet, away(s.samples.size());
    const DistanceSums sums =
        distance_sums(s.samples, s.state, curve, kSampledX_mm, power, feet, away, GetParam());
    double value = 0, most = 0;
    ByState gradient = ByState::Zero();
    Eigen::Matrix<double, 5, 5> matrix = Eigen::Matrix<double, 5, 5>::Zero();
    for (std::size_t i = 0; i < away.size(); ++i) {
      const SampleTerm t = sample_term(s.samples[i], s.state, curve, kSampledX_mm, s.feet[i]);
      ASSERT_EQ(t.away_mm, away[i]);
      ASSERT_EQ(t.foot_mm, feet[i]);
      const double e = power.exponent, size = std::abs(t.away_mm),
                   scale = std::pow(power.scale_mm, 2 - e) / power.samples;
      value += scale * std::pow(size, e);
      gradient += scale * e * std::pow(size, e - 1) * std::copysign(1, t.away_mm) * t.by;
      matrix += scale * e * (e - 1) * std::pow(size, e - 2) * t.by * t.by.transpose();
      most = std::max(most, size);
    }
    EXPECT_EQ(sums.max_mm, most);
    EXPECT_NEAR(sums.value, value, 1e-12 * value);
    EXPECT_LT((sums.gradient - gradient).norm(), 1e-12 * gradient.norm() + 1e-12 * value);
    EXPECT_LT((sums.matrix - matrix).norm(), 1e-12 * matrix.norm());
    const DistancePower::Weight weight = power.of(away[0]);
    const double e = power.exponent, scaled = std::pow(std::abs(away[0]) / 3.5, e - 2) / 300;
    EXPECT_NEAR(weight.value, scaled * away[0] * away[0], 1e-12 * weight.value);
    EXPECT_NEAR(weight.first, e * scaled * away[0], 1e-12 * std::abs(weight.first));
    EXPECT_NEAR(weight.second, e * (e - 1) * scaled, 1e-12 * weight.second);
  }
}

}  // namespace
}  // namespace hotblade::pipeline

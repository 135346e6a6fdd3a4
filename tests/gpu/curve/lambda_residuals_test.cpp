// The residuals of every backend against the one-by-one routine of the elastica room.
#include "gpu/curve/lambda_residuals.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "elastica/bezier/lambda_residual.hpp"
#include "tests/elastica/bezier/residual_cubics.hpp"
#include "tests/elastica/bezier/residual_oracle.hpp"

namespace hotblade::gpu {
namespace {

using Eigen::Vector2d;
using Controls = std::array<Vector2d, 4>;

std::vector<Controls> random_curves(std::size_t n, unsigned seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<Controls> curves(n);
  for (Controls& c : curves) {
    const Vector2d at(500 * u(rng), 500 * u(rng));
    const double scale = std::pow(10, 4 * u(rng));
    for (Vector2d& p : c) {
      const double x = u(rng);
      p = at + scale * Vector2d(x, u(rng));
    }
  }
  return curves;
}

struct Residuals {
  std::vector<double> e;
  std::vector<ResidualStatus> status;
  bool operator==(const Residuals&) const = default;
};
Residuals ask(const LambdaResiduals& residuals, const std::vector<Controls>& curves) {
  Residuals answers{std::vector<double>(curves.size()), std::vector<ResidualStatus>(curves.size())};
  residuals.query(curves, answers.e, answers.status);
  return answers;
}

class LambdaResidualsOnEachBackend : public testing::TestWithParam<Backend> {
 protected:
  void SetUp() override {
    const LambdaResiduals residuals(GetParam());
    (void)ask(residuals, random_curves(1, 1));
    if (residuals.used().backend != GetParam()) GTEST_SKIP() << residuals.used().reason;
  }
};

TEST_P(LambdaResidualsOnEachBackend, MatchTheOneByOneRoutine) {
  const LambdaResiduals residuals(GetParam());
  for (const std::size_t n : {1, 7, 8, 2500}) {
    const auto curves = random_curves(n, static_cast<unsigned>(n));
    const Residuals answers = ask(residuals, curves);
    for (std::size_t i = 0; i < n; ++i) {
      const elastica::LambdaResidual expected = elastica::lambda_residual(curves[i]);
      EXPECT_EQ(static_cast<int>(answers.status[i]), static_cast<int>(expected.status)) << i;
      // A nearly straight or pointed curve's coordinates do not determine it better.
      EXPECT_NEAR(answers.e[i], expected.value, 1e-9) << i;
    }
  }
}

TEST_P(LambdaResidualsOnEachBackend, AreWithinTheirBoundsNearCuspsToo) {
  elastica::RandomCubics cubics(5);
  std::vector<Controls> curves(400);
  for (Controls& c : curves) c = cubics.next();
  std::vector<double> e(curves.size()), bound(curves.size());
  std::vector<ResidualStatus> status(curves.size());
  LambdaResiduals(GetParam()).query(curves, e, status, bound);
  for (std::size_t i = 0; i < curves.size(); ++i) {
    ASSERT_EQ(static_cast<int>(status[i]), static_cast<int>(elastica::lambda_residual(curves[i]).status))
        << i;
    if (status[i] != ResidualStatus::kOk) {
      EXPECT_EQ(bound[i], 0) << i;
      continue;
    }
    EXPECT_LE(std::abs(e[i] - elastica::ResidualOracle(curves[i]).value()), bound[i]) << i;
    EXPECT_LE(bound[i], 1e-4) << i;
  }
}

TEST_P(LambdaResidualsOnEachBackend, TellCurvesThatHaveNoResidual) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Controls> curves{
      {{{0, 0}, {1, 0}, {2, 0}, {3, 0}}},   {{{0, 0}, {1, 1}, {0, 1}, {1, 0}}},
      {{{0, 0}, {0, 0}, {1, 1}, {2, 0}}},   {{{1, 1}, {1, 1}, {1, 1}, {1, 1}}},
      {{{0, 0}, {1, nan}, {2, 1}, {3, 0}}}, {{{0, 0}, {1, 1e150}, {2, 1}, {3, 0}}},
      {{{0, 0}, {1, 1}, {2, 1}, {3, 0}}}};
  const Residuals answers = ask(LambdaResiduals(GetParam()), curves);
  using enum ResidualStatus;
  EXPECT_EQ(answers.status, (std::vector{kStraight, kCusp, kCusp, kCusp, kNotFinite, kNotFinite, kOk}));
  for (std::size_t i = 0; i + 1 < curves.size(); ++i) EXPECT_EQ(answers.e[i], 0);
  EXPECT_GT(answers.e.back(), 0);
}

TEST_P(LambdaResidualsOnEachBackend, DoNotDependOnTheNumberOfThreads) {
  const auto curves = random_curves(5003, 3);
  const auto on = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return ask(LambdaResiduals(GetParam()), curves);
  };
  const Residuals one = on(1);
  EXPECT_TRUE(on(2) == one);
}

TEST_P(LambdaResidualsOnEachBackend, AnswerNoneForNoneAndRefuseSpansThatDiffer) {
  const LambdaResiduals residuals(GetParam());
  EXPECT_TRUE(ask(residuals, {}).e.empty());
  std::vector<double> e(2);
  std::vector<ResidualStatus> status(1);
  EXPECT_THROW(residuals.query(random_curves(1, 1), e, status), std::logic_error);
  e.resize(1);
  std::vector<double> bound(2);
  EXPECT_THROW(residuals.query(random_curves(1, 1), e, status, bound), std::logic_error);
}

INSTANTIATE_TEST_SUITE_P(, LambdaResidualsOnEachBackend, testing::Values(Backend::kCpu, Backend::kOpenCl),
                         [](const auto& instantiation) {
                           return instantiation.param == Backend::kCpu ? "Cpu" : "OpenCl";
                         });

}  // namespace
}  // namespace hotblade::gpu

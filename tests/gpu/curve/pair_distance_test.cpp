// Pairs in bulk on every backend against the one-pair routines of the elastica room and against dense
// samples.
#include "gpu/curve/pair_distance.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "elastica/bezier/curve_distance.hpp"
#include "elastica/fit/fit_bezier.hpp"
#include "elastica/kernels/simd.hpp"
#include "gpu/curve/pair_lanes.hpp"

namespace hotblade::gpu {
namespace {

using Eigen::Vector2d;
using elastica::Bezier;
using elastica::Elastica;

struct Pairs {
  std::vector<Bezier> beziers;
  std::vector<ElasticaState> elastica;
  void add(const Bezier& b, const Elastica& e) {
    beziers.push_back(b);
    elastica.push_back({e.x, e.y, e.theta, e.kappa, e.lambda1, e.lambda2, e.length});
  }
  [[nodiscard]] Elastica state(std::size_t i) const {
    const ElasticaState& e = elastica[i];
    return {e.x, e.y, e.theta, e.kappa, e.lambda1, e.lambda2, e.length};
  }
  [[nodiscard]] std::size_t size() const { return beziers.size(); }
};

struct Answers {
  std::vector<PairDistance> pairs;
  std::size_t careful = 0;
};

Answers ask(const Pairs& pairs, double tolerance, Backend backend) {
  Answers answers{std::vector<PairDistance>(pairs.size())};
  answers.careful = PairDistances(backend).query(pairs.beziers, pairs.elastica, tolerance, answers.pairs);
  return answers;
}

bool same_bits(const PairDistance& a, const PairDistance& b) {
  const double x[] = {a.l2, a.h1, a.hausdorff, a.hausdorff_error},
               y[] = {b.l2, b.h1, b.hausdorff, b.hausdorff_error};
  return std::memcmp(x, y, sizeof x) == 0 && a.status == b.status;
}

Bezier random_bezier(std::mt19937_64& random) {
  std::uniform_real_distribution<double> u(-1, 1);
  Bezier b;
  for (Vector2d& p : b) {
    const double x = u(random);
    p = {x, u(random)};
  }
  return b;
}

Elastica random_elastica(std::mt19937_64& random) {
  std::uniform_real_distribution<double> u(-1, 1);
  const double x = u(random), y = u(random), theta = 3 * u(random), kappa = 4 * u(random),
               l1 = 20 * u(random);
  return {x, y, theta, kappa, l1, 20 * u(random), 1.5};
}

// Nothing to do with each other.
Pairs strangers(std::size_t n, unsigned seed) {
  std::mt19937_64 random(seed);
  Pairs pairs;
  for (std::size_t i = 0; i < n; ++i) {
    const Bezier b = random_bezier(random);
    pairs.add(b, random_elastica(random));
  }
  return pairs;
}

// Rib-like cubics and the elastica fitted to them.
Pairs ribs(std::size_t n, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<Bezier> beziers(n);
  for (Bezier& b : beziers) {
    const double a = 300 + 60 * u(random), c = 150 * u(random), d = 700 + 60 * u(random);
    b = {Vector2d(0, 0), {a, c}, {d, 150 * u(random)}, {1000, 0}};
  }
  const auto fits = elastica::fit_bezier_elastica(beziers);
  Pairs pairs;
  for (std::size_t i = 0; i < n; ++i) pairs.add(beziers[i], fits[i].elastica);
  return pairs;
}

// A quadrature of its own: the trapezoidal rule over the Bezier's arc length.
std::pair<double, double> dense_differences(const Bezier& b, const Elastica& e) {
  constexpr int kSteps = 4000;
  const std::vector<double> arc = elastica::arc_lengths(b, kSteps);
  const elastica::ElasticaCurve curve(e);
  double square = 0, angle = 0, before[2] = {0, 0};
  for (int i = 0; i <= kSteps; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const elastica::BezierPoint p = elastica::evaluate(b, static_cast<double>(i) / kSteps);
    const elastica::CurvePoint q = curve.at(e.length * arc[k] / arc.back());
    const double turn = std::remainder(std::atan2(p.d1.y(), p.d1.x()) - q.theta, 2 * std::numbers::pi);
    const double now[2] = {(p.p - q.position()).squaredNorm(), turn * turn};
    if (i > 0) {
      square += (arc[k] - arc[k - 1]) * (now[0] + before[0]) / 2;
      angle += (arc[k] - arc[k - 1]) * (now[1] + before[1]) / 2;
    }
    std::copy(now, now + 2, before);
  }
  const double length = arc.back(), l2 = square / (length * length * length);
  return {std::sqrt(l2), std::sqrt(l2 + angle / length)};
}

double directed(const std::vector<Vector2d>& from, const std::vector<Vector2d>& to) {
  double worst = 0;
  for (const Vector2d& p : from) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Vector2d& q : to) nearest = std::min(nearest, (p - q).squaredNorm());
    worst = std::max(worst, nearest);
  }
  return std::sqrt(worst);
}

// The Hausdorff distance of dense samples, and how far it may be off.
std::pair<double, double> dense_hausdorff(const Bezier& b, const Elastica& e) {
  constexpr int kDense = 1000;
  std::vector<Vector2d> p, q;
  for (int i = 0; i <= kDense; ++i) p.push_back(elastica::evaluate(b, static_cast<double>(i) / kDense).p);
  for (const elastica::CurvePoint& c : elastica::sample(e, kDense + 1)) q.push_back(c.position());
  double gap = e.length / kDense;
  for (std::size_t i = 1; i < p.size(); ++i) gap = std::max(gap, (p[i] - p[i - 1]).norm());
  return {std::max(directed(p, q), directed(q, p)), gap};
}

class PairDistancesOnEachBackend : public testing::TestWithParam<Backend> {
 protected:
  void SetUp() override {
    const PairDistances pairs(GetParam());
    (void)pairs.query({}, {}, 1, {});
    if (pairs.used().backend != GetParam()) GTEST_SKIP() << pairs.used().reason;
  }
};

TEST_P(PairDistancesOnEachBackend, OfRibsAreThoseOfTheOnePairRoutine) {
  const Pairs pairs = ribs(300, 1);
  const double tolerance = 0.01;  // of ribs 1000 long
  const Answers answers = ask(pairs, tolerance, GetParam());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const PairDistance& a = answers.pairs[i];
    ASSERT_EQ(a.status, PairStatus::kOk) << i;
    EXPECT_LE(a.hausdorff_error, tolerance * (1 + 1e-9));
    const elastica::CurveDistance one = elastica::distance(pairs.beziers[i], pairs.state(i));
    const auto [l2, h1] = dense_differences(pairs.beziers[i], pairs.state(i));
    EXPECT_NEAR(a.l2, l2, 5e-5 * l2 + 1e-9) << i;
    EXPECT_NEAR(a.h1, h1, 5e-5 * h1 + 1e-9) << i;
    // Its 200 intervals are less exact.
    EXPECT_NEAR(a.l2, one.l2, 5e-4 * one.l2) << i;
    EXPECT_NEAR(a.h1, one.h1, 5e-4 * one.h1) << i;
    EXPECT_GE(a.hausdorff, one.hausdorff - one.hausdorff_error - 1e-7) << i;
    EXPECT_LE(a.hausdorff - a.hausdorff_error, one.hausdorff + 1e-7) << i;
  }
  // The kernels alone bound curves that follow each other.
  EXPECT_LT(answers.careful, pairs.size() / 10);
}

TEST_P(PairDistancesOnEachBackend, OfStrangersAreThoseOfTheOnePairRoutine) {
  const Pairs pairs = strangers(60, 2);
  const Answers answers = ask(pairs, 1e-4, GetParam());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const PairDistance& a = answers.pairs[i];
    ASSERT_EQ(a.status, PairStatus::kOk) << i;
    EXPECT_LE(a.hausdorff_error, 1e-4 * (1 + 1e-9));
    const auto [l2, h1] = dense_differences(pairs.beziers[i], pairs.state(i));
    // Narrow bends are resolved less finely than gentle ones.
    EXPECT_NEAR(a.l2, l2, 2e-4 * l2) << i;
    EXPECT_NEAR(a.h1, h1, 1e-2 * h1) << i;
    const elastica::HausdorffBounds h = elastica::hausdorff(pairs.beziers[i], pairs.state(i), 1e-6);
    EXPECT_GE(a.hausdorff, h.lower - 1e-9) << i;
    EXPECT_LE(a.hausdorff - a.hausdorff_error, h.upper + 1e-9) << i;
  }
}

TEST_P(PairDistancesOnEachBackend, BoundTheDistanceOfDenseSamplesAtEveryTolerance) {
  Pairs pairs = strangers(8, 3);
  // Near ones, whose feet the kernels follow.
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> u(-1, 1);
  const Pairs fitted = ribs(8, 5);
  for (std::size_t i = 0; i < fitted.size(); ++i) {
    Bezier b = fitted.beziers[i];
    Elastica e = fitted.state(i);
    for (Vector2d& p : b) p /= 1000;
    e = {e.x / 1000 + 0.05 * u(random),
         e.y / 1000 + 0.05 * u(random),
         e.theta + 0.1 * u(random),
         e.kappa * 1e3,
         e.lambda1 * 1e6,
         e.lambda2 * 1e6,
         e.length / 1000 * (1 + 0.1 * u(random))};
    pairs.add(b, e);
  }
  std::vector<std::pair<double, double>> dense;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    dense.push_back(dense_hausdorff(pairs.beziers[i], pairs.state(i)));
  for (const double tolerance : {1e-1, 1e-2, 1e-3, 1e-5, 1e-8}) {
    const Answers answers = ask(pairs, tolerance, GetParam());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const PairDistance& a = answers.pairs[i];
      // Number 3's bounds close slowly, where a foot jumps; the one-pair search's too.
      if (tolerance >= 1e-3 || (tolerance >= 1e-5 && i != 3)) {
        EXPECT_EQ(a.status, PairStatus::kOk) << i << ' ' << tolerance;
      }
      EXPECT_EQ(a.status == PairStatus::kOk, a.hausdorff_error <= tolerance * (1 + 1e-9)) << i;
      EXPECT_GE(a.hausdorff, dense[i].first - dense[i].second) << i << ' ' << tolerance;
      EXPECT_LE(a.hausdorff - a.hausdorff_error, dense[i].first + dense[i].second) << i << ' ' << tolerance;
    }
  }
}

TEST_P(PairDistancesOnEachBackend, OfCurvesInSpecialPositionAreKnown) {
  const double pi = std::numbers::pi;
  const Bezier line{Vector2d(0, 0), {1, 0}, {2, 0}, {3, 0}};
  Pairs pairs;
  pairs.add(line, {0, 0, 0, 0, 0, 0, 3});                                      // coincident
  pairs.add(line, {0, 0.25, 0, 0, 0, 0, 3});                                   // parallel
  pairs.add(line, {0, 0, 0, 0, 0, 0, 4});                                      // longer
  pairs.add(line, {0, 0, 0, 0, 0, 0, 1});                                      // shorter
  pairs.add(line, {3, 0, pi, 0, 0, 0, 3});                                     // run through backwards
  pairs.add({Vector2d(0, 0), {3, 0}, {0, 0}, {3, 0}}, {0, 0, 0, 0, 0, 0, 3});  // folds over
  pairs.add(line, {1, 2, 0, 0, 0, 0, 0});                                      // to a point
  const double far = std::hypot(2, 2);
  const double expected[] = {0, 0.25, 1, 2, 0, 0, far};
  for (const double tolerance : {1e-2, 1e-4, 1e-8}) {
    const Answers answers = ask(pairs, tolerance, GetParam());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const PairDistance& a = answers.pairs[i];
      EXPECT_GE(a.hausdorff, expected[i]) << i;
      EXPECT_LE(a.hausdorff - a.hausdorff_error, expected[i]) << i;
      EXPECT_EQ(a.status == PairStatus::kOk, a.hausdorff_error <= tolerance * (1 + 1e-9)) << i;
      // The fold would need more samples at 1e-8 than the search takes.
      if (tolerance > 1e-6 || i != 5) {
        EXPECT_EQ(a.status, PairStatus::kOk) << i;
      }
    }
  }
  const Answers answers = ask(pairs, 1e-4, GetParam());
  EXPECT_NEAR(answers.pairs[0].l2, 0, 1e-12);
  EXPECT_NEAR(answers.pairs[0].h1, 0, 1e-12);
  EXPECT_NEAR(answers.pairs[1].l2, 0.25 / 3, 1e-12);
  EXPECT_NEAR(answers.pairs[1].h1, 0.25 / 3, 1e-12);
  // Int (1 - 2 u)^2 du = 1/3, and every tangent turned by pi.
  EXPECT_NEAR(answers.pairs[4].l2, std::sqrt(1.0 / 3), 1e-12);
  EXPECT_NEAR(answers.pairs[4].h1, std::sqrt(1.0 / 3 + pi * pi), 1e-9);
}

TEST_P(PairDistancesOnEachBackend, OfCuspsAndLoopsHold) {
  Pairs pairs;
  const Bezier cusp{Vector2d(0, 0), {1, 1}, {0, 1}, {1, 0}}, loop{Vector2d(0, 0), {2, 1}, {-1, 1}, {1, 0}};
  const Bezier no_edge{Vector2d(0, 0), {0, 0}, {1, 1}, {2, 0}};
  std::mt19937_64 random(6);
  for (const Bezier& b : {cusp, loop, no_edge}) {
    pairs.add(b, {0, 0, 0.8, -2, 3, 1, 2});
    pairs.add(b, {0, 0, 0.8, -9, 0, 0, 2});  // almost three turns of a circle
    pairs.add(b, random_elastica(random));
  }
  const Answers answers = ask(pairs, 1e-5, GetParam());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const PairDistance& a = answers.pairs[i];
    EXPECT_EQ(a.status, PairStatus::kOk) << i;
    const auto [hausdorff, slack] = dense_hausdorff(pairs.beziers[i], pairs.state(i));
    EXPECT_GE(a.hausdorff, hausdorff - slack) << i;
    EXPECT_LE(a.hausdorff - a.hausdorff_error, hausdorff + slack) << i;
    const auto [l2, h1] = dense_differences(pairs.beziers[i], pairs.state(i));
    EXPECT_NEAR(a.l2, l2, 5e-3 * l2) << i;
    EXPECT_NEAR(a.h1, h1, 3e-2 * h1) << i;
  }
}

TEST_P(PairDistancesOnEachBackend, FollowAnyScaleAndPlace) {
  const Pairs near = ribs(20, 7), strange = strangers(20, 8);
  for (const Pairs* base : {&near, &strange}) {
    const Answers answers = ask(*base, 1e-3, GetParam());
    for (const double scale : {1e-60, 1e-6, 1e6, 1e60}) {
      Pairs scaled;
      for (std::size_t i = 0; i < base->size(); ++i) {
        Bezier b = base->beziers[i];
        for (Vector2d& p : b) p *= scale;
        const Elastica e = base->state(i);
        scaled.add(b, {e.x * scale, e.y * scale, e.theta, e.kappa / scale, e.lambda1 / scale / scale,
                       e.lambda2 / scale / scale, e.length * scale});
      }
      const Answers again = ask(scaled, 1e-3 * scale, GetParam());
      for (std::size_t i = 0; i < base->size(); ++i) {
        EXPECT_NEAR(again.pairs[i].l2, answers.pairs[i].l2, 1e-9) << scale;
        EXPECT_NEAR(again.pairs[i].h1, answers.pairs[i].h1, 1e-9) << scale;
        EXPECT_NEAR(again.pairs[i].hausdorff / scale, answers.pairs[i].hausdorff, 1.1e-3) << scale;
        EXPECT_EQ(again.pairs[i].status, PairStatus::kOk);
      }
    }
  }
  // A curve of a millionth of the other's size.
  Pairs uneven;
  uneven.add({Vector2d(0, 0), {1e-6, 1e-6}, {2e-6, 1e-6}, {3e-6, 0}}, {0, 0, 0, 0, 0, 0, 1});
  const PairDistance a = ask(uneven, 1e-7, GetParam()).pairs[0];
  EXPECT_NEAR(a.hausdorff, 1 - 3e-6, 1e-7);
  const auto [l2, h1] = dense_differences(uneven.beziers[0], uneven.state(0));
  EXPECT_NEAR(a.l2, l2, 1e-5 * l2);
  EXPECT_NEAR(a.h1, h1, 1e-5 * h1);
}

TEST_P(PairDistancesOnEachBackend, DoNotDependOnCompanyPartsOrThreads) {
  Pairs pairs = ribs(700, 9);
  const Pairs others = strangers(500, 10);
  for (std::size_t i = 0; i < others.size(); ++i) pairs.add(others.beziers[i], others.state(i));
  const auto on = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return ask(pairs, 0.05, GetParam()).pairs;
  };
  const auto one = on(1), two = on(2);
  for (std::size_t i = 0; i < pairs.size(); ++i) EXPECT_TRUE(same_bits(one[i], two[i])) << i;
  const PairDistances on_backend(GetParam());
  std::vector<PairDistance> part(613);
  (void)on_backend.query(std::span(pairs.beziers).subspan(311, part.size()),
                         std::span(pairs.elastica).subspan(311, part.size()), 0.05, part);
  for (std::size_t i = 0; i < part.size(); ++i) EXPECT_TRUE(same_bits(one[311 + i], part[i])) << i;
  PairDistance alone;
  (void)on_backend.query(std::span(pairs.beziers).subspan(42, 1), std::span(pairs.elastica).subspan(42, 1),
                         0.05, std::span(&alone, 1));
  EXPECT_TRUE(same_bits(alone, one[42]));
}

// Gentle arches beside circles, in the kernels' numbers.
std::vector<PairNumbers> arches(std::size_t n) {
  std::mt19937_64 random(12);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<PairNumbers> pairs;
  for (std::size_t i = 0; i < n; ++i) {
    const double kappa = u(random), up = 0.01 * u(random), rise = -0.5 * kappa + 0.05 * u(random);
    pairs.push_back(
        {{0, 0.9, 0, 0, up, 0, -rise, 0.02 * u(random), kappa, 0, 0, 0.2, 1, 0, 0.9, std::abs(kappa)}});
  }
  return pairs;
}

TEST(PairLanes, HaveTheSameBitsOnEveryInstructionSet) {
  const auto pairs = arches(21);
  std::vector<unsigned> index(pairs.size());
  for (std::size_t i = 0; i < index.size(); ++i) index[i] = static_cast<unsigned>(i);
  const PairQueries queries{pairs.data(), index.data(), index.size()};
  using Columns = std::array<std::vector<double>, 5>;
  const auto on = [&](const PairLanes& lanes) {
    Columns c;
    for (auto& column : c) column.resize(pairs.size());
    lanes.differences(queries, 8, c[0].data(), c[1].data(), c[2].data());
    lanes.hausdorff(queries, 32, c[3].data(), c[4].data());
    return c;
  };
  const Columns base = on(kPairBaseline);
  EXPECT_TRUE(base == on(pair_lanes()));
  if (elastica::supported(elastica::Simd::kAvx2)) {
    EXPECT_TRUE(base == on(kPairAvx2));
  }
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    EXPECT_GT(base[3][i], 0);
    EXPECT_LT(base[4][i] - base[3][i], 1e-3);
  }
}

TEST_P(PairDistancesOnEachBackend, SayWhereThereIsNoAnswer) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Bezier arch{Vector2d(0, 0), {1, 1}, {2, 1}, {3, 0}};
  Bezier broken = arch;
  broken[2].x() = nan;
  Pairs pairs;
  pairs.add(broken, {0, 0, 0, 0, 0, 0, 3});
  pairs.add(arch, {0, 0, 0, 0, std::numeric_limits<double>::infinity(), 0, 3});
  pairs.add(arch, {0, 0, 0, 0, 0, 0, -1});
  pairs.add(arch, {1e150, 0, 0, 0, 0, 0, 3});
  pairs.add(arch, {0, 0, 0, 200, 0, 0, 3});
  const Vector2d at(3, 4);
  pairs.add({at, at, at, at}, {0, 0, 0, 0, 0, 0, 3});
  pairs.add(arch, {0, 0, 0.5, -0.5, 0, 0, 3});
  const Answers answers = ask(pairs, 1e-3, GetParam());
  using enum PairStatus;
  const PairStatus expected[] = {kInvalid, kInvalid, kInvalid, kInvalid, kTooTight, kNoLength, kOk};
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    EXPECT_EQ(answers.pairs[i].status, expected[i]) << i;
    EXPECT_EQ(std::isnan(answers.pairs[i].l2), expected[i] != kOk) << i;
    EXPECT_EQ(std::isnan(answers.pairs[i].hausdorff), i < 5) << i;
  }
  EXPECT_NEAR(answers.pairs[5].hausdorff, 5, 1e-3);
  // Nothing is that narrow: the bounds hold, and the status says that they are wide.
  const PairDistance wide = ask(pairs, 1e-14, GetParam()).pairs.back();
  EXPECT_EQ(wide.status, kWide);
  EXPECT_LE(wide.hausdorff - wide.hausdorff_error, answers.pairs.back().hausdorff);
}

TEST_P(PairDistancesOnEachBackend, AnswerNoneForNoneAndRefuseWhatMakesNoSense) {
  EXPECT_EQ(ask({}, 1, GetParam()).careful, 0u);
  const Pairs pairs = strangers(2, 11);
  std::vector<PairDistance> out(1);
  const PairDistances on_backend(GetParam());
  EXPECT_THROW((void)on_backend.query(pairs.beziers, pairs.elastica, 1, out), std::logic_error);
  out.resize(2);
  EXPECT_THROW((void)on_backend.query(pairs.beziers, pairs.elastica, 0, out), std::logic_error);
  EXPECT_THROW(
      (void)on_backend.query(pairs.beziers, pairs.elastica, std::numeric_limits<double>::quiet_NaN(), out),
      std::logic_error);
}

// Lengths and tolerances that take every number of samples, and the search.
TEST(PairDistances, HaveTheSameBitsOnEveryBackend) {
  Pairs pairs = ribs(600, 13);
  const Pairs others = strangers(200, 14);
  for (std::size_t i = 0; i < others.size(); ++i) pairs.add(others.beziers[i], others.state(i));
  const PairDistances on_device(Backend::kOpenCl);
  std::vector<PairDistance> device(pairs.size());
  for (const double tolerance : {1.0, 0.01, 1e-4}) {
    const std::size_t careful = on_device.query(pairs.beziers, pairs.elastica, tolerance, device);
    if (on_device.used().backend != Backend::kOpenCl) GTEST_SKIP() << on_device.used().reason;
    const Answers host = ask(pairs, tolerance, Backend::kCpu);
    EXPECT_EQ(careful, host.careful);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      EXPECT_TRUE(same_bits(device[i], host.pairs[i])) << i << ", tolerance " << tolerance;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, PairDistancesOnEachBackend, testing::Values(Backend::kCpu, Backend::kOpenCl),
                         [](const auto& instantiation) {
                           return instantiation.param == Backend::kCpu ? "Cpu" : "OpenCl";
                         });

}  // namespace
}  // namespace hotblade::gpu

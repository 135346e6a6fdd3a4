#include "elastica/blade/clamp_margin.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <random>

#include "elastica/blade/end_map.hpp"
#include "elastica/blade/stability.hpp"

namespace hotblade::elastica {
namespace {

using Eigen::VectorXd;

constexpr double kBlade_mm = 800, kWeight = 0.5 * kBlade_mm;

// Both clamps moved by six errors: positions in mm, turns as mm of kWeight.
ClampPair erring(const Elastica& e, const VectorXd& d) {
  ClampPair p = clamps_of(e);
  p.a = {p.a.x + d[0], p.a.y + d[1], p.a.theta + d[2] / kWeight};
  p.b = {p.b.x + d[3], p.b.y + d[4], p.b.theta + d[5] / kWeight};
  return p;
}

// The error at which the shape snaps, when it does before `least`; the walk knows nothing of the fold search.
bool snaps(const Elastica& e, const VectorXd& direction, double& least) {
  FollowOptions walk;
  walk.smallest_step = 1e-5;
  const FollowReport way = follow(e, erring(e, least * direction.normalized()), walk);
  constexpr double kLost = 3;  // a shape this near to a zero eigenvalue; taut ones have more
  if (way.status != FollowStatus::kSnapped || stability_margin(way.shape.elastica) > kLost) return false;
  least *= way.fraction;
  return true;
}

VectorXd random_direction(std::mt19937_64& random, Eigen::Index size) {
  std::normal_distribution<double> normal;
  return VectorXd::NullaryExpr(size, [&] { return normal(random); });
}

// Smallest error that snaps the shape, over random directions of all six errors and then around the best: an
// upper bound as well.
double dense_search_mm(const Elastica& e, double largest, int directions) {
  std::mt19937_64 random(5);
  double least = largest;
  VectorXd best;
  for (int i = 0; i < directions; ++i) {
    const VectorXd d = random_direction(random, 6);
    if (snaps(e, d, least)) best = d.normalized();
  }
  for (double spread = 0.5; best.size() > 0 && spread > 2e-2;) {
    bool better = false;
    for (int i = 0; i < 12; ++i) {
      const VectorXd d = best + spread * random_direction(random, 6).normalized();
      const double before = least;
      if (!snaps(e, d, least) || least > 0.999 * before) continue;
      best = d.normalized();
      better = true;
    }
    if (!better) spread *= 0.6;
  }
  return least;
}

// Stable blades of all kinds, some near to a snap.
Elastica random_blade(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  for (;;) {
    const Elastica e{30,
                     -20,
                     0.4,
                     8 * unit(random) / kBlade_mm,
                     50 * unit(random) / kBlade_mm / kBlade_mm,
                     50 * unit(random) / kBlade_mm / kBlade_mm,
                     kBlade_mm};
    if (end_map(e).index != 0) continue;
    const double margin = stability_margin(e);
    if (margin > 0.3 && margin < 8) return e;
  }
}

TEST(ClampMargin, IsNoMoreThanADenseSearchFinds) {
  std::mt19937_64 random(11);
  int lost = 0;
  for (int i = 0; i < 40; ++i) {
    const Elastica e = random_blade(random);
    const ClampMargin margin = clamp_margin(e, {20, 0});
    // A blade far from every fold costs the dense search most and says least: one in eight is looked at.
    if (margin.fold_mm >= 20 && i % 8 != 0) continue;
    const double dense = dense_search_mm(e, 20, 40);
    EXPECT_LE(margin.margin_mm, 1.002 * dense) << i;
    lost += margin.fold_mm < 20 ? 1 : 0;
  }
  EXPECT_GT(lost, 5);
}

TEST(ClampMargin, NamesFoldsThatTheShapeHoldsUpTo) {
  std::mt19937_64 random(12);
  int seen = 0;
  while (seen < 6) {
    const Elastica e = random_blade(random);
    const ClampMargin margin = clamp_margin(e, {20, 0});
    if (margin.folds.empty()) continue;
    ++seen;
    const Fold& fold = margin.folds.front();
    EXPECT_NEAR(clamp_distance(clamps_of(e), clamps_of(fold.shape), kWeight), fold.distance_mm,
                1e-6 * fold.distance_mm);
    EXPECT_NEAR(stability_margin(fold.shape), 0, 0.02);
    // Nine tenths of the error that it names do not lose the shape.
    const ClampPair held = clamps_of(e), lost = clamps_of(fold.shape);
    const auto part = [](const PlanarPose& p, const PlanarPose& q) {
      return PlanarPose{p.x + 0.9 * (q.x - p.x), p.y + 0.9 * (q.y - p.y),
                        p.theta + 0.9 * (q.theta - p.theta)};
    };
    EXPECT_EQ(follow(e, {part(held.a, lost.a), part(held.b, lost.b)}).status, FollowStatus::kFollowed);
  }
}

// Least stability on the last thousandth of the straight way to what is named, beyond it by as much; nothing
// where the shape is lost there.
std::optional<double> stability_at(const Elastica& e, const Elastica& fold) {
  const ClampPair held = clamps_of(e), lost = clamps_of(fold);
  const auto part = [](const PlanarPose& p, const PlanarPose& q, double t) {
    return PlanarPose{p.x + t * (q.x - p.x), p.y + t * (q.y - p.y), p.theta + t * (q.theta - p.theta)};
  };
  FollowOptions walk;
  walk.smallest_step = 1e-5;
  ClampedShape shape = *solve_clamped(e, held);
  double least = std::numeric_limits<double>::infinity();
  for (const double t : {0.5, 0.8, 0.9, 0.97, 0.99, 0.999, 0.9995, 1.0, 1.0005, 1.001}) {
    const FollowReport way = follow_on(shape, {part(held.a, lost.a, t), part(held.b, lost.b, t)}, walk);
    if (way.status != FollowStatus::kFollowed) {
      EXPECT_GT(t, 0.98);
      return std::nullopt;
    }
    shape = way.shape;
    if (t >= 0.999) least = std::min(least, stability_margin(shape.elastica));
  }
  return least;
}

// Shallow shapes that lie closely beside others' folds, of which the one named is their own: at 0.0232 mm
// another's is.
TEST(ClampMargin, NamesTheShapesOwnFoldBesideAnothers) {
  const Elastica e{
      -299.58812852,     -10.93112738, 0.028400065637, -0.000336062870467, 4.5531553535399996e-06,
      1.70842577771e-06, 400};
  const ClampMargin margin = clamp_margin(e, {0.161, 0});
  EXPECT_NEAR(margin.margin_mm, 0.03012, 1e-4);
  // Its own lies beside it, closer than the table's step.
  const Elastica pressed{0,  0, 0, -0.00024892106722218933, 0.00010998473750236408, 9.1834555568333216e-06,
                         600};
  EXPECT_NEAR(clamp_margin(pressed).margin_mm, 0.0369, 1e-4);
  std::mt19937_64 random(31);
  std::uniform_real_distribution<double> unit(-1, 1);
  int named = 0;
  for (int i = 0; i < 150; ++i) {
    const double force = 20 + 40 * unit(random), angle = 0.5 * unit(random), l2 = kBlade_mm * kBlade_mm;
    const Elastica shape{0,
                         0,
                         0,
                         3 * unit(random) / kBlade_mm,
                         force * std::cos(angle) / l2,
                         force * std::sin(angle) / l2,
                         kBlade_mm};
    if (end_map(shape).index != 0 || stability_margin(shape) < 0.3) continue;
    const ClampMargin all = clamp_margin(shape, {60, 0});
    if (all.folds.empty()) continue;
    ++named;
    const auto least = stability_at(shape, all.folds.front().shape);
    if (!least) continue;
    EXPECT_LT(*least, 0.3) << i;
  }
  EXPECT_GT(named, 50);
}

// Arches turned over towards their snap.
std::vector<Elastica> arches() {
  const Elastica arc{0, 0, 0.6, -1.2 / kBlade_mm, 0, 0, kBlade_mm};
  const FollowReport up = follow(arc, {{0, 0, 0.6}, {740, 0, -0.6}});
  const FollowReport lost = follow(up.shape.elastica, {{0, 0, -0.6}, {740, 0, 0.6}});
  EXPECT_EQ(lost.status, FollowStatus::kSnapped);
  std::vector<Elastica> all;
  for (double share = 0.5; share < 0.99; share += 0.04) {
    const double turn = 0.6 - 1.2 * share * lost.fraction;
    all.push_back(follow(up.shape.elastica, {{0, 0, turn}, {740, 0, -turn}}).shape.elastica);
  }
  return all;
}

TEST(ClampMargin, ChangesByNoMoreThanTheClampsMove) {
  const std::vector<Elastica> way = arches();
  const ClampMarginOptions options{200, 0};
  ClampMargin before = clamp_margin(way.front(), options);
  for (std::size_t i = 1; i < way.size(); ++i) {
    const ClampMargin here = clamp_margin(way[i], options);
    const double moved = clamp_distance(clamps_of(way[i - 1]), clamps_of(way[i]), kWeight);
    EXPECT_LE(std::abs(here.margin_mm - before.margin_mm), moved * (1 + 1e-5)) << i;
    before = here;
  }
}

TEST(ClampMargin, IsTheSameFromTheFoldsOfTheNeighbouringPose) {
  const ClampMarginOptions options{200, 0};
  ClampMargin near;
  for (const Elastica& e : arches()) {
    const ClampMargin full = clamp_margin(e, options);
    near = clamp_margin(e, near.folds, options);
    EXPECT_NEAR(near.margin_mm, full.margin_mm, 1e-4 * full.margin_mm);
  }
}

TEST(ClampMargin, OfANearlyStraightBladeIsTheWayToTheStraightOne) {
  // Tangents along the chord: half the slack by either clamp. A flat arc: both tangents turned by u.
  const double slack = 0.5;
  const Elastica bowed{0, 0,        0, 0.05 * 2 * M_PI / kBlade_mm, 4 * M_PI * M_PI / kBlade_mm / kBlade_mm,
                       0, kBlade_mm};
  const auto blade = solve_clamped(bowed, {{0, 0, 0}, {kBlade_mm - slack, 0, 0}});
  ASSERT_TRUE(blade);
  EXPECT_NEAR(clamp_margin(blade->elastica).margin_mm, slack / std::sqrt(2.0), 1e-6);
  const double u = 0.01;
  const ClampMargin arc = clamp_margin({5, 6, 0.3, 2 * u / kBlade_mm, 0, 0, kBlade_mm});
  EXPECT_NEAR(arc.margin_mm, std::sqrt(2.0) * kWeight * u, 0.01);
  EXPECT_EQ(arc.margin_mm, arc.straight_mm);
  EXPECT_NEAR(clamp_margin({5, 6, 0.3, 0, 0, 0, kBlade_mm}).margin_mm, 0, 1e-9);
}

// A shallow blade pulled by a force of `pull` over EI / length^2, its tangents turned from the chord, which
// is along x, by `ramp` alike and by `arch` against each other. By the first order, theta = across + bent
// cosh(k (s - 1/2)) + arch sinh(k (s - 1/2)) / sinh(k / 2).
Elastica shallow(double ramp, double arch, double pull) {
  const double k = std::sqrt(pull), l2 = kBlade_mm * kBlade_mm, mean = std::sinh(k / 2) * 2 / k;
  const double bent = -ramp / (std::cosh(k / 2) - mean), across = -bent * mean;
  const double kappa = (k * arch / std::tanh(k / 2) - k * bent * std::sinh(k / 2)) / kBlade_mm;
  return {0,        0, -(ramp + arch), kappa, -pull * std::cos(across) / l2, -pull * std::sin(across) / l2,
          kBlade_mm};
}

// A straight blade buckles at 4 pi^2, and so does one held between parallel ends. The chord of such a shape:
// theta = ramp cos 2 pi s, by its first order.
double where_parallel_ends_buckle_mm(const Elastica& e, double ramp) {
  const double euler = 4 * M_PI * M_PI / kBlade_mm / kBlade_mm;
  const Elastica buckling{0, 0, -ramp, 0, euler, 0, kBlade_mm};
  EXPECT_NEAR(stability_margin(buckling), 0, 0.05);
  return clamp_distance(clamps_of(e), clamps_of(buckling), kWeight);
}

TEST(ClampMargin, IsNoMoreThanTheWayToWhereParallelEndsBuckle) {
  for (const double ramp : {0.01, 0.03, 0.06}) {
    for (const double arch : {0.0, 1e-4, 1e-3, 4e-3}) {
      for (const double pull : {2.0, 20.0, 40.0}) {
        const Elastica e = shallow(ramp, arch, pull);
        const double way = where_parallel_ends_buckle_mm(e, ramp);
        const ClampMargin margin = clamp_margin(e);
        ASSERT_LT(1.5 * way, margin.straight_mm) << ramp << ' ' << arch << ' ' << pull;
        EXPECT_LE(margin.margin_mm, 1.01 * way) << ramp << ' ' << arch << ' ' << pull;
        EXPECT_GT(margin.margin_mm, 0);
      }
    }
  }
}

// What the walk of a dense search snaps at on shallow blades, too, some of them bowed.
TEST(ClampMargin, OfShallowBladesIsNoMoreThanADenseSearchFinds) {
  std::mt19937_64 random(21);
  std::uniform_real_distribution<double> unit(-1, 1);
  int near = 0;
  for (int i = 0; i < 24; ++i) {
    const Elastica e = shallow(0.05 * unit(random), 0.02 * unit(random), 22 + 20 * unit(random));
    const ClampMargin margin = clamp_margin(e, {20, 0});
    EXPECT_LE(margin.margin_mm, 1.002 * dense_search_mm(e, 20, 40)) << i;
    near += margin.fold_mm < 0.5 * margin.straight_mm ? 1 : 0;
  }
  EXPECT_GT(near, 5);
}

TEST(ClampMargin, OfAShallowBladeIsTheSameFromTheFoldsOfTheNeighbouringPose) {
  const ClampMarginOptions options{200, 0};
  ClampMargin near;
  for (int i = 0; i < 30; ++i) {
    const Elastica e = shallow(0.04 - 0.001 * i, 0.001 * (i - 15), 30 - 0.5 * i);
    const ClampMargin full = clamp_margin(e, options);
    near = clamp_margin(e, near.folds, options);
    EXPECT_NEAR(near.margin_mm, full.margin_mm, 1e-3 * full.margin_mm) << i;
  }
}

TEST(ClampMargin, DoesNotDependOnThePlaceOfThePair) {
  const Elastica e = arches().back();
  Elastica moved = e;
  moved.x += 500, moved.y -= 40, moved.theta += 1.1;
  const double c = std::cos(1.1), s = std::sin(1.1);
  moved.lambda1 = c * e.lambda1 - s * e.lambda2;
  moved.lambda2 = s * e.lambda1 + c * e.lambda2;
  const double margin = clamp_margin(e).margin_mm;
  EXPECT_NEAR(clamp_margin(moved).margin_mm, margin, 1e-5 * margin);
  EXPECT_NEAR(clamp_margin(reversed(e)).margin_mm, margin, 1e-5 * margin);
}

TEST(ClampMargin, IsNoneForAnUnstableShapeAndTheLimitForARelaxedOne) {
  EXPECT_EQ(clamp_margin({0, 0, 0.3, -20, 400, 0, 1}).margin_mm, 0);
  EXPECT_EQ(clamp_margin({0, 0, 0.3, -0.6 / kBlade_mm, 0, 0, kBlade_mm}, {2, 0}).margin_mm, 2);
}

TEST(ClampMargin, RefusesNonsense) {
  const Elastica e{0, 0, 0.3, -0.6 / kBlade_mm, 0, 0, kBlade_mm};
  EXPECT_THROW((void)clamp_margin(e, {0, 0}), std::logic_error);
  EXPECT_THROW((void)clamp_margin(e, {1, -1}), std::logic_error);
  EXPECT_THROW((void)clamp_margin(e, {1, NAN}), std::logic_error);
  EXPECT_THROW((void)clamp_margin({0, 0, NAN, 0, 0, 0, 1}), std::logic_error);
}

TEST(ClampDistance, IsTheLeastErrorOverAllPlacesOfThePair) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 50; ++i) {
    const ClampPair a{{10 * unit(random), 10 * unit(random), unit(random)},
                      {700 + 50 * unit(random), 100 * unit(random), unit(random)}};
    const double turn = unit(random), x = 300 * unit(random), y = 300 * unit(random);
    const auto placed = [&](const PlanarPose& p) {
      const double c = std::cos(turn), s = std::sin(turn);
      return PlanarPose{x + c * p.x - s * p.y, y + s * p.x + c * p.y, p.theta + turn};
    };
    EXPECT_NEAR(clamp_distance(a, {placed(a.a), placed(a.b)}, 400), 0, 1e-9);
    const VectorXd d = random_direction(random, 6);
    ClampPair b = a;
    b.a = {a.a.x + d[0], a.a.y + d[1], a.a.theta + d[2] / 400};
    b.b = {a.b.x + d[3], a.b.y + d[4], a.b.theta + d[5] / 400};
    const double least = clamp_distance(a, b, 400);
    EXPECT_LE(least, d.norm() * (1 + 1e-12));
    EXPECT_NEAR(clamp_distance(a, {placed(b.a), placed(b.b)}, 400), least, 1e-9);
    EXPECT_NEAR(clamp_distance(b, a, 400), least, 1e-9);
  }
  // A chord longer by 1 mm: half by either clamp.
  EXPECT_DOUBLE_EQ(clamp_distance({{0, 0, 0}, {500, 0, 0}}, {{0, 0, 0}, {501, 0, 0}}, 400), std::sqrt(0.5));
}

}  // namespace
}  // namespace hotblade::elastica

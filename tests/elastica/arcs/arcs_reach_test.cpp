#include "elastica/arcs/arcs_reach.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace hotblade::elastica {
namespace {

using Eigen::Vector2d;

// A spiral of random steps: curvatures sorted between k1 and k2, both ends included.
std::vector<Arc> random_spiral(std::mt19937_64& random, double k1, double k2, double l) {
  std::uniform_real_distribution<double> u(0, 1);
  const int n = 2 + static_cast<int>(6 * u(random));
  std::vector<double> levels{0, 1}, cuts{0, 1};
  for (int i = 0; i < n; ++i) levels.push_back(u(random));
  for (std::size_t i = 1; i < levels.size(); ++i) cuts.push_back(u(random));
  std::sort(levels.begin(), levels.end());
  std::sort(cuts.begin(), cuts.end());
  std::vector<Arc> arcs;
  CurvePoint at{0, 0, 0, 0};
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const Arc arc{at.x, at.y, at.theta, k1 + levels[i] * (k2 - k1), l * (cuts[i + 1] - cuts[i])};
    at = point_at(arc, arc.length);
    arcs.push_back(arc);
  }
  return arcs;
}

CurvePoint end_of(const std::vector<Arc>& arcs) {
  return point_at(arcs.back(), arcs.back().length);
}

TEST(ConvexLengthRange, HoldsForEverySpiralAndIsNestedAsTheInequalitiesSay) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> u(0, 1);
  int tried = 0;
  for (int i = 0; i < 3000; ++i) {
    double k1 = 2 * u(random), k2 = 2 * u(random);
    if (i % 2 == 1) k1 = -k1, k2 = -k2;
    const auto arcs = random_spiral(random, k1, k2, 1.4);
    const CurvePoint end = end_of(arcs);
    const auto family = BiarcFamily::between({0, 0, 0, k1}, end);
    ASSERT_TRUE(family);
    const auto outer = convex_length_range(*family), inner = convex_length_range(*family, k1, k2);
    if (!outer || !inner) continue;  // a circular arc, to rounding
    ++tried;
    EXPECT_LE(outer->least, inner->least * (1 + 1e-9));
    EXPECT_LE(inner->least, 1.4 * (1 + 1e-9));
    EXPECT_LE(1.4, inner->greatest * (1 + 1e-9));
    EXPECT_LE(inner->greatest, outer->greatest * (1 + 1e-9));
  }
  EXPECT_GT(tried, 2900);
}

TEST(ConvexLengthRange, IsReachedByTriarcsOfEveryLengthInIt) {
  // Theorem 2: each length of a biarc of the bilens is that of a spiral with the end curvatures.
  const CurvePoint a{0, 0, 0, 0.4};
  std::mt19937_64 random(2);
  for (int i = 0; i < 200; ++i) {
    CurvePoint b = end_of(random_spiral(random, 0.4, 1.7, 1.5));
    b.kappa = 1.7;
    const auto range = convex_length_range(*BiarcFamily::between(a, b), 0.4, 1.7);
    ASSERT_TRUE(range);
    for (const double part : {0.01, 0.3, 0.7, 0.99}) {
      const double l = range->least + part * (range->greatest - range->least);
      const auto found = spiral_arcs({a, b, l}, ArcOrder::kTriarc);
      ASSERT_TRUE(found);
      double sum = 0;
      for (const Arc& arc : found->arcs) sum += arc.length;
      EXPECT_NEAR(sum, l, 1e-12 * l);
      EXPECT_NEAR(found->arcs.front().kappa, 0.4, 1e-12);
      EXPECT_NEAR(found->arcs.back().kappa, 1.7, 1e-12);
    }
  }
}

TEST(SpiralReach, HoldsTheEndOfEverySpiralAndLittleElse) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int i = 0; i < 600; ++i) {
    const double l = 3, sign = i % 2 == 0 ? 1 : -1, k1 = sign * std::abs(u(random)),
                 k2 = sign * std::abs(u(random));
    EXPECT_TRUE(spiral_reaches(k1, k2, l, end_of(random_spiral(random, k1, k2, l)).position()))
        << k1 << " " << k2;
    EXPECT_FALSE(spiral_reaches(k1, k2, l, {1.001 * l, 0}));
    EXPECT_FALSE(spiral_reaches(k1, k2, l, {-l, 0.1}));
  }
}

TEST(SpiralReach, IsFilledByBiarcs) {
  // A point inside is the end of a two-level spiral: the region is no larger than what can be reached.
  const double k1 = 0.2, k2 = 1.0, l = 3;
  const auto boundary = spiral_reach(k1, k2, l, 64);
  Vector2d centre{0, 0};
  for (const Vector2d& p : boundary) centre += p / static_cast<double>(boundary.size());
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> u(0, 1);
  for (int i = 0; i < 20; ++i) {
    const Vector2d p =
        centre + 0.95 * u(random) * (boundary[static_cast<std::size_t>(127 * u(random))] - centre);
    if (!spiral_reaches(k1, k2, l, p)) continue;
    double best = INFINITY;
    for (int a = 0; a <= 40; ++a) {
      for (int b = a; b <= 40; ++b) {
        for (int t = 0; t <= 40; ++t) {
          const double q1 = k1 + (k2 - k1) * a / 40, q2 = k1 + (k2 - k1) * b / 40, s = l * t / 40;
          const CurvePoint joint = point_at(Arc{0, 0, 0, q1, s}, s);
          best = std::min(
              best, (point_at(Arc{joint.x, joint.y, joint.theta, q2, l - s}, l - s).position() - p).norm());
        }
      }
    }
    EXPECT_LT(best, 0.05);
  }
}

TEST(SpiralReach, OfAGivenTurningHoldsTheSpiralsThatTurnSo) {
  std::mt19937_64 random(5);
  const double k1 = 0.1, k2 = 1.0, l = 3;
  for (int i = 0; i < 500; ++i) {
    const CurvePoint end = end_of(random_spiral(random, k1, k2, l));
    const auto polygon = spiral_reach(k1, k2, l, end.theta, 400);
    double turned = 0;  // the winding number by angles, and the distance to the boundary
    double near = INFINITY;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const Vector2d a = polygon[k] - end.position(), b = polygon[(k + 1) % polygon.size()] - end.position();
      turned += std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
      near = std::min(near, a.norm());
    }
    EXPECT_TRUE(std::abs(turned) > 6 || near < 0.01) << end.theta;
  }
}

TEST(SpiralReach, OfNonsenseIsRefused) {
  EXPECT_THROW((void)spiral_reach(-0.5, 0.5, 1, 10), std::logic_error);
  EXPECT_THROW((void)spiral_reach(0, 5, 1, 10), std::logic_error);
  EXPECT_THROW((void)spiral_reach(0, 1, -1, 10), std::logic_error);
  EXPECT_THROW((void)spiral_reach(0.1, 1, 1, 3.0, 10), std::logic_error);
}

TEST(OvalContacts, ReproduceThePapersExampleAndItsVariantWithoutContact) {
  Oval oval{{3.5, 3.2, 4.3, 4.0}, {0.25, 0.80, 0.07, 0.85}};  // equation 20
  const auto contacts = oval_contacts(oval);
  ASSERT_EQ(contacts.size(), 2u);
  EXPECT_NEAR(contacts[0].mu, 0.79 * std::numbers::pi, 0.005 * std::numbers::pi);
  EXPECT_NEAR(contacts[1].mu, 1.07 * std::numbers::pi, 0.005 * std::numbers::pi);
  oval.k[0] = 0.42;  // figure 10: the sets pass each other
  EXPECT_TRUE(oval_contacts(oval).empty());
}

// Contact of a single arc of turning x and length 2 with the arcs p, q, p that turn by 2 pi - x, all lengths
// of the oval 1. The printed equation of the paper's last section has the signs of both 2 p and x (q - p) the
// other way.
double phi(double x, double p, double q) {
  return q * (x - 2 * p) * std::sin(x / 2) +
         x * (q - p) * std::sin(q * (2 * p + x - 2 * std::numbers::pi) / (2 * (q - p)));
}

TEST(OvalContacts, OfEqualLengthsAreTheRootsOfTheSpecialEquation) {
  for (const auto& [p, q] : {std::pair{0.8, 2.0}, std::pair{1.2, 1.9}, std::pair{0.3, 3.0}}) {
    const Oval from_least{{1, 1, 1, 1}, {p, q, p, q}}, from_greatest{{1, 1, 1, 1}, {q, p, q, p}};
    for (const bool nu : {false, true}) {
      const auto contacts = oval_contacts(nu ? from_greatest : from_least);
      ASSERT_EQ(contacts.size(), 2u);
      EXPECT_NEAR(contacts[0].mu + contacts[1].mu, 2 * std::numbers::pi, 1e-6);
      for (const OvalContact& c : contacts) {
        EXPECT_NEAR(c.u, 0, 1e-5);
        EXPECT_NEAR(c.v, 0, 1e-5);
        const double x =
            c.ab_half == 0 ? c.mu : 2 * std::numbers::pi - c.mu;  // the turning of the half that is one arc
        EXPECT_NEAR(nu ? phi(x, q, p) : phi(x, p, q), 0, 1e-6);
      }
    }
  }
}

}  // namespace
}  // namespace hotblade::elastica

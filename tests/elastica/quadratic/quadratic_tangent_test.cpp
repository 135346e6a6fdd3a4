#include "elastica/quadratic/quadratic_tangent.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/elastica/quadratic/tangent_brute_force.hpp"

namespace hotblade::elastica {
namespace {

using Eigen::Vector2d;

// How far the curve is from touching at its contact, of the curve's size: off the line or circle, or across
// it.
double tangency_error(const TangentProblem& p, const TangentMinimum& m) {
  const Vector2d at = point_at(m.curve, m.contact_t);
  const Vector2d velocity =
      (1 - m.contact_t) * (m.curve[1] - m.curve[0]) + m.contact_t * (m.curve[2] - m.curve[1]);
  const Vector2d line_normal = Vector2d(-p.direction.y(), p.direction.x()).normalized();
  const Vector2d normal = p.circle ? Vector2d((at - p.place).normalized()) : line_normal;
  const double off = p.circle ? (at - p.place).norm() - p.radius : normal.dot(at - p.place);
  const double size = (m.curve[1] - m.curve[0]).norm() + (m.curve[2] - m.curve[1]).norm() + p.radius;
  return std::max({std::abs(off), std::abs(normal.dot(velocity)), (at - m.contact).norm()}) / size;
}

// What the last digits of a middle point are worth, of the value: between ends that nearly coincide, on the
// circle, energies of 1e14 move by 1e-7 with them.
double noise_at(const TangentProblem& p, const Vector2d& b1) {
  double noise = 1e-8;
  for (Eigen::Index axis = 0; axis < 2; ++axis) {
    Vector2d beside = b1;
    beside[axis] = std::nextafter(b1[axis], std::numeric_limits<double>::infinity());
    noise = std::max(noise, std::abs(p.value(beside) / p.value(b1) - 1));
  }
  return noise;
}

// Every minimum that sampling sees is found, at no higher value and at the same place; what is found is
// tangent.
void compare_with_brute_force(unsigned seed, int problems, int samples) {
  std::mt19937_64 random(seed);
  double worst_tangency = 0;
  for (int i = 0; i < problems; ++i) {
    const TangentProblem p = random_problem(random, i);
    const TangentCurves solved = p.solve();
    ASSERT_EQ(solved.status, TangentStatus::kOk);
    for (const BruteMinimum& b : brute_force(p, samples)) {
      const double noise = noise_at(p, b.b1);
      bool found = false;
      for (const TangentMinimum& m : solved.minima) {
        found |= m.value <= b.value * (1 + noise) && (m.curve[1] - b.b1).norm() <= 2 * b.step;
      }
      EXPECT_TRUE(found) << "problem " << i << ", value " << b.value << " at " << b.b1.transpose();
    }
    for (const TangentMinimum& m : solved.minima) {
      EXPECT_GE(m.value, solved.minima.front().value);
      EXPECT_DOUBLE_EQ(m.value, p.value(m.curve[1]));
      if (m.regular) worst_tangency = std::max(worst_tangency, tangency_error(p, m));
    }
  }
  EXPECT_LT(worst_tangency, 1e-12);
}

TEST(TangentCurves, MissNoMinimumThatBruteForceSees) {
  compare_with_brute_force(1, 700, 3000);
}

// The full measure, by name: --gtest_also_run_disabled_tests --gtest_filter='*HundredThousand*'; about five
// minutes.
TEST(TangentCurves, DISABLED_MissNoMinimumInAHundredThousandProblems) {
  compare_with_brute_force(2, 100000, 20000);
}

TEST(TangentCurves, OfLeastLengthReflectLightWhereTheEndsAreEquallyFar) {
  // By symmetry the contact is in the middle; b1 is as far below the line as the ends are above.
  const TangentCurves c = tangent_to_line({-1, 0.5}, {1, 0.5}, {0, 0}, {3, 0}, Objective::kLength);
  ASSERT_EQ(c.minima.size(), 1u);
  EXPECT_NEAR(c.minima[0].curve[1].x(), 0, 1e-7);
  EXPECT_NEAR(c.minima[0].curve[1].y(), -0.5, 1e-15);
  EXPECT_NEAR(c.minima[0].contact.norm(), 0, 1e-7);
  EXPECT_NEAR(c.minima[0].contact_t, 0.5, 1e-15);
}

TEST(TangentCurves, FoldsStraightDownAndUpWhenTheEndsAreAboveEachOther) {
  const TangentCurves c = tangent_to_line({0, 1}, {0, 2}, {5, 0}, {1, 0}, Objective::kLength);
  ASSERT_EQ(c.minima.size(), 1u);
  EXPECT_NEAR(c.minima[0].value, 3, 1e-12);
  EXPECT_FALSE(c.minima[0].regular);
}

TEST(TangentCurves, BetweenTheSidesOfALineAreInfeasible) {
  for (const Objective o : {Objective::kLength, Objective::kEnergy}) {
    EXPECT_EQ(tangent_to_line({0, 1}, {1, -1}, {0, 0}, {1, 0}, o).status, TangentStatus::kInfeasible);
  }
}

TEST(TangentCurves, OfEndsSymmetricAboutTheCentreComeInMirroredPairs) {
  for (const Objective o : {Objective::kLength, Objective::kEnergy}) {
    const TangentCurves c = tangent_to_circle({-3, 0}, {3, 0}, {0, 0}, 1, o);
    ASSERT_GE(c.minima.size(), 2u);
    for (const TangentMinimum& m : c.minima) {
      bool mirrored = false;
      for (const TangentMinimum& n : c.minima) {
        mirrored |= std::abs(m.value - n.value) < 1e-12 * m.value &&
                    (Vector2d(m.curve[1].x(), -m.curve[1].y()) - n.curve[1]).norm() < 1e-5;
      }
      EXPECT_TRUE(mirrored) << m.curve[1].transpose();
    }
  }
}

TEST(TangentCurves, OfLeastLengthLieOnTheCloserBranchWhenTheChordIsClear) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> u(-3, 3);
  int tried = 0;
  while (tried < 200) {
    const Vector2d b0{u(random), u(random)}, b2{u(random), u(random)};
    const Vector2d chord = b2 - b0;
    const double t = std::clamp(-b0.dot(chord) / chord.squaredNorm(), 0.0, 1.0);
    if ((b0 + t * chord).norm() < 1.001) continue;
    ++tried;
    const TangentCurves c = tangent_to_circle(b0, b2, {0, 0}, 1, Objective::kLength);
    ASSERT_EQ(c.status, TangentStatus::kOk);
    EXPECT_EQ(c.minima[c.best].branch, TangencyBranch::kCloser);
  }
}

TEST(TangentCurves, NameTheSixCasesOfTheCircle) {
  const auto of = [](const Vector2d& a, const Vector2d& b) {
    return tangent_to_circle(a, b, {1, 1}, 2, Objective::kEnergy).circle_case;
  };
  const Vector2d out{5, 5}, out2{-4, 1}, on{3, 1}, on2{1, -1}, in{1.5, 1}, in2{1, 0};
  EXPECT_EQ(of(out, out2), CircleCase::kOutsideOutside);
  EXPECT_EQ(of(in, out), CircleCase::kOutsideInside);
  EXPECT_EQ(of(on, out), CircleCase::kOutsideOn);
  EXPECT_EQ(of(in, in2), CircleCase::kInsideInside);
  EXPECT_EQ(of(on, in), CircleCase::kOnInside);
  EXPECT_EQ(of(on, on2), CircleCase::kOnOn);
}

TEST(TangentCurves, WithAnEndOnTheCircleMayTouchThere) {
  const TangentCurves c = tangent_to_circle({1, 0}, {3, 1}, {0, 0}, 1, Objective::kEnergy);
  bool end = false;
  for (const TangentMinimum& m : c.minima) {
    if (m.branch != TangencyBranch::kEndTangent0) continue;
    end = true;
    EXPECT_NEAR(m.curve[1].x(), 1, 1e-15);  // on the tangent at the end
    EXPECT_EQ(m.contact, Vector2d(1, 0));
  }
  EXPECT_TRUE(end);
  // The shortest is the chord, whose end edge vanishes: the limit of tangent curves, and said to be so.
  const TangentCurves shortest = tangent_to_circle({1, 0}, {3, 1}, {0, 0}, 1, Objective::kLength);
  EXPECT_FALSE(shortest.minima[0].regular);
  EXPECT_DOUBLE_EQ(shortest.minima[0].value, std::sqrt(5.0));
}

TEST(TangentCurves, OfAChordThatTouchesAreTheChord) {
  for (const Objective o : {Objective::kLength, Objective::kEnergy}) {
    const TangentCurves c = tangent_to_circle({-2, 1}, {3, 1}, {0, 0}, 1, o);
    EXPECT_EQ(c.minima[0].branch, TangencyBranch::kChord);
    EXPECT_EQ(c.minima[0].value, o == Objective::kLength ? 5 : 0);
    EXPECT_NEAR((c.minima[0].contact - Vector2d(0, 1)).norm(), 0, 1e-15);
    EXPECT_EQ(tangent_to_line({0, 2}, {1, 2}, {7, 2}, {1, 0}, o).minima[0].branch, TangencyBranch::kChord);
  }
}

TEST(TangentCurves, MoveWithTheProblem) {
  std::mt19937_64 random(4);
  for (int i = 0; i < 140; ++i) {
    const TangentProblem p = random_problem(random, i);
    const auto moved = [](const Vector2d& q) { return Vector2d(3 - 2 * q.y(), 1 + 2 * q.x()); };
    TangentProblem m = p;
    m.b0 = moved(p.b2);
    m.b2 = moved(p.b0);
    m.place = moved(p.place);
    m.direction = moved(p.direction) - moved(Vector2d(0, 0));
    m.radius = 2 * p.radius;
    const TangentCurves a = p.solve(), b = m.solve();
    const double scale = p.objective == Objective::kLength ? 2 : 0.5;
    ASSERT_EQ(a.minima.size(), b.minima.size()) << i;
    EXPECT_NEAR(b.minima[b.best].value, scale * a.minima[a.best].value, 1e-9 * b.minima[b.best].value);
  }
}

TEST(TangentCurves, RefuseNonsense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Vector2d a{0, 1}, b{1, 1}, o{0, 0};
  EXPECT_THROW((void)tangent_to_line(a, a, o, {1, 0}, Objective::kLength), std::logic_error);
  EXPECT_THROW((void)tangent_to_line(a, b, o, {0, 0}, Objective::kLength), std::logic_error);
  EXPECT_THROW((void)tangent_to_circle(a, b, o, 0, Objective::kLength), std::logic_error);
  EXPECT_THROW((void)tangent_to_circle(a, b, o, nan, Objective::kLength), std::logic_error);
  EXPECT_THROW((void)tangent_to_circle({nan, 0}, b, o, 1, Objective::kLength), std::logic_error);
}

}  // namespace
}  // namespace hotblade::elastica

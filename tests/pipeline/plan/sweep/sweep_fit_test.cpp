// The swept fit against finite differences, exact elastica and rigid motions of its data.
#include "pipeline/plan/sweep/sweep_fit.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "elastica/blade/sensitivity.hpp"
#include "elastica/curve/elastica.hpp"
#include "pipeline/plan/ribs/rib_spline.hpp"
#include "pipeline/plan/sweep/sweep_problem.hpp"
#include "tests/pipeline/plan/sweep/bends.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector2d;

elastica::Elastica from_middle(const Bend& bend) {
  return {0, 0, 0, bend.kappa, bend.tension1, bend.tension2, 1};
}

TEST(SweepCurve, IsTheElasticaOfItsState) {
  Bends bends;
  for (int i = 0; i < 200; ++i) {
    const Bend bend = bends.next();
    const SweepCurve curve(bend, 300);
    const double s = bends.number(300);
    const elastica::CurvePoint exact = elastica::point_at(from_middle(bend), s);
    EXPECT_LT((curve.at(s).position - exact.position()).norm(), 5e-3) << s;
    EXPECT_NEAR(curve.at(s).theta, exact.theta, 1e-4);
    EXPECT_NEAR(curve.at(s).kappa, exact.kappa, 1e-6);
  }
}

TEST(SweepCurve, DerivativesAreThoseOfFiniteDifferences) {
  Bends bends;
  for (int i = 0; i < 100; ++i) {
    const Bend bend = bends.next();
    const double s = bends.number(300);
    const SweepPoint p = SweepCurve(bend, 300).at(s);
    const Eigen::Vector3d steps(1e-7, 1e-9, 1e-9);
    for (int k = 0; k < 3; ++k) {
      const auto moved = [&](double side) {
        Bend b = bend;
        (k == 0 ? b.kappa : k == 1 ? b.tension1 : b.tension2) += side * steps[k];
        return elastica::point_at(from_middle(b), s);
      };
      const elastica::CurvePoint high = moved(1), low = moved(-1);
      const Vector2d by = (high.position() - low.position()) / (2 * steps[k]);
      // A ten-thousandth of what it does at the curve's end.
      const double turns = k == 0 ? 300 : 300 * 300 / 2.0, size = turns * 300;
      EXPECT_LT((p.by_bend.col(k) - by).norm(), 1e-4 * size) << s << " " << k;
      EXPECT_NEAR(p.theta_by_bend[k], (high.theta - low.theta) / (2 * steps[k]), 1e-4 * turns);
    }
  }
}

TEST(SweepCurve, IsMovedByItsClampsErrorsAsTheElasticaIs) {
  Bends bends;
  const ClampPull errors{0.1, 2e-4, 1};
  for (int i = 0; i < 50; ++i) {
    const Bend bend = bends.next();
    elastica::MidState middle{0, 0, 0, bend.kappa, bend.tension1, bend.tension2, 600};
    const double exact =
        elastica::sensitivity(elastica::from_mid_state(middle), {0.1, 2e-4, 100, 480}).total_mm;
    // Both look at places some mm apart.
    EXPECT_NEAR(moved_by_clamps_mm(SweepCurve(bend, 300), -200, 180, errors), exact, 0.05 * exact) << i;
  }
}

TEST(SweepCurve, FindsTheNearestPoint) {
  Bends bends;
  for (int i = 0; i < 200; ++i) {
    const SweepCurve curve(bends.next(), 300);
    const double s = bends.number(290), away = bends.number(20);
    const SweepPoint p = curve.at(s);
    EXPECT_NEAR(curve.nearest(p.position + away * p.normal(), s + bends.number(15)), s, 1e-2);
  }
}

SweepFamily family(int coefficients) {
  Bends bends;
  SweepFamily f;
  f.first_mm = -250;
  f.last_mm = 310;
  f.x_mm = 12;
  f.coefficients.resize(5, coefficients);
  for (int i = 0; i < coefficients; ++i)
    f.coefficients.col(i) << bends.number(30), bends.number(0.15), 1.0 / 700 + bends.number(1.0 / 2500),
        bends.number(3e-6), bends.number(3e-6);
  return f;
}

// Samples of the family's exact curves: every second section reaches less far, as a round border would.
SweepData data_of(const SweepFamily& f) {
  SweepData data;
  for (int i = 0; i <= 30; ++i) {
    SweepSection section;
    section.offset_mm = f.first_mm + 4 + (f.last_mm - f.first_mm - 8) * i / 30;
    const double length = i % 2 == 0 ? 560 : 380;
    const elastica::Elastica e = from_mid_state(f.mid_state(section.offset_mm, length));
    for (const elastica::CurvePoint& p : sample(e, 25)) section.samples.push_back({p.position(), 1});
    data.sections.push_back(section);
  }
  return data;
}

TEST(SweepFamily, IsWhatTheMotionInterpolatesThroughItsRibs) {
  const SweepFamily f = family(8);
  std::vector<RibFit> ribs(8);
  for (std::size_t i = 0; i < ribs.size(); ++i) {
    ribs[i].offset_mm = f.first_mm + (f.last_mm - f.first_mm) * static_cast<double>(i) / 7;
    ribs[i].elastica = from_mid_state(f.mid_state(ribs[i].offset_mm, 600));
  }
  const RibSpline spline(ribs);
  for (double u = f.first_mm; u <= f.last_mm; u += 7) {
    const elastica::MidState a = f.mid_state(u, 600), b = spline.mid_at(u);
    EXPECT_NEAR(a.x, b.x, 1e-7);
    EXPECT_NEAR(a.y, b.y, 1e-7);
    EXPECT_NEAR(a.theta, b.theta, 1e-9);
    EXPECT_NEAR(a.kappa, b.kappa, 1e-11);
    EXPECT_NEAR(a.tension2, b.tension2, 1e-13);
  }
}

TEST(SweepFit, RecoversASurfaceSweptByExactElastica) {
  const SweepFamily made = family(5);
  const SweepData data = data_of(made);
  SweepFitOptions options;
  options.coefficients = 5;
  options.blade_length_mm = 800;
  options.exponents = {2, 8};
  const SweepFitReport fit = fit_sweep(data, options);
  EXPECT_LT(fit.max_mm, 0.02);
  // Measured again on exact curves, by the nearest of many points.
  double worst = 0;
  for (const SweepSection& section : data.sections) {
    const elastica::ElasticaCurve curve(from_mid_state(fit.family.mid_state(section.offset_mm, 700)));
    for (const SweepSample& sample : section.samples) {
      double nearest = 1e300;
      for (int i = 0; i <= 7000; ++i)
        nearest = std::min(nearest, (curve.at(0.1 * i).position() - sample.q).norm());
      worst = std::max(worst, nearest);
    }
  }
  EXPECT_LT(worst, 0.07);  // 0.02 mm, and points 0.1 mm apart
}

// The problem's gradient with all of the blade's limits at work.
void expect_gradient(int exponent, double pull = 0) {
  const SweepFamily f = family(6);
  const SweepData data = data_of(family(5));
  SweepFitOptions options;
  options.coefficients = 6;
  options.blade_length_mm = 900;
  options.smallest_radius_mm = 650;
  options.largest_turn_rad = 0.3;
  options.block = SweepFitOptions::Box{{-420, -300}, {450, 300}};
  options.clamp_pull = {0.1, 2e-4, pull};
  SweepProblem problem(data, options, f);
  problem.set_exponent(exponent, 20);
  const Eigen::VectorXd at = problem.pack(f);
  const SweepEvaluation here = problem.evaluate(at, problem.first_feet());
  for (Eigen::Index i = 0; i < at.size(); ++i) {
    Eigen::VectorXd step = Eigen::VectorXd::Zero(at.size());
    step[i] = 1e-4;
    const double slope =
        (problem.evaluate(at + step, here.feet).value - problem.evaluate(at - step, here.feet).value) / 2e-4;
    EXPECT_NEAR(here.gradient[i], slope, 2e-3 * (std::abs(slope) + 1e-2 * here.gradient.norm())) << i;
  }
  EXPECT_LT((here.hessian - here.hessian.transpose()).norm(), 1e-9 * here.hessian.norm());
}

TEST(SweepProblem, GradientOfTheMeanSquareIsThatOfFiniteDifferences) {
  expect_gradient(2);
}

TEST(SweepProblem, GradientOfAHigherMeanIsThatOfFiniteDifferences) {
  expect_gradient(8);
}

TEST(SweepProblem, GradientOfAPullAgainstClampsErrorsIsThatOfFiniteDifferences) {
  expect_gradient(2, 0.2);
}

TEST(SweepFit, MakesABladeSteadyThatIsNearlyStraight) {
  // A strip whose sections are arcs of 20 m radius, which say next to nothing of their tension.
  SweepFamily shallow = family(5);
  shallow.coefficients.bottomRows<4>().setZero();
  shallow.coefficients.row(2).setConstant(5e-5);
  const SweepData data = data_of(shallow);
  SweepFitOptions options;
  options.coefficients = 5;
  options.blade_length_mm = 1000;
  options.exponents = {2, 8};
  const SweepFitReport plain = fit_sweep(data, options);
  options.clamp_pull = {0.1, 2e-4, 0.2};
  const SweepFitReport steady = fit_sweep(data, options, &plain.family);
  const auto most_moved = [&](const SweepFamily& f) {
    double most = 0;
    for (const SweepSection& section : data.sections)
      most = std::max(most, moved_by_clamps_mm(SweepCurve(f.at(section.offset_mm).bend, 500), -200, 200,
                                               options.clamp_pull));
    return most;
  };
  EXPECT_GT(most_moved(plain.family), 5);
  EXPECT_LT(most_moved(steady.family), 0.3 * most_moved(plain.family));
  EXPECT_LT(steady.max_mm, 0.8);  // a fifth of a mm for each mm that it is steadier
  // No more taut than its clamps can be followed with half of the most to spare.
  for (const SweepSection& section : data.sections)
    EXPECT_GT(steady.family.at(section.offset_mm).bend.tension1 * 1000 * 1000, -65);
}

TEST(SweepFit, KeepsTheClampsOutOfTheBlockAndItsEndsFromTurning) {
  // Half a circle of 240 mm radius: the blade has to be told not to go on round it.
  SweepData data;
  for (int i = 0; i <= 12; ++i) {
    SweepSection section{30.0 * i, {}};
    for (int k = -12; k <= 12; ++k) {
      const double a = k / 12.0 * 1.0;
      section.samples.push_back({Vector2d(240 * std::sin(a), 240 * std::cos(a) + 0.05 * i), 1});
    }
    data.sections.push_back(section);
  }
  SweepFitOptions free;
  free.blade_length_mm = 1000;
  free.exponents = {2, 8};
  free.largest_turn_rad = 10;
  const SweepFitReport curled = fit_sweep(data, free);
  SweepFitOptions held = free;
  held.largest_turn_rad = 1.3;
  held.block = SweepFitOptions::Box{{-260, 60}, {260, 300}};
  const SweepFitReport calm = fit_sweep(data, held);
  EXPECT_GT(curled.largest_turn_rad, 1.6);
  EXPECT_LT(calm.largest_turn_rad, 1.35);
  EXPECT_LT(calm.clamp_depth_mm, 2);
  EXPECT_LT(calm.max_mm, 1.2);  // what it costs
}

TEST(SweepFit, DoesNotDependOnHowOftenItRuns) {
  const SweepData data = data_of(family(5));
  SweepFitOptions options;
  options.blade_length_mm = 800;
  const SweepFitReport a = fit_sweep(data, options), b = fit_sweep(data, options);
  EXPECT_EQ(a.family.coefficients, b.family.coefficients);
  EXPECT_EQ(a.max_mm, b.max_mm);
}

TEST(SweepFit, RefusesDataWithoutSectionsOrNumbers) {
  SweepFitOptions options;
  options.blade_length_mm = 800;
  EXPECT_THROW((void)fit_sweep({}, options), std::logic_error);
  SweepData data = data_of(family(5));
  data.sections[3].samples[1].q.x() = std::nan("");
  EXPECT_THROW((void)fit_sweep(data, options), std::logic_error);
}

}  // namespace
}  // namespace hotblade::pipeline

// Seams of swept strips, measured again on the blades' curves themselves, and what fitting the strips
// together does.
#include "pipeline/plan/sweep/sweep_joint.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "gpu/backend/stop.hpp"
#include "pipeline/plan/sweep/sweep_strip.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// A wave that no single family follows well, flat across the waste's side.
Vector3d wave(double u, double v) {
  const double x = 500 * u, y = 600 * v;
  return {x, y, 25 * std::sin(2 * M_PI * u) * (1 + 0.4 * v) + 30 * std::cos(2.5 * v) * u + 40 * v * v};
}

// The wave in two parts, each fitted on its own and both together.
struct Halves {
  explicit Halves(const Vector3d& seam_normal, const Eigen::Isometry3d& turn = Eigen::Isometry3d::Identity())
      : settings(back_kept()),
        design(
            grid_design("wave", 60, 60, [&](double u, double v) -> Vector3d { return turn * wave(u, v); })),
        surface(waste_surface(design.mesh, 1)),
        axes(sweep_axes(surface, surface::parallel_about(design.mesh, turn.linear() * Vector3d::UnitY()))) {
    const Vector3d n = turn.linear() * seam_normal, middle = turn * wave(0.5, 0.5);
    for (const double side : {1.0, -1.0}) {
      seams.push_back({{side * n, side * n.dot(middle)}});
      JointPart part;
      part.data =
          sweep_sections(surface, axes, section_options(settings, seams.back(), 40, 20, nullptr, nullptr));
      part.options.coefficients = 7;
      part.options.exponents = {2, 4, 8};
      part.options.blade_length_mm = 800;
      part.start = fit_sweep(part.data, part.options).family;
      parts.push_back(std::move(part));
    }
    std::vector<SeamSide> sides;
    for (std::size_t i = 0; i < 2; ++i)
      sides.push_back(
          {&axes, &seams[i], &surface, nullptr, nullptr, parts[i].start.first_mm, parts[i].start.last_mm});
    met = seams_of(sides, section_options(settings, {}, 1, 1, nullptr, nullptr));
  }

  Settings settings;
  surface::DesignSurface design;
  WasteSurface surface;
  RibAxes axes;
  std::vector<std::vector<SweepSeam>> seams;
  std::vector<JointPart> parts;
  std::vector<PartSeam> met;
};

constexpr double kReachMm = 500;

// A family's curve in its plane at an offset, point by point.
std::vector<Vector2d> curve_of(const SweepFamily& family, double offset_mm) {
  const SweepState state = family.at(offset_mm);
  const SweepCurve curve(state.bend, kReachMm);
  std::vector<Vector2d> points;
  for (double s = -kReachMm; s <= kReachMm; s += 0.25)
    points.push_back(Vector2d(family.x_mm, state.y) + Eigen::Rotation2Dd(state.theta) * curve.at(s).position);
  return points;
}

double distance(const std::vector<Vector2d>& curve, const Vector2d& q) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < curve.size(); ++i) {
    const Vector2d way = curve[i] - curve[i - 1];
    const double t = std::clamp((q - curve[i - 1]).dot(way) / way.squaredNorm(), 0.0, 1.0);
    least = std::min(least, (curve[i - 1] + t * way - q).norm());
  }
  return least;
}

TEST(SweepSeams, TheGapAcrossTheSweepIsThatBetweenTheCurvesInTheSeamsPlane) {
  const Halves halves(Vector3d::UnitY());
  ASSERT_EQ(halves.met.size(), 1U);
  EXPECT_GT(halves.met[0].places.size(), 25U);  // 500 mm in cells of 15
  const SeamFacts facts = seam_facts(halves.met[0], halves.parts[0].start, halves.parts[1].start, kReachMm);
  double gap = 0;
  for (const SeamPlace& place : halves.met[0].places) {
    const FormedPoint& on = place.on[0][1];
    EXPECT_NEAR(on.offset_mm, place.on[1][1].offset_mm, 1e-9);
    // From the first part's point along the way to the second's curve.
    const auto first = curve_of(halves.parts[0].start, on.offset_mm),
               second = curve_of(halves.parts[1].start, on.offset_mm);
    const auto near = std::min_element(first.begin(), first.end(), [&](const Vector2d& a, const Vector2d& b) {
      return (a - on.sample.q).squaredNorm() < (b - on.sample.q).squaredNorm();
    });
    gap = std::max(gap, on.sample.cosine * distance(second, *near));
  }
  EXPECT_GT(gap, 0.01);
  EXPECT_NEAR(facts.gap_mm, gap, 0.05 * gap + 1e-3);
}

TEST(SweepSeams, TheKinkIsTheChangeOfWhatStandsBetweenBothAcrossTheSeam) {
  Halves halves(Vector3d::UnitX());
  ASSERT_EQ(halves.met.size(), 1U);
  // One family on both sides: neither gap nor kink. Turned about its middle by 0.01 rad: that much.
  SweepFamily family = halves.parts[0].start;
  const SeamFacts none = seam_facts(halves.met[0], family, family, kReachMm);
  EXPECT_LT(none.gap_mm, 1e-9);
  EXPECT_LT(none.kink_deg, 1e-6);
  SweepFamily other = family;
  other.coefficients.row(1).array() += 0.01;
  const SeamFacts facts = seam_facts(halves.met[0], family, other, kReachMm);
  EXPECT_NEAR(facts.kink_deg, 0.01 * 180 / M_PI, 0.05);
}

class SweptTogether : public ::testing::TestWithParam<Vector3d> {};

TEST_P(SweptTogether, ClosesTheGapAndKeepsTheDeviation) {
  const Halves halves(GetParam());
  ASSERT_EQ(halves.met.size(), 1U);
  const std::vector<SweepFitReport> together = fit_together(halves.parts, halves.met);
  const SeamFacts before = seam_facts(halves.met[0], halves.parts[0].start, halves.parts[1].start, kReachMm);
  const SeamFacts after = seam_facts(halves.met[0], together[0].family, together[1].family, kReachMm);
  EXPECT_LT(after.gap_mm, 0.5 * before.gap_mm) << before.gap_mm;
  EXPECT_LT(after.gap_mm, 0.05);
  EXPECT_LT(after.kink_deg, before.kink_deg);
  for (std::size_t i = 0; i < 2; ++i) {
    const SweepFitReport own = fit_sweep(halves.parts[i].data, halves.parts[i].options);
    EXPECT_LT(together[i].max_mm, 1.2 * own.max_mm + 0.02);
    EXPECT_GT(together[i].smallest_radius_mm, 0.99 * halves.parts[i].options.smallest_radius_mm);
  }
}

TEST_P(SweptTogether, BringsAPartToOneThatIsHeld) {
  Halves halves(GetParam());
  halves.parts[1].held = true;
  const std::vector<SweepFitReport> together = fit_together(halves.parts, halves.met);
  const SeamFacts before = seam_facts(halves.met[0], halves.parts[0].start, halves.parts[1].start, kReachMm);
  const SeamFacts after = seam_facts(halves.met[0], together[0].family, halves.parts[1].start, kReachMm);
  EXPECT_LT(after.gap_mm, 0.5 * before.gap_mm) << before.gap_mm;
  EXPECT_EQ(together[1].family.count(), 0) << "nothing is said of what does not move";
}

// The samples of one part are moved away from the other's, so that closing the gap costs deviation.
TEST_P(SweptTogether, LeavesAGapOpenRatherThanAPartBeyondWhatItMayDeviate) {
  constexpr double kApartMm = 0.8, kMore = 1.1, kNearMm = 0.02;
  Halves halves(GetParam());
  for (SweepSection& section : halves.parts[0].data.sections)
    for (SweepSample& sample : section.samples) sample.q.y() += kApartMm;
  double own_mm = 0;
  for (JointPart& part : halves.parts) {
    const SweepFitReport own = fit_sweep(part.data, part.options);
    part.start = own.family;
    own_mm = std::max(own_mm, own.max_mm);
    EXPECT_NEAR(measured_family(part.data, part.options, own.family).max_mm, own.max_mm, 1e-6);
  }
  const auto largest_mm = [](const std::vector<SweepFitReport>& fits) {
    return std::max(fits[0].max_mm, fits[1].max_mm);
  };
  const auto gap_mm = [&](const std::vector<SweepFitReport>& fits) {
    return seam_facts(halves.met[0], fits[0].family, fits[1].family, kReachMm).gap_mm;
  };
  const auto closed = fit_together(halves.parts, halves.met);
  for (JointPart& part : halves.parts) part.most_mm = kMore * own_mm;
  const auto held = fit_together(halves.parts, halves.met);
  EXPECT_GT(largest_mm(closed), kMore * own_mm + 2 * kNearMm);
  EXPECT_LT(largest_mm(held), kMore * own_mm + kNearMm);
  EXPECT_GT(gap_mm(held), gap_mm(closed));
  EXPECT_LT(gap_mm(held), kApartMm);
}

TEST_P(SweptTogether, IsTheSameForADesignThatLiesElsewhere) {
  const Eigen::Isometry3d turn =
      Eigen::Translation3d(3000, -200, 80) * Eigen::AngleAxisd(0.6, Vector3d(1, 2, -1).normalized());
  const Halves here(GetParam()), there(GetParam(), turn);
  const auto a = fit_together(here.parts, here.met), b = fit_together(there.parts, there.met);
  // Samples are thinned by a grid in the planes, which lies otherwise here and there.
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(a[i].max_mm, b[i].max_mm, 0.1 * a[i].max_mm);
}

TEST_P(SweptTogether, GivesTheSameBytesWithOneThreadAndTwo) {
  const Halves halves(GetParam());
  const auto two = fit_together(halves.parts, halves.met);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const auto single = fit_together(halves.parts, halves.met);
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_TRUE((two[i].family.coefficients.array() == single[i].family.coefficients.array()).all());
}

INSTANTIATE_TEST_SUITE_P(Seams, SweptTogether, ::testing::Values(Vector3d::UnitX(), Vector3d::UnitY()),
                         [](const auto& seam) {
                           return seam.param.x() == 1 ? "AcrossRibs" : "AcrossTheSweep";
                         });

TEST(SweepJoint, WithoutSeamsEachPartStaysNearItsOwnFit) {
  const Halves halves(Vector3d::UnitY());
  const auto alone = fit_together(halves.parts, {});
  for (std::size_t i = 0; i < 2; ++i) {
    const SweepFitReport own = fit_sweep(halves.parts[i].data, halves.parts[i].options);
    EXPECT_NEAR(alone[i].max_mm, own.max_mm, 0.1 * own.max_mm);
  }
}

TEST(SweepJoint, EndsWhereItsWatchThrows) {
  const Halves halves(Vector3d::UnitX());
  int told = 0;
  (void)fit_together(halves.parts, halves.met, [&] { ++told; });
  EXPECT_GE(told, 2);
  struct Ended {};
  EXPECT_THROW((void)fit_together(halves.parts, halves.met, [] { throw Ended(); }), Ended);
}

// Each takes a tenth of a second or more on a roof, and ends when it is told to.
TEST(SweepSeams, AndSectionsAreGivenUpWhereTheWorkIsToEnd) {
  const Halves halves(Vector3d::UnitY());
  const SweepFamily& family = halves.parts[0].start;
  gpu::Stop stop;
  stop.ask();
  const auto ended = [&](const std::function<void()>& work) {
    EXPECT_THROW(gpu::run_stoppable(1, stop, work), gpu::Stopped);
  };
  ended([&] { (void)seam_facts(halves.met[0], family, family, kReachMm); });
  const SweepSectionOptions options =
      section_options(halves.settings, halves.seams[0], 40, 20, nullptr, nullptr);
  ended([&] { (void)sweep_sections(halves.surface, halves.axes, options); });
  ended([&] { (void)seams_of({{}, {}}, options); });
}

TEST(SweepJoint, RefusesAPartWithoutSections) {
  EXPECT_THROW((void)fit_together({JointPart{}}, {}), std::logic_error);
}

}  // namespace
}  // namespace hotblade::pipeline

// Plans whose rib planes turn about an axis.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "elastica/curve/elastica.hpp"
#include "pipeline/plan/motion/clamp_plane.hpp"
#include "pipeline/plan/plan.hpp"
#include "pipeline/plan/ribs/rib_axes.hpp"
#include "pipeline/settings/error.hpp"
#include "robot/blade/blade_section.hpp"
#include "robot/blade/common_plane.hpp"
#include "tests/pipeline/plan_design.hpp"
#include "tests/pipeline/temporary_directory.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector3d;
using ::testing::AllOf;
using ::testing::HasSubstr;

// Where the fan stands in space.
struct Placed {
  Eigen::Quaterniond turn = Eigen::Quaterniond(0.6, -0.3, 0.5, 0.2).normalized();
  Vector3d shift{310, -140, 75};
  [[nodiscard]] Vector3d operator()(const Vector3d& p) const { return turn * p + shift; }
};

// The elastica at an angle of the fan, in (distance from the axis, height).
elastica::Elastica shape(double angle) {
  const elastica::Elastica e{350, 0, 0.35 + 0.1 * angle, -0.0022 - 0.0006 * angle, 2e-6, 1.5e-6, 330};
  return e;
}

constexpr double kTurn = 0.5;

Vector3d on_blade(double angle, double share) {
  const elastica::Elastica e = shape(angle);
  const elastica::CurvePoint q = elastica::point_at(e, share * e.length);
  return {q.x * std::cos(angle), q.x * std::sin(angle), q.y};
}

// What a blade through these elastica leaves: half a band below.
Vector3d design_point(double angle, double share) {
  constexpr double kStep = 1e-4;
  const Vector3d along = on_blade(angle, share + kStep) - on_blade(angle, share - kStep),
                 sweep = on_blade(angle + kStep, share) - on_blade(angle - kStep, share);
  Vector3d n = along.cross(sweep).normalized();
  if (n.z() < 0) n = -n;
  const double across = std::abs(n.dot(Vector3d(-std::sin(angle), std::cos(angle), 0)));
  return on_blade(angle, share) - 0.5 * (1 + 8 * across) * n;
}

Settings fan_settings(const Placed& place) {
  Settings settings;
  settings.design.units = "mm";
  settings.design.keep = Keep::kBack;
  // Close fits instead of calm ones.
  settings.fit.deviation_share = 0.03;
  const Vector3d p = place(Vector3d(0, 0, 120)), d = place.turn * Vector3d(0, 0, 3);
  settings.slice.fan_axis = {{p.x(), p.y(), p.z(), d.x(), d.y(), d.z()}};
  return settings;
}

const PlanResult& swept_fan() {
  static const PlanResult result = [] {
    const Placed place;
    const auto design = grid_design("fan", 60, 80, [&](double u, double v) {
      return place(design_point(kTurn * (0.5 - u), v));  // normals up
    });
    return plan(design, fan_settings(place), {});
  }();
  return result;
}

TEST(FanPlan, ASurfaceSweptByElasticaComesBackToItsMesh) {
  const PlanResult& result = swept_fan();
  for (const Refusal& r : result.refusals) ADD_FAILURE() << describe(r);
  EXPECT_EQ(result.program.verification.status, VerificationStatus::kPassed);
  // Facets of 4.1 mm by 4.9 mm on curvature below 1 / 300 mm lie within 0.02 mm; where blade sections turn,
  // half a band is measured in slightly different planes. Fans are not planned against the blade's weight.
  double sag = 0;
  for (const StripFacts& f : result.strips) sag = std::max(sag, f.droop_error_mm + f.motion.in_plane_sag_mm);
  EXPECT_LT(result.verification.deviation.max, 0.06 + sag);
  EXPECT_LT(result.verification.deviation.rms, 0.015 + 0.5 * sag);
  EXPECT_LT(result.verification.uncut_share(), 1e-3);
  for (const StripFacts& f : result.strips) EXPECT_LT(f.worst_fit_mm, 0.03);
}

TEST(FanPlan, EveryPoseOfTheCutLiesInAHalfPlaneOfTheFan) {
  const Placed place;
  const Vector3d axis = place.turn * Vector3d::UnitZ(), on_axis = place(Vector3d::Zero());
  for (const Strip& strip : swept_fan().program.strips) {
    double first = 10, last = -10;
    for (const BladePose& pose : strip.poses) {
      if (pose.phase != StripPhase::kCut) continue;
      EXPECT_NEAR(pose.frame.normal().dot(axis), 0, 1e-9);
      EXPECT_NEAR(pose.frame.normal().dot(pose.frame.origin - on_axis), 0, 1e-7);
      const Vector3d n = place.turn.conjugate() * pose.frame.normal();
      const double angle = std::remainder(std::atan2(n.y(), n.x()), std::acos(-1.0));
      first = std::min(first, angle);
      last = std::max(last, angle);
    }
    EXPECT_GT(last - first, 0.1);
  }
}

TEST(FanPlan, ClampsShareAPlaneAtAndBetweenWaypoints) {
  for (const Strip& strip : swept_fan().program.strips) {
    for (const BladePose& pose : strip.poses) EXPECT_LT(off_plane_mm(pose.a, pose.b), 1e-6);
    for (std::size_t i = 1; i < strip.poses.size(); ++i) {
      for (const double t : {0.25, 0.5, 0.8}) {
        const BladePose &p = strip.poses[i - 1], &q = strip.poses[i];
        const Pose a{(1 - t) * p.a.p + t * q.a.p, p.a.q().slerp(t, q.a.q())},
            b{(1 - t) * p.b.p + t * q.b.p, p.b.q().slerp(t, q.b.q())};
        ASSERT_LT(off_plane_mm(a, b), robot::kMaxOffPlane_mm);
      }
    }
  }
  for (const StripFacts& f : swept_fan().strips) {
    EXPECT_GT(f.motion.off_plane_mm, 0);
    EXPECT_LT(f.motion.off_plane_mm, robot::kMaxOffPlane_mm);
  }
}

TEST(FanPlan, TheOuterEndMovesAtTheFeedAndTheInnerOneSlower) {
  const MotionSettings motion;
  for (const Strip& strip : swept_fan().program.strips) {
    double fastest = 0, slowest = 1e9;
    for (std::size_t i = 1; i < strip.poses.size(); ++i) {
      const BladePose &p = strip.poses[i - 1], &q = strip.poses[i];
      if (!p.foam || !q.foam) continue;
      for (const double share : {0.0, 0.5, 1.0}) {
        const auto at = [&](const BladePose& pose) {
          const auto c =
              elastica::point_at(pose.blade, (*pose.foam)[0] + share * ((*pose.foam)[1] - (*pose.foam)[0]));
          return pose.frame.point(c.x, c.y);
        };
        const double speed = (at(q) - at(p)).norm() / (q.t - p.t);
        fastest = std::max(fastest, speed);
        slowest = std::min(slowest, speed);
      }
    }
    EXPECT_LT(fastest, 1.01 * motion.feed_mm_s);
    EXPECT_GT(fastest, 0.95 * motion.feed_mm_s);
    EXPECT_LT(slowest, 0.7 * motion.feed_mm_s);  // 350 mm from the axis against 660 mm
    EXPECT_GT(slowest, 0.4 * motion.feed_mm_s);
  }
}

// Beside the design there is foam as well, where a block is wider than the ribs.
TEST(FanPlan, NoPointInTheBlockIsFasterThanTheFeed) {
  const surface::DesignSurface design = grid_design("annulus", 60, 16, [](double u, double v) -> Vector3d {
    const double angle = 1.74 * (u - 0.5), r = 300 + 150 * v;
    return {r * std::cos(angle), r * std::sin(angle), 20 * std::sin(std::numbers::pi * v)};
  });
  const PlanResult result = plan(design, back_kept(), {});
  ASSERT_EQ(result.program.verification.status, VerificationStatus::kPassed);
  const double feed = MotionSettings{}.feed_mm_s;
  double fastest = 0, of_design = 0;
  for (const Strip& strip : result.program.strips) {
    for (std::size_t i = 1; i < strip.poses.size(); ++i) {
      const BladePose &p = strip.poses[i - 1], &q = strip.poses[i];
      if (p.phase != StripPhase::kCut || q.phase != StripPhase::kCut) continue;
      for (int k = 0; k <= 60; ++k) {
        const double s = q.blade.length * k / 60;
        const auto at = [&](const BladePose& pose) {
          const elastica::CurvePoint c = elastica::point_at(pose.blade, s);
          return pose.frame.point(c.x, c.y);
        };
        if (!strip.block.contains(at(q))) continue;
        const double speed = (at(q) - at(p)).norm() / (q.t - p.t);
        fastest = std::max(fastest, speed);
        if (q.foam && s > (*q.foam)[0] && s < (*q.foam)[1]) of_design = std::max(of_design, speed);
      }
    }
  }
  EXPECT_LT(fastest, 1.01 * feed);
  EXPECT_GT(fastest, 0.95 * feed);
  EXPECT_LT(of_design, 0.99 * feed) << "the block is no wider than the ribs: this tests nothing";
}

TEST(FanPlan, BlocksHoldTheDesignAndLieWithTheirMiddlePlaneLevel) {
  for (const Strip& strip : swept_fan().program.strips) {
    const Eigen::Quaterniond& q = strip.design_to_cell.q;
    const double first = std::abs((q * strip.ribs.front().frame.normal()).z()),
                 last = std::abs((q * strip.ribs.back().frame.normal()).z());
    EXPECT_NEAR(first, last, 1e-6) << "both ends are tilted alike";
    EXPECT_LT(first, 0.9999);
    const Vector3d foot = transformed(strip.design_to_cell, Pose{strip.block.frame.origin, q}).p;
    EXPECT_GE(foot.z(), 400 - 1e-6);
    for (const Rib& rib : strip.ribs) {
      if (rib.design_deviation_mm == 0) continue;  // beyond the design's ends
      for (const Eigen::Vector2d& t : rib.target) {
        const Vector3d d = rib.frame.point(t.x(), t.y()) - strip.block.frame.origin;
        const Vector3d in(d.dot(strip.block.frame.x), d.dot(strip.block.frame.y),
                          d.dot(strip.block.frame.normal()));
        EXPECT_GE(in.minCoeff(), 9.9);
        EXPECT_GE((strip.block.size_mm - in).minCoeff(), 9.9);
      }
    }
  }
}

TEST(FanPlan, BladesAreClearOfTheBlockBeforeLeadInAndBehindLeadOut) {
  for (const Strip& strip : swept_fan().program.strips) {
    for (const BladePose& pose : strip.poses) {
      if (pose.phase == StripPhase::kLeadIn || pose.phase == StripPhase::kCut ||
          pose.phase == StripPhase::kLeadOut)
        continue;
      for (const elastica::CurvePoint& c : elastica::sample(pose.blade, 33)) {
        const Vector3d d = pose.frame.point(c.x, c.y) - strip.block.frame.origin;
        const Vector3d in(d.dot(strip.block.frame.x), d.dot(strip.block.frame.y),
                          d.dot(strip.block.frame.normal()));
        const double inside = in.cwiseMin(strip.block.size_mm - in).minCoeff();
        ASSERT_LT(inside, 0) << name(pose.phase) << " at " << pose.t << " s";
      }
    }
  }
}

TEST(FanPlan, TheBladesWeightInTiltedPlanesIsBudgeted) {
  double in_plane = 0;
  for (const StripFacts& f : swept_fan().strips) {
    EXPECT_GT(f.plane_turn_rad, 0.1);
    in_plane = std::max(in_plane, f.motion.in_plane_sag_mm);
  }
  EXPECT_GT(in_plane, 1e-3);
  for (const auto& [name, mm] : swept_fan().program.verification.budget_mm) {
    if (name != "gravity_in_plane") continue;
    EXPECT_EQ(mm, robot::kSagUnknownShare * in_plane);
  }
}

TEST(FanPlan, ProgramsReadBackAndVerifyTheSame) {
  const Placed place;
  const std::string text = to_json(swept_fan().program);
  EXPECT_EQ(to_json(parse_program(text, "program.json")), text);
}

TEST(FanPlan, AnAxisFarAwayPlansAsParallelPlanesDo) {
  const auto design = cylinder_design();
  Settings settings = along_x();
  const PlanResult parallel = plan(design, settings, {});
  settings.slice.direction.reset();
  settings.slice.fan_axis = {{150, 9e5, 0, 0, 0, 1}};
  const PlanResult fan = plan(design, settings, {});
  EXPECT_EQ(fan.program.verification.status, VerificationStatus::kPassed);
  ASSERT_EQ(fan.program.strips.size(), parallel.program.strips.size());
  EXPECT_EQ(fan.program.strips[0].blade_length_mm, parallel.program.strips[0].blade_length_mm);
  EXPECT_NEAR(fan.verification.deviation.max, parallel.verification.deviation.max, 5e-3);
  const Vector3d size = fan.program.strips[0].block.size_mm - parallel.program.strips[0].block.size_mm;
  EXPECT_LT(size.cwiseAbs().maxCoeff(), 0.1);
}

// Of half a tunnel its rulings are no worse to follow than its arcs, but in planes that turn as far a
// straight blade hangs by centimetres.
TEST(FanPlan, IsNotTakenWhereBladesWouldHang) {
  for (const double turn : {2.6, 3.5}) {
    const surface::DesignSurface tunnel = grid_design("tunnel", 80, 20, [&](double u, double v) {
      const double phi = turn * (u - 0.5);
      return Vector3d(400 * std::sin(phi), 800 * v, 400 * std::cos(phi));
    });
    const PlanResult result = plan(tunnel, back_kept(), {});
    EXPECT_THAT(result.refusals, ::testing::IsEmpty());
    EXPECT_LE(result.program.strips.size(), 2U);
    for (const Strip& strip : result.program.strips)
      for (const Rib& rib : strip.ribs) EXPECT_GT(std::abs(rib.frame.normal().y()), 0.99);
  }
}

// A column, its foam inside: all round.
surface::DesignSurface column() {
  constexpr int kRound = 120, kUp = 30;
  const testing::TemporaryDirectory directory;
  const std::filesystem::path file = directory / "column.obj";
  {
    std::ofstream out(file);
    for (int i = 0; i <= kUp; ++i) {
      for (int j = 0; j < kRound; ++j) {
        const double phi = 2 * std::numbers::pi * j / kRound;
        out << "v " << 300 * std::cos(phi) << " " << 300 * std::sin(phi) << " " << 900.0 * i / kUp << "\n";
      }
    }
    for (int i = 0; i < kUp; ++i) {
      for (int j = 0; j < kRound; ++j) {
        const int a = i * kRound + j + 1, b = i * kRound + (j + 1) % kRound + 1, c = b + kRound,
                  d = a + kRound;
        out << "f " << d << " " << c << " " << b << "\nf " << d << " " << b << " " << a << "\n";
      }
    }
  }
  return surface::read_obj(file, {"mm", 'z'});
}

// In planes along it blades would hang at its sides however they are halved.
TEST(FanPlan, OfAColumnIsLeftForItsArcs) {
  const PlanResult result = plan(column(), back_kept(), {});
  EXPECT_TRUE(result.refusals.empty());
  EXPECT_LE(result.program.strips.size(), 4U);
  EXPECT_LE(result.verification.deviation.max, 0.3);
}

TEST(FanPlan, AnAxisThroughTheDesignIsRefusedWithThePlace) {
  Settings settings;
  settings.design.units = "mm";
  settings.slice.fan_axis = {{150, 0, 0, 0, 0, 1}};
  try {
    (void)plan(cylinder_design(), settings, {});
    FAIL() << "nothing thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind, ErrorKind::kNotCuttable);
    EXPECT_THAT(error.what(),
                AllOf(HasSubstr("face at ("), HasSubstr("no planes that turn about slice.fan_axis")));
  }
}

TEST(RibAxes, FramesTellTheirOffset) {
  RibAxes axes;
  axes.planes = surface::PlaneFamily::fan({{5, 6, 7}, {1, 2, 2}}, {0, 1, 0}, 500);
  axes.sweep = axes.planes.normal(0);
  axes.x = axes.planes.axis();
  for (const double side : {-1.0, 1.0}) {
    axes.y = side * axes.sweep.cross(axes.x);
    for (const double offset : {-700.0, -3.0, 0.0, 250.0, 1500.0}) {
      EXPECT_NEAR(axes.offset(axes.plane(offset)), offset, 1e-9);
      const Vector3d p = axes.plane(offset).point(30, 40);
      EXPECT_NEAR(std::abs(axes.planes.normal(offset).dot(p - axes.planes.centre())), 0, 1e-12);
      EXPECT_NEAR((axes.plane(offset + 1e-3).point(30, 40) - p).norm(), 1e-3 * axes.rate({30, 40}), 1e-9);
    }
  }
}

}  // namespace
}  // namespace hotblade::pipeline

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "surface/slice/ring.hpp"
#include "surface/slice/slice.hpp"
#include "tests/surface/meshes.hpp"
#include "tests/surface/slice/even_sections.hpp"

namespace hotblade::surface {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;
using ::testing::AllOf;
using ::testing::HasSubstr;

Vector3d on_torus(double a, double b) {
  const double out = 500 + 100 * std::cos(b);
  return {out * std::cos(a), out * std::sin(a), 100 * std::sin(b)};
}

// Part of a torus about z through `turn` radians: a closed tube of 100 mm at 500 mm.
TriangleSoup pipe_bend(double turn, int along, int around) {
  return grid(
      around, along, [=](double s, double t) { return on_torus(turn * (t - 0.5), 2 * pi * s); },
      [](int, int) { return true; }, true);
}

// Of its tube the arcs from -open to open about the outermost line.
TriangleSoup gutter_bend(double turn, int along, int around, double open) {
  return grid(along, around,
              [=](double s, double t) { return on_torus(turn * (s - 0.5), open * (2 * t - 1)); });
}

TEST(PlaneFamily, AFansOffsetIsTheArcAtItsRadius) {
  const FanAxis axis{{10, 20, 30}, {0, 0, 5}};
  const PlaneFamily fan = PlaneFamily::fan(axis, {1, 0, 7}, 400);
  for (const double angle : {-3.0, -0.4, 0.0, 1.0, 3.1}) {
    const Vector3d p(10 + 50 * std::cos(angle), 20 + 50 * std::sin(angle), -200);
    EXPECT_NEAR(fan.offset(p), 400 * angle, 1e-10);
    EXPECT_NEAR(fan.distance_from_axis(p), 50, 1e-12);
    EXPECT_LT((fan.normal(400 * angle) - Vector3d(-std::sin(angle), std::cos(angle), 0)).norm(), 1e-14);
    EXPECT_LT(
        (fan.turned({2, 0, 3}, 400 * angle) - Vector3d(2 * std::cos(angle), 2 * std::sin(angle), 3)).norm(),
        1e-14);
    EXPECT_LT((fan.normal_at(p) - fan.normal(400 * angle)).norm(), 1e-14);
    EXPECT_LT((fan.turned_to({2, 0, 3}, p) - fan.turned({2, 0, 3}, 400 * angle)).norm(), 1e-14);
  }
  EXPECT_EQ(fan.describe(400 * pi / 2), "90.000 degrees about the axis");
  const Vector3d on_axis(10, 20, 7);
  EXPECT_EQ(fan.normal_at(on_axis), fan.normal(fan.offset(on_axis)));
  EXPECT_EQ(PlaneFamily::parallel({0, 1, 0}).normal_at(on_axis), Vector3d(0, 1, 0));
}

TEST(PlaneFamily, RefusesAxesThatAreNone) {
  EXPECT_THROW((void)PlaneFamily::fan({{0, 0, 0}, {0, 0, 0}}, {1, 0, 0}, 1), std::logic_error);
  EXPECT_THROW((void)PlaneFamily::fan({{0, 0, 0}, {0, 0, 1}}, {0, 0, 2}, 1), std::logic_error);
  EXPECT_THROW((void)PlaneFamily::fan({{0, NAN, 0}, {0, 0, 1}}, {1, 0, 0}, 1), std::logic_error);
  EXPECT_THROW((void)PlaneFamily::fan({{0, 0, 0}, {0, 0, 1}}, {1, 0, 0}, 0), std::logic_error);
}

TEST(SliceFan, SectionsOfATorusAreItsTubesCircles) {
  const int around = 360;
  const EvenSections g = even_sections(pipe_bend(1.2, 240, around), FanAxis{{0, 0, 0}, {0, 0, 1}}, 40);
  EXPECT_EQ(g.sections.size(), 19u);  // 1.2 rad at 600 mm: 720 mm less the insets
  for (const Section& section : g.sections) {
    ASSERT_EQ(section.pieces.size(), 1u);
    EXPECT_TRUE(section.pieces[0].closed);
    // The polygon's own length; faces between the mesh's angles lie up to 0.5 (0.005 / 2)^2 of the radius
    // nearer to the axis, which flattens the circle by as little.
    const double polygon = 2 * around * 100 * std::sin(pi / around);
    EXPECT_NEAR(section.pieces[0].length_mm, polygon, 1e-5 * polygon);
  }
}

TEST(SliceFan, PointsLieOnTheirHalfPlanes) {
  const EvenSections g = even_sections(gutter_bend(2.5, 60, 24, 1.2), FanAxis{{0, 0, 0}, {0, 0, 1}}, 35);
  ASSERT_GT(g.sections.size(), 30u);
  for (const Section& section : g.sections) {
    const Vector3d n = g.planes.normal(section.offset_mm),
                   out = g.planes.turned(Vector3d::UnitX(), section.offset_mm);
    for (const SectionPiece& piece : section.pieces) {
      for (const Vector3d& q : piece.points) {
        EXPECT_NEAR(n.dot(q), 0, 1e-10);
        EXPECT_GT(out.dot(q), 400);
      }
    }
  }
}

TEST(SliceFan, EndsOnTheBorderRulingsOfACone) {
  // A conical wall: every half plane meets it in a straight line of the same length, border to border.
  const auto cone = [](double s, double t) {
    const double a = 1.5 * s, out = 300 + 200 * t;
    return Vector3d(out * std::cos(a), out * std::sin(a), 250 * t);
  };
  const EvenSections g = even_sections(grid(400, 8, cone), FanAxis{{0, 0, -50}, {0, 0, 1}}, 50, 1e-6);
  for (const Section& section : g.sections) {
    ASSERT_EQ(section.pieces.size(), 1u);
    const auto& points = section.pieces[0].points;
    EXPECT_NEAR(section.pieces[0].length_mm, std::hypot(200, 250), 1e-3);
    EXPECT_NEAR(std::min(points.front().z(), points.back().z()), 0, 1e-9);
    EXPECT_NEAR(std::max(points.front().z(), points.back().z()), 250, 1e-9);
  }
  EXPECT_NEAR(g.sections.back().offset_mm - g.sections.front().offset_mm, 1.5 * 500 - 2e-6, 1e-6);
}

TEST(SliceFan, DoesNotDependOnWhereTheDesignLies) {
  const TriangleSoup mesh = gutter_bend(1.5, 50, 20, 1.0);
  const FanAxis axis{{30, -20, 0}, {0.1, 0.05, 1}};
  const EvenSections straight = even_sections(mesh, axis, 45);
  for (int k = 0; k < 8; ++k) {
    // About the axis itself too, so that the design comes to lie across any angle's end.
    const Eigen::AngleAxisd turn(0.8 * k,
                                 k < 4 ? axis.direction.normalized() : Vector3d(1, k - 6, 2).normalized());
    const Vector3d shift(100 * k, -300, 50);
    TriangleSoup moved = mesh;
    for (Vector3d& p : moved.vertices) p = turn * p + shift;
    const EvenSections g =
        even_sections(moved, FanAxis{turn * axis.point + shift, turn * axis.direction}, 45);
    ASSERT_EQ(g.sections.size(), straight.sections.size());
    for (std::size_t i = 0; i < g.sections.size(); ++i) {
      EXPECT_NEAR(g.sections[i].offset_mm, straight.sections[i].offset_mm, 1e-7);
      EXPECT_THAT(lengths(g.sections[i]),
                  ::testing::Pointwise(::testing::DoubleNear(1e-6), lengths(straight.sections[i])));
    }
  }
}

TEST(SliceFan, AnAxisFarAwayGivesParallelPlanes) {
  const TriangleSoup mesh = dome(400, 150, 30);
  const EvenSections parallel = even_sections(mesh, Vector3d(Vector3d::UnitX()));
  // The planes at both ends are tilted by 150 mm over 10 km.
  const EvenSections fan = even_sections(mesh, FanAxis{{0, 1e7, 0}, {0, 0, 1}});
  ASSERT_EQ(fan.sections.size(), parallel.sections.size());
  for (std::size_t i = 0; i < fan.sections.size(); ++i) {
    EXPECT_NEAR(fan.sections[i].pieces.at(0).length_mm, parallel.sections[i].pieces.at(0).length_mm, 0.02);
    EXPECT_NEAR(fan.sections[i].offset_mm, parallel.sections[i].offset_mm, 0.02);
  }
}

TEST(SliceFan, AnAxisThroughOrNextToTheDesignIsRefusedWithThePlace) {
  const auto plate = [](double s, double t) { return Vector3d(200 * s, 100 * t, 0); };
  const DesignSurface design = from_mesh(grid(20, 10, plate));
  const auto refusal = [&](const FanAxis& axis) {
    return message_of<FanError>([&] { (void)fan_about(design.mesh, axis); });
  };
  EXPECT_THAT(refusal({{100, 50, 9}, {0, 0, 1}}), AllOf(HasSubstr("face at (90.000, 40.000, 0.000) mm"),
                                                        HasSubstr("at least 1 mm"), HasSubstr("fan_axis")));
  EXPECT_THAT(refusal({{-0.5, 50, 0}, {0, 0, 1}}), HasSubstr("0.500 mm"));
  EXPECT_THAT(refusal({{103, 43, 0}, {0.2, 0.1, 1}}), HasSubstr("0.000 mm"));
  EXPECT_EQ(refusal({{-1.5, 50, 0}, {0, 0, 1}}), "(nothing thrown)");
  EXPECT_EQ(refusal({{100, 50, 9}, {0, 1, 0}}), "(nothing thrown)");
}

// A conical ring about z; with an even number of cells the cut runs along vertices, with an odd one between.
TriangleSoup conical_ring(int around, int up) {
  return grid(
      around, up,
      [](double s, double t) {
        const double a = 2 * pi * s, out = 300 + 200 * t;
        return Vector3d(out * std::cos(a), out * std::sin(a), 250 * t);
      },
      [](int, int) { return true; }, true);
}

double area(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles()) {
    const auto at = [&](std::size_t i) { return mesh.vertices()[static_cast<std::size_t>(t[i])]; };
    sum += 0.5 * (at(1) - at(0)).cross(at(2) - at(0)).norm();
  }
  return sum;
}

TEST(CutOpen, KeepsTheAreaAndLeavesNoFaceAcrossTheCut) {
  for (const int around : {40, 41, 97}) {
    const TriangleMesh ring(conical_ring(around, 7));
    const PlaneFamily fan = fan_about(ring, {{0, 0, 10}, {0, 0, -2}});
    ASSERT_TRUE(fan.closed());
    const TriangleMesh open = cut_open(ring, fan);
    EXPECT_NEAR(area(open), area(ring), 1e-6 * 500);  // a billionth of a radian along a border of 320 mm
    double low = 0, high = 0;
    for (const auto& t : open.triangles()) {
      std::array<double, 3> angle{};
      for (std::size_t i = 0; i < 3; ++i)
        angle[i] = fan.angle(fan.offset(open.vertices()[static_cast<std::size_t>(t[i])]));
      const auto [least, most] = std::minmax_element(angle.begin(), angle.end());
      EXPECT_LT(*most - *least, 2 * pi / around + 1e-8) << around;
      low = std::min(low, *least);
      high = std::max(high, *most);
    }
    EXPECT_NEAR(low, -pi, 2e-9);
    EXPECT_NEAR(high, pi, 2e-9);
  }
}

TEST(SliceFan, ADesignRoundTheAxisIsCutFromCutToCut) {
  for (const int around : {300, 301}) {
    const EvenSections g = even_sections(conical_ring(around, 6), FanAxis{{0, 0, 0}, {0, 0, 1}}, 60, 0.05);
    EXPECT_NEAR(g.sections.front().offset_mm, -500 * pi + 0.05, 1e-5);
    EXPECT_NEAR(g.sections.back().offset_mm, 500 * pi - 0.05, 1e-5);
    for (const Section& section : g.sections) {
      ASSERT_EQ(section.pieces.size(), 1u);
      // Rulings of the cone; facets of 0.021 rad lie within 0.03 mm of it.
      EXPECT_NEAR(section.pieces[0].length_mm, std::hypot(200, 250), 0.02);
      EXPECT_FALSE(section.pieces[0].closed);
    }
  }
}

}  // namespace
}  // namespace hotblade::surface

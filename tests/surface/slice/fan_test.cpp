#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "surface/slice/event_planes.hpp"
#include "surface/slice/ring.hpp"
#include "surface/slice/slice.hpp"
#include "tests/surface/meshes.hpp"

namespace hotblade::surface {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;
using ::testing::AllOf;
using ::testing::HasSubstr;

SliceOptions about(const FanAxis& axis, double spacing = 20, double inset = 0.05) {
  SliceOptions options;
  options.fan = axis;
  options.spacing_mm = spacing;
  options.end_inset_mm = inset;
  return options;
}

const SectionPiece& rib(const RibGraph& graph, const RibRef& ref) {
  return graph.sections[static_cast<std::size_t>(ref.section)].pieces[static_cast<std::size_t>(ref.piece)];
}

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
  }
  EXPECT_EQ(fan.describe(400 * pi / 2), "90.000 degrees about the axis");
}

TEST(PlaneFamily, RefusesAxesThatAreNone) {
  EXPECT_THROW((void)PlaneFamily::fan({{0, 0, 0}, {0, 0, 0}}, {1, 0, 0}, 1), std::logic_error);
  EXPECT_THROW((void)PlaneFamily::fan({{0, 0, 0}, {0, 0, 1}}, {0, 0, 2}, 1), std::logic_error);
  EXPECT_THROW((void)PlaneFamily::fan({{0, NAN, 0}, {0, 0, 1}}, {1, 0, 0}, 1), std::logic_error);
  EXPECT_THROW((void)PlaneFamily::fan({{0, 0, 0}, {0, 0, 1}}, {1, 0, 0}, 0), std::logic_error);
}

TEST(SliceFan, SectionsOfATorusAreItsTubesCircles) {
  const int around = 360;
  const RibGraph g = slice(from_mesh(pipe_bend(1.2, 240, around)), about({{0, 0, 0}, {0, 0, 1}}, 40));
  ASSERT_EQ(g.chains.size(), 2u);  // the loops are cut open
  ASSERT_EQ(g.chains[0].ribs.size(), g.sections.size());
  EXPECT_EQ(g.sections.size(), 19u);  // 1.2 rad at 600 mm: 720 mm less the insets
  for (std::size_t i = 0; i < g.sections.size(); ++i) {
    const double length = rib(g, g.chains[0].ribs[i]).length_mm + rib(g, g.chains[1].ribs[i]).length_mm;
    // The polygon's own length; faces between the mesh's angles lie up to 0.5 (0.005 / 2)^2 of the radius
    // nearer to the axis, which flattens the circle by as little.
    const double polygon = 2 * around * 100 * std::sin(pi / around);
    EXPECT_NEAR(length, polygon, 1e-5 * polygon);
    EXPECT_NEAR(length, 200 * pi, 2e-5 * 200 * pi);
  }
}

TEST(SliceFan, PointsLieOnTheirHalfPlanes) {
  const RibGraph g = slice(from_mesh(gutter_bend(2.5, 60, 24, 1.2)), about({{0, 0, 0}, {0, 0, 1}}, 35));
  ASSERT_EQ(g.chains.size(), 1u);
  for (const Section& section : g.sections) {
    const Vector3d n = g.planes.normal(section.offset_mm),
                   out = g.planes.turned(Vector3d::UnitX(), section.offset_mm);
    for (const SectionPiece& piece : section.pieces) {
      for (const SectionPoint& q : piece.points) {
        EXPECT_NEAR(n.dot(q.p), 0, 1e-10);
        EXPECT_GT(out.dot(q.p), 400);
        EXPECT_NEAR(q.normal.norm(), 1, 1e-12);
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
  const RibGraph g = slice(from_mesh(grid(400, 8, cone)), about({{0, 0, -50}, {0, 0, 1}}, 50, 1e-6));
  ASSERT_EQ(g.chains.size(), 1u);
  EXPECT_EQ(g.chains[0].ribs.size(), g.sections.size());
  for (const RibRef& ref : g.chains[0].ribs) {
    const auto& points = rib(g, ref).points;
    EXPECT_NEAR(rib(g, ref).length_mm, std::hypot(200, 250), 1e-3);
    EXPECT_NEAR(std::min(points.front().p.z(), points.back().p.z()), 0, 1e-9);
    EXPECT_NEAR(std::max(points.front().p.z(), points.back().p.z()), 250, 1e-9);
  }
  EXPECT_NEAR(g.sections.back().offset_mm - g.sections.front().offset_mm, 1.5 * 500 - 2e-6, 1e-6);
}

TEST(SliceFan, DoesNotDependOnWhereTheDesignLies) {
  const TriangleSoup mesh = gutter_bend(1.5, 50, 20, 1.0);
  const FanAxis axis{{30, -20, 0}, {0.1, 0.05, 1}};
  const RibGraph straight = slice(from_mesh(mesh), about(axis, 45));
  for (int k = 0; k < 8; ++k) {
    // About the axis itself too, so that the design comes to lie across any angle's end.
    const Eigen::AngleAxisd turn(0.8 * k,
                                 k < 4 ? axis.direction.normalized() : Vector3d(1, k - 6, 2).normalized());
    const Vector3d shift(100 * k, -300, 50);
    TriangleSoup moved = mesh;
    for (Vector3d& p : moved.vertices) p = turn * p + shift;
    const RibGraph g = slice(from_mesh(moved), about({turn * axis.point + shift, turn * axis.direction}, 45));
    ASSERT_EQ(g.sections.size(), straight.sections.size());
    ASSERT_EQ(g.chains.size(), straight.chains.size());
    const auto lengths = [](const Section& section) {
      std::vector<double> all;
      for (const SectionPiece& piece : section.pieces) all.push_back(piece.length_mm);
      std::sort(all.begin(), all.end());
      return all;
    };
    for (std::size_t i = 0; i < g.sections.size(); ++i) {
      EXPECT_NEAR(g.sections[i].offset_mm, straight.sections[i].offset_mm, 1e-7);
      EXPECT_THAT(lengths(g.sections[i]),
                  ::testing::Pointwise(::testing::DoubleNear(1e-6), lengths(straight.sections[i])));
    }
  }
}

TEST(SliceFan, AnAxisFarAwayGivesParallelPlanes) {
  const TriangleSoup mesh = dome(400, 150, 30);
  SliceOptions options;
  options.normal = Vector3d::UnitX();
  const RibGraph parallel = slice(from_mesh(mesh), options);
  // The planes at both ends are tilted by 150 mm over 10 km.
  const RibGraph fan = slice(from_mesh(mesh), about({{0, 1e7, 0}, {0, 0, 1}}));
  ASSERT_EQ(fan.sections.size(), parallel.sections.size());
  ASSERT_EQ(fan.chains.size(), 1u);
  for (std::size_t i = 0; i < fan.sections.size(); ++i) {
    const SectionPiece &a = rib(fan, fan.chains[0].ribs[i]), &b = rib(parallel, parallel.chains[0].ribs[i]);
    EXPECT_NEAR(a.length_mm, b.length_mm, 0.02);
    EXPECT_NEAR(fan.sections[i].offset_mm, parallel.sections[i].offset_mm, 0.02);
  }
}

TEST(SliceFan, StripsReachUpToAWindowsAngles) {
  const auto panel = [](double s, double t) {
    const double a = 0.9 * s, out = 400 + 300 * t;
    return Vector3d(out * std::cos(a), out * std::sin(a), 0);
  };
  const TriangleSoup mesh =
      grid(45, 30, panel, [](int i, int j) { return !(i >= 15 && i < 30 && j >= 10 && j < 20); });
  const RibGraph g = slice(from_mesh(mesh), about({{0, 0, 0}, {0, 0, 1}}, 25));
  ASSERT_EQ(g.chains.size(), 4u);  // before, two beside it, behind
  const double from = 700 * (0.3 - 0.45), to = 700 * (0.6 - 0.45);
  for (const Chain& c : g.chains) {
    const double first = g.sections[static_cast<std::size_t>(c.ribs.front().section)].offset_mm,
                 last = g.sections[static_cast<std::size_t>(c.ribs.back().section)].offset_mm;
    for (const double end : {first, last}) {
      const double away =
          std::min({std::abs(end - from), std::abs(end - to), std::abs(end + 315), std::abs(end - 315)});
      EXPECT_LT(away, 0.06) << end;
    }
  }
}

TEST(SliceFan, AnAxisThroughOrNextToTheDesignIsRefusedWithThePlace) {
  const auto plate = [](double s, double t) { return Vector3d(200 * s, 100 * t, 0); };
  const DesignSurface design = from_mesh(grid(20, 10, plate));
  const auto refusal = [&](const FanAxis& axis) {
    return message_of<FanError>([&] { (void)slice(design, about(axis)); });
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

TEST(SliceFan, ADesignRoundTheAxisIsOneChainFromCutToCut) {
  for (const int around : {300, 301}) {
    const RibGraph g = slice(from_mesh(conical_ring(around, 6)), about({{0, 0, 0}, {0, 0, 1}}, 60, 0.05));
    ASSERT_EQ(g.chains.size(), 1u);
    EXPECT_EQ(g.chains[0].ribs.size(), g.sections.size());
    EXPECT_NEAR(g.sections.front().offset_mm, -500 * pi + 0.05, 1e-5);
    EXPECT_NEAR(g.sections.back().offset_mm, 500 * pi - 0.05, 1e-5);
    for (const RibRef& ref : g.chains[0].ribs) {
      // Rulings of the cone; facets of 0.021 rad lie within 0.03 mm of it.
      EXPECT_NEAR(rib(g, ref).length_mm, std::hypot(200, 250), 0.02);
      EXPECT_FALSE(rib(g, ref).closed);
    }
  }
}

TEST(SliceFan, RefusesAnAxisThatIsNotFinite) {
  const DesignSurface design = from_mesh(gutter_bend(1, 8, 8, 1.0));
  EXPECT_THROW((void)slice(design, about({{0, 0, INFINITY}, {0, 0, 1}})), std::logic_error);
  EXPECT_THROW((void)slice(design, about({{0, 0, 0}, {0, 0, 0}})), std::logic_error);
}

}  // namespace
}  // namespace hotblade::surface

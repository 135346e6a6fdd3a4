// Sections against lengths known exactly, and what must not change them.
#include "surface/slice/slice.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "tests/surface/meshes.hpp"
#include "tests/surface/slice/even_sections.hpp"

namespace hotblade::surface {
namespace {

using Eigen::Vector3d;
using ::testing::SizeIs;

Vector3d plate(double s, double t) {
  return {200 * s, 100 * t, 0};
}

template <class F>
void for_each_point(const EvenSections& cut, const F& f) {
  for (const Section& section : cut.sections) {
    for (const SectionPiece& piece : section.pieces) {
      for (const Vector3d& q : piece.points) f(section, q);
    }
  }
}

// Along the normal, from the design frame's origin.
double height(const EvenSections& cut, const Section& section) {
  return section.offset_mm + cut.planes.normal(0).dot(cut.planes.centre());
}

double distance_to_edges(const TriangleSoup& mesh, const Vector3d& p) {
  double best = std::numeric_limits<double>::infinity();
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3d& a = mesh.vertices[static_cast<std::size_t>(t[i])];
      const Vector3d d = mesh.vertices[static_cast<std::size_t>(t[(i + 1) % 3])] - a;
      best = std::min(best, (p - a - std::clamp(d.dot(p - a) / d.squaredNorm(), 0.0, 1.0) * d).norm());
    }
  }
  return best;
}

TEST(Slice, CutsAPlateIntoStraightEqualPieces) {
  const EvenSections cut = even_sections(grid(13, 7, plate), Vector3d::UnitX());
  EXPECT_GT(cut.sections.size(), 10U);
  for (const Section& section : cut.sections) {
    ASSERT_THAT(section.pieces, SizeIs(1));
    EXPECT_NEAR(section.pieces[0].length_mm, 100, 1e-10);
    EXPECT_FALSE(section.pieces[0].closed);
  }
}

TEST(Slice, RunsTheOtherWayWhereTheOtherSideIsTheFront) {
  TriangleSoup mesh = grid(13, 7, plate);
  const SectionPiece front = even_sections(mesh, Vector3d::UnitX()).sections.at(3).pieces.at(0);
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  const SectionPiece back = even_sections(mesh, Vector3d::UnitX()).sections.at(3).pieces.at(0);
  EXPECT_EQ(front.points.front(), back.points.back());
  EXPECT_EQ(front.points.back(), back.points.front());
  // Curve, plane's normal and surface normal are right-handed.
  const Vector3d way = front.points.back() - front.points.front();
  EXPECT_GT(way.cross(Vector3d::UnitX()).z(), 0);
}

TEST(Slice, CutsExactlyThroughVertices) {
  // Planes at x = 20, 40, ... 180, each through a row of vertices.
  const EvenSections cut = even_sections(grid(10, 5, plate), Vector3d::UnitX(), 20, 20);
  ASSERT_THAT(cut.sections, SizeIs(9));
  for (const Section& section : cut.sections) {
    ASSERT_THAT(section.pieces, SizeIs(1));
    std::vector<Vector3d> points = section.pieces[0].points;
    ASSERT_THAT(points, SizeIs(6));
    if (points.front().y() > 0) std::reverse(points.begin(), points.end());
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_EQ(points[i], Vector3d(height(cut, section), 20.0 * static_cast<double>(i), 0));
  }
}

TEST(Slice, CutsDiagonallyThroughVertices) {
  const auto square = [](double s, double t) { return Vector3d(80 * s, 80 * t, 0); };
  const EvenSections cut = even_sections(grid(8, 8, square), Vector3d(1, 1, 0), 5, std::sqrt(2.0) * 5);
  for (const Section& section : cut.sections) {
    ASSERT_THAT(section.pieces, SizeIs(1));
    const double from_corner = std::min(height(cut, section), 80 * std::sqrt(2.0) - height(cut, section));
    EXPECT_NEAR(section.pieces[0].length_mm, 2 * from_corner, 1e-10);
  }
}

TEST(Slice, PutsPointsOnThePlaneAndOnTheMesh) {
  const TriangleSoup mesh = dome(400, 150, 9);
  const Vector3d normal = Vector3d(3, 1, -0.4).normalized();
  const EvenSections cut = even_sections(mesh, normal);
  for_each_point(cut, [&](const Section& section, const Vector3d& q) {
    EXPECT_NEAR(normal.dot(q), height(cut, section), 1e-11);
    EXPECT_LT(distance_to_edges(mesh, q), 1e-11);
  });
}

TEST(Slice, EndsOpenPiecesOnTheBorder) {
  for (const Section& section : even_sections(dome(400, 150, 9), Vector3d(3, 1, -0.4)).sections) {
    for (const SectionPiece& piece : section.pieces) {
      for (const Vector3d& end : {piece.points.front(), piece.points.back()})
        EXPECT_NEAR(end.head<2>().cwiseAbs().maxCoeff(), 150, 1e-10);
    }
  }
}

TEST(Slice, LengthsOnADomeAreThoseOfCircularArcs) {
  const EvenSections cut = even_sections(dome(400, 150, 300), Vector3d::UnitX(), 50);
  for (const Section& section : cut.sections) {
    const double r = std::sqrt(400 * 400 - height(cut, section) * height(cut, section));
    EXPECT_NEAR(section.pieces.at(0).length_mm, 2 * r * std::asin(150 / r), 1e-3);
  }
}

TEST(Slice, LoopsOfATubeAreClosedAndStartAtTheirSmallestPoint) {
  const double around = 48 * 200 * std::sin(std::numbers::pi / 48);
  for (const Section& section : even_sections(tube(100, 200, 48, 10), Vector3d::UnitZ()).sections) {
    ASSERT_THAT(section.pieces, SizeIs(1));
    const SectionPiece& loop = section.pieces[0];
    EXPECT_TRUE(loop.closed);
    EXPECT_NEAR(loop.length_mm, around, 1e-9);
    EXPECT_NEAR(loop.points.front().x(), -100, 1e-9);
  }
}

TEST(Slice, AWindowPartsItsSectionsInTwo) {
  const auto window = [](int i, int j) { return i < 10 || i > 16 || j < 5 || j > 9; };
  const EvenSections cut = even_sections(grid(30, 20, plate, window), Vector3d::UnitX(), 4);
  for (const Section& section : cut.sections) {
    const double x = height(cut, section), from = 200.0 * 10 / 30, to = 200.0 * 17 / 30;
    EXPECT_THAT(section.pieces, SizeIs(x > from && x < to ? 2 : 1)) << x;
  }
}

TEST(Slice, IsTheSameForATurnedDesign) {
  const auto wave = [](double s, double t) {
    return Vector3d(300 * s, 200 * t, 30 * std::sin(5 * s + 2 * t) + 10 * std::cos(9 * t));
  };
  const auto frame = [](int i, int j) { return i < 10 || i > 16 || j < 5 || j > 9; };
  const TriangleSoup mesh = grid(30, 20, wave, frame);
  std::mt19937 random(3);
  std::normal_distribution<double> any;
  const EvenSections straight = even_sections(mesh, Vector3d(1, 0.2, 0.1));
  for (int round = 0; round < 20; ++round) {
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond(any(random), any(random), any(random), any(random)).normalized();
    TriangleSoup turned = mesh;
    for (Vector3d& p : turned.vertices) p = turn * p;
    const EvenSections cut = even_sections(turned, turn * Vector3d(1, 0.2, 0.1));
    ASSERT_EQ(cut.sections.size(), straight.sections.size());
    for (std::size_t k = 0; k < cut.sections.size(); ++k)
      EXPECT_THAT(lengths(cut.sections[k]),
                  ::testing::Pointwise(::testing::DoubleNear(1e-8), lengths(straight.sections[k])));
  }
}

TEST(Slice, DoesNotDependOnTheOrderOfFaces) {
  TriangleSoup mesh = tube(100, 200, 48, 10);
  for (Vector3d& p : mesh.vertices) p.x() += 0.3 * p.z() + 20 * std::sin(p.y() / 30);
  TriangleSoup shuffled = mesh;
  std::mt19937 random(5);
  std::shuffle(shuffled.triangles.begin(), shuffled.triangles.end(), random);
  for (auto& t : shuffled.triangles) std::rotate(t.begin(), t.begin() + 1, t.end());
  for (const Vector3d& normal : {Vector3d(0, 0, 1), Vector3d(1, 0, 0), Vector3d(1, 2, 3)}) {
    const EvenSections sorted = even_sections(mesh, normal), other = even_sections(shuffled, normal);
    ASSERT_EQ(other.sections.size(), sorted.sections.size());
    for (std::size_t k = 0; k < sorted.sections.size(); ++k) {
      ASSERT_EQ(other.sections[k].pieces.size(), sorted.sections[k].pieces.size());
      for (std::size_t i = 0; i < sorted.sections[k].pieces.size(); ++i)
        EXPECT_EQ(other.sections[k].pieces[i].points, sorted.sections[k].pieces[i].points);
    }
  }
}

TEST(Slice, NeverRepeatsAPoint) {
  std::mt19937 random(9);
  std::uniform_int_distribution<int> whole(-3, 3);
  const TriangleSoup mesh = dome(400, 150, 10);
  for (int round = 0; round < 200; ++round) {
    const Vector3d normal(whole(random), whole(random), 0);
    if (normal.isZero()) continue;
    for (const Section& section : even_sections(mesh, normal, 15, 30).sections) {
      for (const SectionPiece& piece : section.pieces) {
        ASSERT_GE(piece.points.size(), 2U);
        double length = 0;
        for (std::size_t i = 1; i < piece.points.size(); ++i) {
          const double step = (piece.points[i] - piece.points[i - 1]).norm();
          EXPECT_GT(step, 0);
          length += step;
        }
        EXPECT_NEAR(length, piece.length_mm, 1e-9);
      }
    }
  }
}

}  // namespace
}  // namespace hotblade::surface

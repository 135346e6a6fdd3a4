#include "surface/slice/smooth_faces.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

namespace hotblade::surface {
namespace {

using Eigen::Vector3d;

constexpr CreaseLimits kLimits{1, 110};

// A sheet of cells over [0, 1] x [0, 1], each of two triangles.
TriangleSoup sheet(int columns, int rows, const std::function<Vector3d(double, double)>& at) {
  TriangleSoup soup;
  for (int i = 0; i <= columns; ++i)
    for (int j = 0; j <= rows; ++j)
      soup.vertices.push_back(at(static_cast<double>(i) / columns, static_cast<double>(j) / rows));
  for (int i = 0; i < columns; ++i) {
    for (int j = 0; j < rows; ++j) {
      const int k = i * (rows + 1) + j;
      soup.triangles.push_back({k, k + rows + 1, k + rows + 2});
      soup.triangles.push_back({k, k + rows + 2, k + 1});
    }
  }
  return soup;
}

// Two plates that meet at x = 600 `share`, each rising by `slope` away from it.
TriangleSoup folded(double slope, int columns = 60, double share = 0.5) {
  return sheet(columns, 20, [&](double u, double v) {
    return Vector3d(600 * u, 400 * v, slope * 600 * std::abs(u - share));
  });
}

TEST(Creases, PartPlatesWhereTheyFold) {
  for (const int columns : {2, 6, 60, 600}) {
    const TriangleMesh mesh(folded(0.5, columns));
    const std::vector<TriangleMesh> faces = smooth_faces(mesh, kLimits);
    ASSERT_EQ(faces.size(), 2U) << columns;
    EXPECT_EQ(faces[0].triangles().size(), mesh.triangles().size() / 2);
    EXPECT_EQ(faces[1].triangles().size(), mesh.triangles().size() / 2);
    for (const Vector3d& p : faces[0].vertices()) EXPECT_LE(p.x(), 300 + 1e-9);
    for (const Vector3d& p : faces[1].vertices()) EXPECT_GE(p.x(), 300 - 1e-9);
    EXPECT_EQ(creases(mesh, kLimits).edges.size(), 20U);
  }
}

TEST(Creases, FoundAgainAreTheSameAndOfTheLimitsAskedFor) {
  const TriangleMesh mesh(folded(0.08)), other(folded(0.08)), copy = mesh;
  const CreaseLimits shallow{kLimits.tolerance_mm, kLimits.least_radius_mm, true},
      close{0.01, kLimits.least_radius_mm};
  for (int again = 0; again < 2; ++again) {
    EXPECT_TRUE(creases(mesh, kLimits).empty());
    EXPECT_EQ(creases(copy, shallow).edges.size(), 20U);
    EXPECT_EQ(creases(mesh, shallow).edges, creases(other, shallow).edges);
    EXPECT_EQ(creases(copy, close).edges.size(), 20U);
  }
}

TEST(Creases, TellWhichFaceATriangleIsOf) {
  const TriangleMesh mesh(folded(0.5));
  std::vector<int> face_of;
  (void)smooth_faces(mesh, kLimits, &face_of);
  ASSERT_EQ(face_of.size(), mesh.triangles().size());
  for (std::size_t f = 0; f < face_of.size(); ++f) {
    double x = 0;
    for (const int v : mesh.triangles()[f]) x += mesh.vertices()[static_cast<std::size_t>(v)].x() / 3;
    EXPECT_EQ(face_of[f], x > 300 ? 1 : 0);
  }
}

// 110 mm rounds a fold of 4 degrees by 0.03 mm, and a fold of 20 by 0.8 mm to either side.
TEST(Creases, AreNoneWhereABladeRoundsThem) {
  for (const double slope : {0.03, 0.15}) {
    const TriangleMesh mesh(folded(slope));
    EXPECT_TRUE(creases(mesh, kLimits).empty()) << slope;
    const std::vector<TriangleMesh> faces = smooth_faces(mesh, kLimits);
    ASSERT_EQ(faces.size(), 1U);
    EXPECT_EQ(faces[0].triangles().size(), mesh.triangles().size());
  }
  EXPECT_EQ(smooth_faces(TriangleMesh(folded(0.15)), {0.3, 110}).size(), 2U);
  EXPECT_EQ(smooth_faces(TriangleMesh(folded(0.5)), {40, 110}).size(), 1U);
}

// But no family of elastica goes far to both sides of one.
TEST(Creases, AreShallowFoldsThatStandAloneWhereTheseAreAskedFor) {
  constexpr CreaseLimits kShallow{1, 110, true};
  for (const int columns : {2, 6, 60, 600}) {
    EXPECT_EQ(creases(TriangleMesh(folded(0.15, columns)), kShallow).edges.size(), 20U) << columns;
    EXPECT_EQ(smooth_faces(TriangleMesh(folded(0.15, columns)), kShallow).size(), 2U) << columns;
  }
  // On so little to its sides a smooth surface goes through: 32 mm by the fold of 0.06 rad.
  EXPECT_TRUE(creases(TriangleMesh(folded(0.03)), kShallow).empty());
  EXPECT_TRUE(creases(TriangleMesh(folded(0.15, 60, 0.1)), kShallow).empty());
  // Facets fold at all of their edges, and so do steps.
  const TriangleMesh steps(sheet(12, 20, [](double u, double v) {
    return Vector3d(1800 * u, 400 * v, 0.15 * 150 * std::abs(std::remainder(12 * u, 2.0)));
  }));
  EXPECT_TRUE(creases(steps, kShallow).empty());
}

// Two plates of 300 mm that meet in a fold, with an arc of so many facets along it, or a chamfer of one.
TriangleSoup filleted(double fold, double radius, int facets, int columns = 30) {
  std::vector<Eigen::Vector2d> line;
  const double flat = radius * std::tan(fold / 2);
  for (int i = columns; i >= 1; --i) {
    const double way = flat + (300 - flat) * i / columns;
    line.emplace_back(-way * std::cos(fold / 2), -way * std::sin(fold / 2));
  }
  for (int i = 0; i <= facets; ++i) {
    const double angle = fold * (static_cast<double>(i) / facets - 0.5);
    line.emplace_back(radius * std::sin(angle), radius * (std::cos(angle) - 1 / std::cos(fold / 2)));
  }
  for (int i = columns - 1; i >= 0; --i) {
    const Eigen::Vector2d p = line[static_cast<std::size_t>(i)];
    line.emplace_back(-p.x(), p.y());
  }
  return sheet(static_cast<int>(line.size()) - 1, 20, [&](double u, double v) {
    const auto& p = line[static_cast<std::size_t>(std::lround(u * static_cast<double>(line.size() - 1)))];
    return Vector3d(p.x(), 400 * v, p.y());
  });
}

// A fillet misses the corner by r (1 / cos(fold / 2) - 1): as long as that is within the tolerance and the
// band is narrow the design is parted there.
TEST(Creases, AreTheMiddlesOfChamfersAndFilletsThatACornerStandsFor) {
  for (const double fold : {0.7, 1.05, 1.57, 2.2}) {
    for (const int facets : {1, 2, 3, 6, 7, 40}) {
      const double middle = facets % 2 == 0 ? 1.0 : std::cos(0.5 * fold / facets),
                   within = std::min(0.9 / (1 - middle * std::cos(fold / 2)), 7.9 / fold);
      for (const double radius : {0.2 * within, within}) {
        const TriangleMesh mesh(filleted(fold, radius, facets));
        std::vector<int> face_of;
        const std::vector<TriangleMesh> faces = smooth_faces(mesh, kLimits, &face_of);
        ASSERT_EQ(faces.size(), 2U) << fold << " rad, " << radius << " mm, " << facets << " facets";
        const double half = radius * std::sin(0.5 * fold);
        for (const Vector3d& p : faces[0].vertices()) EXPECT_LE(p.x(), 1e-9 - half);
        for (const Vector3d& p : faces[1].vertices()) EXPECT_GE(p.x(), half - 1e-9);
        for (const int face : {0, 1})
          EXPECT_EQ(std::count(face_of.begin(), face_of.end(), face),
                    std::ssize(faces[static_cast<std::size_t>(face)].triangles()));
        EXPECT_EQ(std::count(face_of.begin(), face_of.end(), -1), 40 * facets) << "the band is of no face";
      }
      EXPECT_EQ(smooth_faces(TriangleMesh(filleted(fold, 4 * within, facets)), kLimits).size(), 1U)
          << fold << " rad, " << facets << " facets: no corner is within the tolerance";
    }
  }
}

// Those that are off by more are creases where shallow folds are, but none that a strip's ends do
// not bridge.
TEST(Creases, AreFilletsFarFromTheirCornersWhereShallowFoldsAreAskedFor) {
  constexpr CreaseLimits kShallow{1, 110, true};
  for (const double fold : {0.3, 0.7, 1.57}) {
    for (const int facets : {1, 2, 5}) {
      const auto faces_of_band = [&](double band_mm) {
        const double chord_mm = 2 * std::sin(0.5 * fold / facets) * facets;
        return smooth_faces(TriangleMesh(filleted(fold, band_mm / chord_mm, facets)), kShallow).size();
      };
      EXPECT_EQ(faces_of_band(7.9), 2U) << fold << " rad, " << facets << " facets";
      EXPECT_EQ(faces_of_band(2), 2U) << fold << " rad, " << facets << " facets";
      if (fold > 1) continue;  // one facet's share is a crease by itself
      EXPECT_EQ(faces_of_band(24), 1U) << fold << " rad, " << facets << " facets";
    }
  }
}

// Nor is one where both sides do not go on for as long as beside a crease.
TEST(Creases, AreNotNarrowBendsOfASmoothSurface) {
  for (const int columns : {60, 300, 1200}) {
    const TriangleMesh waves(sheet(
        columns, 20, [](double u, double v) { return Vector3d(600 * u, 400 * v, 4 * std::sin(60 * u)); }));
    EXPECT_TRUE(creases(waves, kLimits).empty()) << columns;
    // A ridge of 12 mm on a plate.
    const TriangleMesh ridge(sheet(columns, 20, [](double u, double v) {
      return Vector3d(600 * u, 400 * v, 5 * std::exp(-std::pow((600 * u - 300) / 12, 2)));
    }));
    EXPECT_EQ(smooth_faces(ridge, kLimits).size(), 1U) << columns;
  }
}

// A mesh of a smooth surface folds at all of its edges.
TEST(Creases, AreNotTheChordsOfArcs) {
  for (const int columns : {8, 16, 60, 400}) {
    const TriangleMesh arc(sheet(columns, 20, [](double u, double v) {
      const double angle = std::numbers::pi * (u - 0.5);
      return Vector3d(80 * std::sin(angle), 400 * v, 80 * std::cos(angle));
    }));
    EXPECT_TRUE(creases(arc, kLimits).empty()) << columns;
    const TriangleMesh dome(sheet(columns, columns, [](double u, double v) {
      return Vector3d(300 * u, 300 * v, 60 * std::sin(3 * u) * std::cos(3 * v));
    }));
    EXPECT_TRUE(creases(dome, kLimits).empty()) << columns;
  }
}

// Plates in so many directions, which fall by this slope from where they meet, over 480 x 480 mm in cells of
// 4 mm whose corners lie up to `shift` cells beside their places: folds cross the cells.
TriangleSoup roof_over_cells(int plates, double turned, double slope, double shift) {
  constexpr int kCells = 120;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> beside(-shift / kCells, shift / kCells);
  const auto inside = [&](double u) { return u > 0 && u < 1 ? u + beside(random) : u; };
  return sheet(kCells, kCells, [&](double u, double v) {
    Vector3d p(480 * (inside(u) - 0.5), 480 * (inside(v) - 0.5), 0);
    double highest = -1e9;
    for (int i = 0; i < plates; ++i) {
      const double angle = turned + 2 * std::numbers::pi * i / plates;
      highest = std::max(highest, p.x() * std::cos(angle) + p.y() * std::sin(angle));
    }
    p.z() = -slope * highest;
    return p;
  });
}

// A mesh that does not know of a fold has teeth along it, as tall as the fold is sharp.
TEST(Creases, AreTeethOfCellsThatAFoldCrosses) {
  for (const int plates : {2, 3, 4}) {
    for (const double turned : {0.02, 0.2, 0.45, 0.7}) {
      for (const double shift : {0.0, 0.25}) {
        const TriangleMesh mesh(roof_over_cells(plates, turned, 0.4, shift));
        std::vector<int> face_of;
        const std::vector<TriangleMesh> faces = smooth_faces(mesh, kLimits, &face_of);
        ASSERT_EQ(faces.size(), static_cast<std::size_t>(plates)) << turned << " rad, shifted by " << shift;
        // A side is one plate, with teeth that it keeps its direction for.
        for (const TriangleMesh& face : faces) {
          Vector3d middle = Vector3d::Zero();
          for (const Vector3d& p : face.vertices()) middle += p / static_cast<double>(face.vertices().size());
          const double angle = std::atan2(middle.y(), middle.x());
          const double step = 2 * std::numbers::pi / plates;
          const double own = turned + step * std::round((angle - turned) / step);
          for (const Vector3d& p : face.vertices())
            EXPECT_NEAR(p.z(), -0.4 * (p.x() * std::cos(own) + p.y() * std::sin(own)), kLimits.tolerance_mm);
        }
        const auto bands = std::count(face_of.begin(), face_of.end(), -1);
        EXPECT_LT(bands, 2 * 3 * 120 * plates) << "three cells across each fold, of two triangles";
      }
    }
  }
  // A dent in such cells is none: its sides do not keep their directions.
  const TriangleMesh dents(sheet(120, 120, [](double u, double v) {
    return Vector3d(480 * u, 480 * v, 4 * std::abs(std::sin(40 * u + 17 * v)));
  }));
  EXPECT_EQ(smooth_faces(dents, kLimits).size(), 1U);
}

TEST(Creases, AreNotInNoise) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 4);
  const TriangleMesh mesh(
      sheet(60, 60, [&](double u, double v) { return Vector3d(600 * u, 600 * v, noise(random)); }));
  EXPECT_EQ(smooth_faces(mesh, kLimits).size(), 1U);
}

// The number of a place, which gets one where it has none.
int number_of(TriangleSoup& soup, const Vector3d& p) {
  const auto known = std::find_if(soup.vertices.begin(), soup.vertices.end(),
                                  [&](const Vector3d& q) { return (p - q).norm() < 1e-6; });
  const auto k = static_cast<int>(known - soup.vertices.begin());
  if (known == soup.vertices.end()) soup.vertices.push_back(p);
  return k;
}

// A convex polygon as triangles about its middle, their outer edges some 15 mm long.
void add_polygon(TriangleSoup& soup, const std::vector<Vector3d>& corners) {
  Vector3d middle = Vector3d::Zero();
  for (const Vector3d& p : corners) middle += p / static_cast<double>(corners.size());
  std::vector<int> ring;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector3d edge = corners[(i + 1) % corners.size()] - corners[i];
    const int parts = std::max(1, static_cast<int>(std::lround(edge.norm() / 15)));
    for (int k = 0; k < parts; ++k) ring.push_back(number_of(soup, corners[i] + k * edge / parts));
  }
  for (std::size_t i = 0; i < ring.size(); ++i)
    soup.triangles.push_back({number_of(soup, middle), ring[i], ring[(i + 1) % ring.size()]});
}

// Hips fade towards the ridge's end, where their faces are narrow. The ridge goes no farther.
TEST(Creases, OfAHippedRoofPartItInFour) {
  for (const double ridge : {60.0, 200.0, 330.0}) {
    for (const double slope : {0.5, 0.7, 1.2}) {
      TriangleSoup soup;
      const double b = 286, drop = -slope * b;
      const Vector3d left(-ridge, 0, 0), right(ridge, 0, 0);
      const Vector3d a(-ridge - b, -b, drop), c(ridge + b, -b, drop), d(ridge + b, b, drop),
          e(-ridge - b, b, drop);
      add_polygon(soup, {a, c, right, left});
      add_polygon(soup, {d, e, left, right});
      add_polygon(soup, {c, d, right});
      add_polygon(soup, {e, a, left});
      const std::vector<TriangleMesh> faces = smooth_faces(TriangleMesh(soup), kLimits);
      EXPECT_EQ(faces.size(), 4U) << ridge << " mm, " << slope;
    }
  }
}

// A triangle in n parts along each edge.
void add_triangle(TriangleSoup& soup, const Vector3d& a, const Vector3d& b, const Vector3d& c, int n) {
  const auto number = [&](int i, int j) { return number_of(soup, a + i * (b - a) / n + j * (c - a) / n); };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; i + j < n; ++j) {
      soup.triangles.push_back({number(i, j), number(i + 1, j), number(i, j + 1)});
      if (i + j + 1 < n) soup.triangles.push_back({number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)});
    }
  }
}

TEST(Creases, OfAHippedRoofMeetInItsPoint) {
  const std::array<Vector3d, 4> corners{Vector3d(0, 0, 0), Vector3d(800, 0, 0), Vector3d(800, 800, 0),
                                        Vector3d(0, 800, 0)};
  for (const int n : {1, 12}) {
    TriangleSoup roof;
    for (std::size_t i = 0; i < 4; ++i)
      add_triangle(roof, corners[i], corners[(i + 1) % 4], Vector3d(400, 400, 250), n);
    const std::vector<TriangleMesh> faces = smooth_faces(TriangleMesh(roof), kLimits);
    ASSERT_EQ(faces.size(), 4U) << n;
    for (const TriangleMesh& face : faces)
      EXPECT_EQ(face.triangles().size(), static_cast<std::size_t>(n * n));
  }
}

// Four sectors of a square vault over 2 `half`, whose mesh has the diagonals as edges; the height is that of
// an arch over the smaller (groin) or the larger (cloister) distance from the middle lines.
TriangleMesh vault(bool groin, int n, double half, double radius) {
  TriangleSoup soup;
  const auto arch = [&](double at) { return std::sqrt(radius * radius - at * at); };
  const auto number = [&](int i, int j, int quarter) {
    const double x = half * i / n, y = i > 0 ? x * (2.0 * j / i - 1) : 0,
                 turn = quarter * std::numbers::pi / 2;
    const Vector3d p(std::cos(turn) * x - std::sin(turn) * y, std::sin(turn) * x + std::cos(turn) * y,
                     arch(groin ? y : x));
    const auto known = std::find_if(soup.vertices.begin(), soup.vertices.end(),
                                    [&](const Vector3d& q) { return (p - q).norm() < 1e-6; });
    const auto k = static_cast<int>(known - soup.vertices.begin());
    if (known == soup.vertices.end()) soup.vertices.push_back(p);
    return k;
  };
  for (int quarter = 0; quarter < 4; ++quarter) {
    for (int i = 1; i <= n; ++i) {
      for (int j = 0; j < i; ++j) {
        soup.triangles.push_back(
            {number(i - 1, std::min(j, i - 1), quarter), number(i, j, quarter), number(i, j + 1, quarter)});
        if (j < i - 1)
          soup.triangles.push_back(
              {number(i - 1, j, quarter), number(i, j + 1, quarter), number(i - 1, j + 1, quarter)});
      }
    }
  }
  return TriangleMesh(std::move(soup));
}

TEST(Creases, ThatFadeTowardsACrownMeetThere) {
  for (const bool groin : {true, false}) {
    for (const int n : {8, 24}) {
      const TriangleMesh mesh = vault(groin, n, 500, 600);
      const std::vector<TriangleMesh> faces = smooth_faces(mesh, kLimits);
      ASSERT_EQ(faces.size(), 4U) << groin << " " << n;
      for (const TriangleMesh& face : faces)
        EXPECT_EQ(face.triangles().size(), mesh.triangles().size() / 4) << groin << " " << n;
    }
  }
}

// Four hypars that rise from the middle to a level border, so that their folds fade towards it, as those of
// an umbrella do. The folds are sharp over a third of their length.
TEST(Creases, ThatFadeTowardsABorderReachIt) {
  for (const int n : {12, 40}) {
    const TriangleMesh mesh(sheet(2 * n, 2 * n, [](double u, double v) {
      const double x = std::abs(2 * u - 1), y = std::abs(2 * v - 1);
      return Vector3d(2400 * u, 2400 * v, 400 * (x + y - x * y));
    }));
    const std::vector<TriangleMesh> faces = smooth_faces(mesh, kLimits);
    ASSERT_EQ(faces.size(), 4U) << n;
    for (const TriangleMesh& face : faces)
      EXPECT_EQ(face.triangles().size(), mesh.triangles().size() / 4) << n;
  }
}

// A hull of points nearly in line has long thin triangles, which noise or a bend tilts as it likes.
TEST(Creases, SliversAtAHullAreOfNoFace) {
  const auto with_slivers = [](double high_mm, double drop_mm) {
    TriangleSoup soup =
        sheet(10, 10, [](double u, double v) { return Vector3d(600 * u, 400 * v, 20 * u * u); });
    // Beside the border at v = 1 a point that hangs, and one beside that.
    const int a = 10, b = 21, c = 32;
    soup.vertices.push_back(soup.vertices[b] + Vector3d(5, high_mm, -drop_mm));
    soup.vertices.push_back(soup.vertices[b] + Vector3d(5, high_mm + 0.3, -drop_mm));
    const int p = static_cast<int>(soup.vertices.size()) - 2;
    soup.triangles.push_back({a, b, p});
    soup.triangles.push_back({b, c, p});
    soup.triangles.push_back({a, p, p + 1});
    soup.triangles.push_back({p, c, p + 1});
    return TriangleMesh(soup);
  };
  const TriangleMesh thin = with_slivers(0.05, 0.4);
  std::vector<int> face_of;
  const std::vector<TriangleMesh> faces = smooth_faces(thin, kLimits, &face_of);
  ASSERT_EQ(faces.size(), 1U);
  EXPECT_EQ(faces[0].triangles().size(), 200U);
  ASSERT_EQ(face_of.size(), 204U);
  EXPECT_EQ(std::count(face_of.begin(), face_of.begin() + 200, 0), 200);
  EXPECT_EQ(std::count(face_of.begin() + 200, face_of.end(), -1), 4);
  // What hangs down by more than the tolerance is design, but for what stands out from that by less, and
  // smooth slivers are of the face.
  EXPECT_EQ(std::count_if(faces[0].vertices().begin(), faces[0].vertices().end(),
                          [](const Vector3d& v) { return v.y() > 400 + 1e-9; }),
            0);
  const auto triangles_of_faces = [](const TriangleMesh& mesh) {
    std::size_t all = 0;
    for (const TriangleMesh& face : smooth_faces(mesh, kLimits)) all += face.triangles().size();
    return all;
  };
  EXPECT_EQ(triangles_of_faces(with_slivers(0.05, 40)), 202U);
  EXPECT_EQ(triangles_of_faces(with_slivers(0.4, 0.02)), 204U);
}

// A slit that ends inside the surface parts nothing, but where folds meet in which it ends.
TEST(Creases, ThatEndInsidePartNothing) {
  const auto dart = [](const std::function<double(double)>& rise) {
    return TriangleMesh(sheet(60, 20, [&](double u, double v) {
      return Vector3d(600 * u, 400 * v, 300 * rise(std::max(0.0, v - 0.5)) * std::abs(u - 0.5));
    }));
  };
  const TriangleMesh smooth = dart([](double v) { return 2 * v * v; });
  EXPECT_FALSE(creases(smooth, {0.5, 110}).empty());
  EXPECT_EQ(smooth_faces(smooth, {0.5, 110}).size(), 1U);
  EXPECT_EQ(smooth_faces(dart([](double v) { return v; }), {0.5, 110}).size(), 3U);
}

TEST(Creases, DoNotDependOnWhereTheMeshLiesOrHowItIsNumbered) {
  TriangleSoup soup = folded(0.7, 30, 0.4);
  std::reverse(soup.triangles.begin(), soup.triangles.end());
  const Eigen::Quaterniond turn = Eigen::Quaterniond(0.3, 0.5, -0.2, 0.9).normalized();
  for (Vector3d& p : soup.vertices) p = turn * p + Vector3d(1e6, -3e5, 20);
  EXPECT_EQ(smooth_faces(TriangleMesh(soup), kLimits).size(), 2U);
}

TEST(Creases, RefuseLimitsThatAreNone) {
  const TriangleMesh mesh(folded(0.5, 2));
  EXPECT_THROW((void)creases(mesh, {0, 100}), std::logic_error);
  EXPECT_THROW((void)creases(mesh, {1, -1}), std::logic_error);
}

}  // namespace
}  // namespace hotblade::surface

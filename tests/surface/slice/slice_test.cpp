#include "surface/slice/slice.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "surface/slice/event_planes.hpp"
#include "tests/surface/meshes.hpp"

namespace hotblade::surface {
namespace {

using Eigen::Vector3d;
using ::testing::AllOf;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

Vector3d plate(double s, double t) {
  return {200 * s, 100 * t, 0};
}

SliceOptions along(const Vector3d& normal, double spacing = 20, double inset = 0.05) {
  SliceOptions options;
  options.normal = normal;
  options.spacing_mm = spacing;
  options.end_inset_mm = inset;
  return options;
}

const SectionPiece& rib(const RibGraph& graph, const RibRef& ref) {
  return graph.sections[static_cast<std::size_t>(ref.section)].pieces[static_cast<std::size_t>(ref.piece)];
}

template <class F>
void for_each_point(const RibGraph& graph, const F& f) {
  for (const Section& section : graph.sections) {
    for (const SectionPiece& piece : section.pieces) {
      for (const SectionPoint& q : piece.points) f(section, q);
    }
  }
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

std::vector<std::size_t> chain_sizes(const RibGraph& graph) {
  std::vector<std::size_t> sizes;
  for (const Chain& c : graph.chains) sizes.push_back(c.ribs.size());
  std::sort(sizes.begin(), sizes.end());
  return sizes;
}

// Along the normal, from the design frame's origin.
double height(const RibGraph& graph, const Section& section) {
  return section.offset_mm + graph.planes.normal(0).dot(graph.planes.centre());
}

// Every piece in one chain; a chain's ribs in consecutive sections, of one sense, the first from the side `u`
// grows.
void expect_sound_chains(const RibGraph& graph) {
  std::vector<std::vector<int>> uses;
  for (const Section& s : graph.sections) uses.emplace_back(s.pieces.size(), 0);
  for (const Chain& chain : graph.chains) {
    ASSERT_FALSE(chain.ribs.empty());
    for (std::size_t i = 0; i < chain.ribs.size(); ++i) {
      ++uses[static_cast<std::size_t>(chain.ribs[i].section)][static_cast<std::size_t>(chain.ribs[i].piece)];
      if (i == 0) continue;
      EXPECT_EQ(chain.ribs[i].section, chain.ribs[i - 1].section + 1);
      const auto &a = rib(graph, chain.ribs[i - 1]).points, &b = rib(graph, chain.ribs[i]).points;
      EXPECT_LE((a.front().p - b.front().p).norm() + (a.back().p - b.back().p).norm(),
                (a.front().p - b.back().p).norm() + (a.back().p - b.front().p).norm());
    }
  }
  for (const auto& section : uses) EXPECT_THAT(section, Each(1));
}

TEST(Slice, SpreadsThePlanesEvenlyFromInsetToInset) {
  const DesignSurface d = from_mesh(grid(7, 3, plate));
  const RibGraph g = slice(d, along(Vector3d::UnitX() * 3, 30, 0.5));
  ASSERT_THAT(g.sections, SizeIs(8));  // ceil(199 / 30) + 1
  EXPECT_EQ(g.planes.normal(0), Vector3d::UnitX());
  for (std::size_t k = 0; k < 8; ++k) {
    EXPECT_NEAR(height(g, g.sections[k]), 0.5 + 199.0 * static_cast<double>(k) / 7, 1e-12);
  }
  EXPECT_THAT(slice(d, along(Vector3d::UnitX(), 1e6)).sections, SizeIs(2));
}

TEST(Slice, MeasuresFromTheDesignsMiddleWhereverItLies) {
  const TriangleSoup mesh = dome(400, 150, 30);
  const Vector3d normal(3, 1, -0.4), by(1e6, -3e6, 2e6);
  TriangleSoup far = mesh;
  for (Vector3d& p : far.vertices) p += by;
  const RibGraph a = slice(from_mesh(mesh), along(normal)), b = slice(from_mesh(far), along(normal));
  // Coordinates of up to 4e6 mm are multiples of 2^-31 mm: a vertex is off by half of that, the middle by
  // twice as much (the box's corners and its own rounding), an offset by the square root of 3 times both
  // together.
  const double rounding = 6 * std::ldexp(1, -32);
  EXPECT_LE((b.planes.centre() - a.planes.centre() - by).cwiseAbs().maxCoeff(), rounding);
  ASSERT_EQ(a.sections.size(), b.sections.size());
  for (std::size_t k = 0; k < a.sections.size(); ++k)
    EXPECT_NEAR(a.sections[k].offset_mm, b.sections[k].offset_mm, rounding);
}

TEST(Slice, TakesWholeSectionsWhereABorderRunsNearlyAlongThePlanes) {
  // Borders that wave by 0.3 mm along the sweep; the first plane, 0.05 mm inside, meets a part of them only.
  const auto wavy = [](double s, double t) {
    const double x = 200 * s + 0.15 * (1 - 2 * s) * std::sin(9 * t);
    return Vector3d(x, 100 * t, 30 * std::sin(x / 100 + t));
  };
  const RibGraph g = slice(from_mesh(grid(60, 90, wavy)), along(Vector3d::UnitX()));
  ASSERT_THAT(g.chains, SizeIs(1));
  ASSERT_THAT(g.chains[0].ribs, SizeIs(g.sections.size()));
  EXPECT_NEAR(height(g, g.sections.front()), -0.15 + 0.05, 1e-3);
  EXPECT_NEAR(height(g, g.sections.back()), 200.15 - 0.05, 1e-3);
  for (const std::size_t end : {std::size_t{0}, g.sections.size() - 1}) {
    const SectionPiece& is = rib(g, g.chains[0].ribs[end]);
    const double x = height(g, g.sections[end]);
    EXPECT_LT(is.points.front().p.y(), 0.5);
    EXPECT_GT(is.points.back().p.y(), 99.5);
    double length = 0;
    for (std::size_t i = 0; i < is.points.size(); ++i) {
      const Vector3d& p = is.points[i].p;
      EXPECT_NEAR(p.x(), x, 1e-9);
      // On the surface, gone on beyond its border by 0.3 mm at most: its curvature over that is nothing,
      // chords of 3.4 mm are 0.002 mm high, and a border's normals are known to first order.
      EXPECT_NEAR(p.z(), 30 * std::sin(x / 100 + p.y() / 100), 0.01);
      if (i > 0) length += (p - is.points[i - 1].p).norm();
    }
    EXPECT_NEAR(is.length_mm, length, 1e-9);
  }
}

TEST(Slice, CutsAPlateIntoStraightEqualRibs) {
  const RibGraph g = slice(from_mesh(grid(13, 7, plate)), along(Vector3d::UnitX()));
  ASSERT_THAT(g.chains, SizeIs(1));
  EXPECT_THAT(g.chains[0].ribs, SizeIs(g.sections.size()));
  for (const RibRef& ref : g.chains[0].ribs) {
    EXPECT_NEAR(rib(g, ref).length_mm, 100, 1e-10);
    EXPECT_FALSE(rib(g, ref).closed);
    EXPECT_EQ(rib(g, ref).points.front().p.y(), 0);  // cross(z, x) = y: the smaller end first
    EXPECT_EQ(rib(g, ref).points.back().p.y(), 100);
  }
  for_each_point(g, [](const Section&, const SectionPoint& q) { EXPECT_EQ(q.normal, Vector3d::UnitZ()); });
  expect_sound_chains(g);
}

TEST(Slice, RunsTheSameWayWhicheverSideIsTheFront) {
  TriangleSoup mesh = grid(13, 7, plate);
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  const RibGraph g = slice(from_mesh(mesh), along(Vector3d::UnitX()));
  for_each_point(g, [](const Section&, const SectionPoint& q) { EXPECT_EQ(q.normal, -Vector3d::UnitZ()); });
  EXPECT_EQ(rib(g, g.chains[0].ribs[0]).points.front().p.y(), 0);
}

TEST(Slice, CutsExactlyThroughVertices) {
  // Planes at x = 20, 40, ... 180, each through a row of vertices.
  const RibGraph g = slice(from_mesh(grid(10, 5, plate)), along(Vector3d::UnitX(), 20, 20));
  ASSERT_THAT(g.sections, SizeIs(9));
  for (const Section& section : g.sections) {
    ASSERT_THAT(section.pieces, SizeIs(1));
    const auto& points = section.pieces[0].points;
    ASSERT_THAT(points, SizeIs(6));
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_EQ(points[i].p, Vector3d(height(g, section), 20.0 * static_cast<double>(i), 0));
    }
  }
  EXPECT_THAT(chain_sizes(g), ::testing::ElementsAre(9U));
}

TEST(Slice, CutsDiagonallyThroughVertices) {
  const auto square = [](double s, double t) { return Vector3d(80 * s, 80 * t, 0); };
  const RibGraph g = slice(from_mesh(grid(8, 8, square)), along(Vector3d(1, 1, 0), 5, std::sqrt(2.0) * 5));
  for (const Section& section : g.sections) {
    ASSERT_THAT(section.pieces, SizeIs(1));
    const double from_corner = std::min(height(g, section), 80 * std::sqrt(2.0) - height(g, section));
    EXPECT_NEAR(section.pieces[0].length_mm, 2 * from_corner, 1e-10);
  }
  expect_sound_chains(g);
}

TEST(Slice, PutsPointsOnThePlaneAndOnTheMesh) {
  const TriangleSoup mesh = dome(400, 150, 9);
  const Vector3d normal = Vector3d(3, 1, -0.4).normalized();
  const RibGraph g = slice(from_mesh(mesh), along(normal));
  for_each_point(g, [&](const Section& section, const SectionPoint& q) {
    EXPECT_NEAR(normal.dot(q.p), height(g, section), 1e-11);
    EXPECT_LT(distance_to_edges(mesh, q.p), 1e-11);
    EXPECT_NEAR(q.normal.norm(), 1, 1e-14);
  });
}

TEST(Slice, EndsOpenPiecesOnTheBorder) {
  const RibGraph g = slice(from_mesh(dome(400, 150, 9)), along(Vector3d(3, 1, -0.4)));
  for (const Section& section : g.sections) {
    for (const SectionPiece& piece : section.pieces) {
      for (const Vector3d& end : {piece.points.front().p, piece.points.back().p}) {
        EXPECT_NEAR(end.head<2>().cwiseAbs().maxCoeff(), 150, 1e-10);
      }
    }
  }
}

// Border fans see one side of the surface only, so normals are judged away from the border.
double worst_normal(const TriangleSoup& mesh, double inner,
                    const std::function<Vector3d(const Vector3d&)>& exact) {
  double worst = 0;
  for_each_point(slice(from_mesh(mesh), along(Vector3d::UnitX())),
                 [&](const Section&, const SectionPoint& q) {
                   if (q.p.head<2>().cwiseAbs().maxCoeff() < inner)
                     worst = std::max(worst, (q.normal - exact(q.p)).norm());
                 });
  return worst;
}

TEST(Slice, NormalsAreExactOnASphere) {
  EXPECT_LT(worst_normal(dome(400, 150, 20), 130, [](const Vector3d& p) { return p.normalized(); }), 1e-12);
}

TEST(Slice, NormalsConvergeWithTheSquareOfTheMeshSize) {
  const auto worst = [](int cells) {
    const auto wave = [](double s, double t) {
      const double x = 300 * s - 150, y = 300 * t - 150;
      return Vector3d(x, y, 30 * std::sin(x / 60) * std::cos(y / 80));
    };
    return worst_normal(grid(cells, cells, wave), 130, [](const Vector3d& p) {
      const double dx = 0.5 * std::cos(p.x() / 60) * std::cos(p.y() / 80);
      const double dy = -0.375 * std::sin(p.x() / 60) * std::sin(p.y() / 80);
      return Vector3d(-dx, -dy, 1).normalized();
    });
  };
  const double coarse = worst(30), fine = worst(120);
  EXPECT_LT(coarse, 1e-2);
  EXPECT_LT(fine, coarse / 10);
}

TEST(Slice, LengthsOnADomeAreThoseOfCircularArcs) {
  const RibGraph g = slice(from_mesh(dome(400, 150, 300)), along(Vector3d::UnitX(), 50));
  for (const Section& section : g.sections) {
    const double r = std::sqrt(400 * 400 - height(g, section) * height(g, section));
    EXPECT_NEAR(section.pieces.at(0).length_mm, 2 * r * std::asin(150 / r), 1e-3);
  }
}

TEST(Slice, CutsTheLoopsOfATubeOpenOnOneSide) {
  const RibGraph g = slice(from_mesh(tube(100, 200, 48, 10)), along(Vector3d::UnitZ()));
  EXPECT_THAT(chain_sizes(g), ::testing::ElementsAre(g.sections.size(), g.sections.size()));
  expect_sound_chains(g);
  const double around = 48 * 200 * std::sin(std::numbers::pi / 48);
  for (const Section& section : g.sections) {
    ASSERT_THAT(section.pieces, SizeIs(2));
    const auto &a = section.pieces[0], &b = section.pieces[1];
    EXPECT_FALSE(a.closed || b.closed);
    EXPECT_NEAR(a.length_mm + b.length_mm, around, 1e-9);
    EXPECT_NEAR(a.length_mm, around / 2, 1e-9);
    EXPECT_EQ(a.points.front().p, b.points.front().p);  // both from the smaller x
    EXPECT_EQ(a.points.back().p, b.points.back().p);
    EXPECT_NEAR(a.points.front().p.x(), -100, 1e-9);
    EXPECT_NEAR(a.points.back().p.x(), 100, 1e-9);
    EXPECT_LT(a.points[12].p.y() * b.points[12].p.y(), 0);
  }
  for_each_point(g, [](const Section&, const SectionPoint& q) {
    EXPECT_NEAR(q.normal.dot(Vector3d(q.p.x(), q.p.y(), 0).normalized()), 1, 1e-2);
  });
}

TEST(Slice, CutsTheLoopsOfAnOvalTubeAtItsLongEnds) {
  TriangleSoup mesh = tube(100, 200, 72, 10);
  const Vector3d longest(std::cos(0.6), std::sin(0.6), 0);
  for (Vector3d& p : mesh.vertices) p += 1.5 * longest.dot(p) * longest;
  const RibGraph g = slice(from_mesh(mesh), along(Vector3d::UnitZ()));
  for (const Section& section : g.sections) {
    ASSERT_THAT(section.pieces, SizeIs(2));
    for (const SectionPiece& piece : section.pieces) {
      EXPECT_NEAR(std::abs(longest.dot(piece.points.front().p)), 250, 2);
      EXPECT_NEAR(std::abs(longest.dot(piece.points.back().p)), 250, 2);
    }
  }
  EXPECT_THAT(g.chains, SizeIs(2));
}

TEST(Slice, FollowsTheContoursOfABump) {
  const auto bump = [](double s, double t) {
    const double x = 400 * s - 200, y = 400 * t - 200;
    return Vector3d(x, y, 150 * std::exp(-(x * x + y * y) / 8000));
  };
  const RibGraph g = slice(from_mesh(grid(160, 160, bump)), along(Vector3d::UnitZ(), 10, 5));
  EXPECT_THAT(chain_sizes(g), ::testing::ElementsAre(g.sections.size(), g.sections.size()));
  for (const Section& section : g.sections) {
    const double r = std::sqrt(-8000 * std::log(height(g, section) / 150));
    // Chords of at most 3.6 mm miss the surface by up to 0.06 mm in height where it is steepest bent (1/27
    // mm), that is 0.1 mm in radius at the slope of 0.58 there.
    EXPECT_NEAR(section.pieces.at(0).length_mm + section.pieces.at(1).length_mm, 2 * std::numbers::pi * r,
                0.65);
  }
}

TEST(Slice, EndsChainsWhereAWindowOpensAndCloses) {
  // 20 x 20 cells of 10 mm with a window of 6 x 6 cells in the middle.
  const auto flat = [](double s, double t) { return Vector3d(200 * s, 200 * t, 0); };
  const auto frame = [](int i, int j) { return i < 7 || i > 12 || j < 7 || j > 12; };
  const RibGraph g = slice(from_mesh(grid(20, 20, flat, frame)), along(Vector3d::UnitX(), 10, 5));
  // Sections at 5, 15, ..., 195: 7 before, 6 beside the window on two sides, 7 after.
  ASSERT_THAT(g.sections, SizeIs(20));
  EXPECT_THAT(chain_sizes(g), ::testing::ElementsAre(6U, 6U, 7U, 7U));
  expect_sound_chains(g);
  EXPECT_LT(rib(g, g.chains[1].ribs[0]).points[0].p.y(), rib(g, g.chains[2].ribs[0]).points[0].p.y());
  for (const RibRef& ref : g.chains[1].ribs) EXPECT_NEAR(rib(g, ref).length_mm, 70, 1e-10);
}

TEST(Slice, ReachesUpToTheEdgesOfAWindow) {
  const auto flat = [](double s, double t) { return Vector3d(200 * s, 200 * t, 0); };
  const auto frame = [](int i, int j) { return i < 7 || i > 12 || j < 7 || j > 12; };
  const RibGraph g = slice(from_mesh(grid(20, 20, flat, frame)), along(Vector3d::UnitX(), 20));
  expect_sound_chains(g);
  ASSERT_THAT(g.chains, SizeIs(4));
  const auto reach = [&](const Chain& c) {
    return std::pair(height(g, g.sections[static_cast<std::size_t>(c.ribs.front().section)]),
                     height(g, g.sections[static_cast<std::size_t>(c.ribs.back().section)]));
  };
  // The window is open from x = 70 to 130; the planes next to its edges lie 0.05 mm off.
  const std::pair<double, double> expected[] = {
      {0.05, 69.95}, {70.05, 129.95}, {70.05, 129.95}, {130.05, 199.95}};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(reach(g.chains[i]).first, expected[i].first, 1e-9) << i;
    EXPECT_NEAR(reach(g.chains[i]).second, expected[i].second, 1e-9) << i;
  }
}

TEST(CriticalHeights, OfAPlateWithAWindowAreItsEdges) {
  const auto flat = [](double s, double t) { return Vector3d(200 * s, 200 * t, 0); };
  const auto frame = [](int i, int j) { return i < 7 || i > 12 || j < 7 || j > 12; };
  EXPECT_THAT(
      critical_heights(TriangleMesh(grid(20, 20, flat, frame)), PlaneFamily::parallel(Vector3d::UnitX())),
      ::testing::ElementsAre(0, 70, 130, 200));
}

TEST(CriticalHeights, OfATorusAreFour) {
  // Upright: a minimum, two saddles, a maximum (Euler characteristic 0).
  constexpr int kAround = 40, kTube = 24;
  TriangleSoup torus;
  for (int i = 0; i < kAround; ++i) {
    for (int j = 0; j < kTube; ++j) {
      const double a = 2 * std::numbers::pi * (i + 0.3) / kAround,
                   b = 2 * std::numbers::pi * (j + 0.2) / kTube;
      const double r = 200 + 60 * std::cos(b);
      torus.vertices.emplace_back(r * std::cos(a), 60 * std::sin(b), r * std::sin(a));
      const auto at = [&](int k, int l) { return k % kAround * kTube + l % kTube; };
      torus.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      torus.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  const std::vector<double> heights =
      critical_heights(TriangleMesh(torus), PlaneFamily::parallel(Vector3d::UnitZ()));
  ASSERT_THAT(heights, SizeIs(4));
  const double expected[] = {-260, -140, 140, 260};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(heights[i], expected[i], 3);
}

TEST(Slice, GoesOnPastASliver) {
  // A slot near one end leaves pieces of 184 and 8 mm out of 200.
  const auto flat = [](double s, double t) { return Vector3d(200 * s, 200 * t, 0); };
  const auto slotted = [](int i, int j) { return j != 23 || i < 10 || i > 14; };
  const RibGraph g = slice(from_mesh(grid(25, 25, flat, slotted)), along(Vector3d::UnitX(), 8, 4));
  EXPECT_THAT(chain_sizes(g), ::testing::ElementsAre(5U, 25U));
}

TEST(Slice, KeepsToItsSheetWhereAnotherIsClose) {
  // Two sheets 1 mm apart, sloping, so that straight across to the other sheet is as near as along one's own.
  TriangleSoup mesh = grid(10, 5, [](double s, double t) { return Vector3d(200 * s, 100 * t, 10 * s); });
  const int count = static_cast<int>(mesh.vertices.size());
  const auto triangles = mesh.triangles;
  for (int v = 0; v < count; ++v)
    mesh.vertices.push_back(mesh.vertices[static_cast<std::size_t>(v)] + Vector3d(0, 0, 1));
  for (const auto& t : triangles) mesh.triangles.push_back({t[0] + count, t[1] + count, t[2] + count});
  const RibGraph g = slice(from_mesh(mesh), along(Vector3d::UnitX()));
  ASSERT_THAT(g.chains, SizeIs(2));
  for (const Chain& chain : g.chains) {
    const Vector3d& first = rib(g, chain.ribs.front()).points[0].p;
    const double height = first.z() - first.x() / 20;
    for (const RibRef& ref : chain.ribs) {
      const Vector3d& p = rib(g, ref).points[0].p;
      EXPECT_NEAR(p.z() - p.x() / 20, height, 1e-9);
    }
  }
}

TEST(Slice, LinksPatchesAcrossASeam) {
  TriangleSoup mesh = grid(10, 5, plate);
  const int count = static_cast<int>(mesh.vertices.size());
  const auto triangles = mesh.triangles;
  for (int v = 0; v < count; ++v) {
    mesh.vertices.push_back(mesh.vertices[static_cast<std::size_t>(v)] + Vector3d(200.001, 0, 0));
  }
  for (const auto& t : triangles) mesh.triangles.push_back({t[0] + count, t[1] + count, t[2] + count});
  const RibGraph g = slice(from_mesh(mesh), along(Vector3d::UnitX(), 18));
  EXPECT_THAT(chain_sizes(g), ::testing::ElementsAre(g.sections.size()));
}

TEST(Slice, DoesNotLinkSheetsThatLookApart) {
  // The second plate begins where the first ends, but its front looks down.
  TriangleSoup mesh = grid(10, 5, plate);
  const int count = static_cast<int>(mesh.vertices.size());
  const auto triangles = mesh.triangles;
  for (int v = 0; v < count; ++v) {
    mesh.vertices.push_back(mesh.vertices[static_cast<std::size_t>(v)] + Vector3d(200.001, 0, 5));
  }
  for (const auto& t : triangles) mesh.triangles.push_back({t[1] + count, t[0] + count, t[2] + count});
  EXPECT_THAT(slice(from_mesh(mesh), along(Vector3d::UnitX(), 18)).chains, SizeIs(2));
}

TEST(Slice, DropsShortPiecesAndSaysWhere) {
  TriangleSoup triangle;
  triangle.vertices = {{0, 0, 0}, {100, -50, 0}, {100, 50, 0}};
  triangle.triangles = {{0, 1, 2}};
  SliceOptions options = along(Vector3d::UnitX(), 10, 2);
  options.min_piece_mm = 15;
  const RibGraph g = slice(from_mesh(triangle), options);
  EXPECT_THAT(g.warnings,
              ::testing::ElementsAre(
                  AllOf(HasSubstr("section 0 (normal . p = 2.000 mm)"), HasSubstr("too short (2.000 mm"),
                        HasSubstr("limit 15.000 mm"), HasSubstr("near (2.000, ")),
                  HasSubstr("section 1")));
  EXPECT_THAT(g.sections[0].pieces, IsEmpty());
  EXPECT_THAT(g.sections[2].pieces, SizeIs(1));
  EXPECT_EQ(g.chains.at(0).ribs.at(0).section, 2);
}

TEST(Slice, KeepsTheTipsOfTheDesignAndOfItsArmsWhereAskedTo) {
  // Two triangles on a strip, with tips at x = 100 and at x = 75.
  TriangleSoup comb;
  comb.vertices = {{0, 0, 0}, {0, 40, 0}, {0, 80, 0}, {100, 20, 0}, {75, 60, 0}, {-50, 0, 0}, {-50, 80, 0}};
  comb.triangles = {{0, 3, 1}, {1, 4, 2}, {5, 0, 1}, {5, 1, 6}, {6, 1, 2}};
  SliceOptions options = along(Vector3d::UnitX(), 20, 0.05);
  const auto last_of_arms = [&] {
    const RibGraph g = slice(from_mesh(comb), options);
    std::vector<double> last;
    for (const Chain& chain : g.chains) {
      const double at = g.sections[static_cast<std::size_t>(chain.ribs.back().section)].offset_mm + 25;
      if (at > 1) last.push_back(at);
    }
    std::sort(last.begin(), last.end());
    return last;
  };
  EXPECT_THAT(last_of_arms(), ::testing::ElementsAre(::testing::Lt(74), ::testing::Lt(99)));
  options.keep_tips = true;
  EXPECT_THAT(last_of_arms(),
              ::testing::ElementsAre(::testing::DoubleNear(74.95, 1e-9), ::testing::DoubleNear(99.95, 1e-9)));
}

TEST(Slice, FindsNoSectionsInADirectionWithoutExtent) {
  const RibGraph g = slice(from_mesh(grid(4, 4, plate)), along(Vector3d::UnitZ()));
  EXPECT_THAT(g.sections, IsEmpty());
  EXPECT_THAT(g.warnings, ::testing::ElementsAre(HasSubstr("no extent")));
}

TEST(Slice, RefusesUnusableOptionsAndBlockedDesigns) {
  const DesignSurface d = from_mesh(grid(4, 4, plate));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [&](const DesignSurface& design, const SliceOptions& o) {
    return !message_of<std::logic_error>([&] {
              static_cast<void>(slice(design, o));
            }).starts_with("(nothing");
  };
  EXPECT_FALSE(refused(d, along(Vector3d::UnitX())));
  EXPECT_TRUE(refused(d, along(Vector3d::Zero())));
  EXPECT_TRUE(refused(d, along(Vector3d(1, nan, 0))));
  for (const double spacing : {0.0, -1.0, nan, 1e-4})
    EXPECT_TRUE(refused(d, along(Vector3d::UnitX(), spacing)));
  for (const double inset : {-1.0, nan}) EXPECT_TRUE(refused(d, along(Vector3d::UnitX(), 20, inset)));
  SliceOptions short_pieces;
  short_pieces.min_piece_mm = nan;
  EXPECT_TRUE(refused(d, short_pieces));
  DesignSurface blocked = d;
  blocked.health.blockers.push_back("one side only");
  EXPECT_TRUE(refused(blocked, along(Vector3d::UnitX())));
  EXPECT_TRUE(refused(DesignSurface{}, along(Vector3d::UnitX())));
}

TEST(Slice, IsTheSameForATurnedDesign) {
  const auto wave = [](double s, double t) {
    return Vector3d(300 * s, 200 * t, 30 * std::sin(5 * s + 2 * t) + 10 * std::cos(9 * t));
  };
  const auto frame = [](int i, int j) { return i < 10 || i > 16 || j < 5 || j > 9; };
  const TriangleSoup mesh = grid(30, 20, wave, frame);
  std::mt19937 random(3);
  std::normal_distribution<double> any;
  const RibGraph straight = slice(from_mesh(mesh), along(Vector3d(1, 0.2, 0.1)));
  for (int round = 0; round < 20; ++round) {
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond(any(random), any(random), any(random), any(random)).normalized();
    TriangleSoup turned = mesh;
    for (Vector3d& p : turned.vertices) p = turn * p;
    const RibGraph g = slice(from_mesh(turned), along(turn * Vector3d(1, 0.2, 0.1)));
    ASSERT_EQ(g.sections.size(), straight.sections.size());
    EXPECT_EQ(chain_sizes(g), chain_sizes(straight));
    for (std::size_t k = 0; k < g.sections.size(); ++k) {
      const auto lengths = [&](const Section& s) {
        std::vector<double> all;
        for (const SectionPiece& piece : s.pieces) all.push_back(piece.length_mm);
        std::sort(all.begin(), all.end());
        return all;
      };
      EXPECT_THAT(lengths(g.sections[k]),
                  ::testing::Pointwise(::testing::DoubleNear(1e-8), lengths(straight.sections[k])));
    }
  }
}

TEST(Slice, DoesNotDependOnTheOrderOfFaces) {
  TriangleSoup mesh = tube(100, 200, 48, 10);
  for (Vector3d& p : mesh.vertices) p.x() += 0.3 * p.z() + 20 * std::sin(p.y() / 30);
  for (const Vector3d& normal : {Vector3d(0, 0, 1), Vector3d(1, 0, 0), Vector3d(1, 2, 3)}) {
    const RibGraph sorted = slice(from_mesh(mesh), along(normal));
    expect_sound_chains(sorted);
    TriangleSoup shuffled = mesh;
    std::mt19937 random(5);
    std::shuffle(shuffled.triangles.begin(), shuffled.triangles.end(), random);
    for (auto& t : shuffled.triangles) std::rotate(t.begin(), t.begin() + 1, t.end());
    const RibGraph g = slice(from_mesh(shuffled), along(normal));
    ASSERT_EQ(g.chains.size(), sorted.chains.size());
    for (std::size_t c = 0; c < g.chains.size(); ++c) {
      ASSERT_EQ(g.chains[c].ribs.size(), sorted.chains[c].ribs.size());
      for (std::size_t i = 0; i < g.chains[c].ribs.size(); ++i) {
        const RibRef &a = g.chains[c].ribs[i], &b = sorted.chains[c].ribs[i];
        EXPECT_EQ(a.section, b.section);
        EXPECT_EQ(a.piece, b.piece);
        const auto &p = rib(g, a).points, &q = rib(sorted, b).points;
        ASSERT_EQ(p.size(), q.size());
        for (std::size_t j = 0; j < p.size(); ++j) {
          EXPECT_EQ(p[j].p, q[j].p);
          EXPECT_LT((p[j].normal - q[j].normal).norm(), 1e-12);
        }
      }
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
    for (const Section& section : slice(from_mesh(mesh), along(normal, 15, 30)).sections) {
      for (const SectionPiece& piece : section.pieces) {
        ASSERT_GE(piece.points.size(), 2U);
        double length = 0;
        for (std::size_t i = 1; i < piece.points.size(); ++i) {
          const double step = (piece.points[i].p - piece.points[i - 1].p).norm();
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

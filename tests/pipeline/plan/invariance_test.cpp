// What must not change a plan: where the design lies, in which order and unit its file tells it, how its
// quadrilaterals are cut into triangles.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <random>

#include "pipeline/plan/plan.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

using Point = std::function<Eigen::Vector3d(double, double)>;

// A shallow hill beside a hollow: strips of ribs that change along the sweep. No choice between weights or
// splits hangs by rounding or by the mesh's errors here; at 45 mm one does.
Eigen::Vector3d hills(double u, double v) {
  const double x = 300 * u, y = 700 * v;
  return {x, y, 46 * std::sin(2 * std::numbers::pi * y / 620 + 0.4) * (1 + 0.2 * u) + 6 * u * u};
}

struct ObjMesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<int, 3>> faces;  // from 0
};

// `other` cuts every quadrilateral along its other diagonal.
ObjMesh grid_mesh(int nu, int nv, const Point& p, bool other) {
  ObjMesh mesh;
  for (int i = 0; i <= nu; ++i) {
    for (int j = 0; j <= nv; ++j)
      mesh.vertices.push_back(p(static_cast<double>(i) / nu, static_cast<double>(j) / nv));
  }
  for (int i = 0; i < nu; ++i) {
    for (int j = 0; j < nv; ++j) {
      const int a = i * (nv + 1) + j, b = a + nv + 1, c = b + 1, d = a + 1;
      if (other) {
        mesh.faces.insert(mesh.faces.end(), {{a, b, d}, {b, c, d}});
      } else {
        mesh.faces.insert(mesh.faces.end(), {{a, b, c}, {a, c, d}});
      }
    }
  }
  return mesh;
}

PlanResult plan_mesh(const ObjMesh& mesh, const std::string& units = "mm", double per_mm = 1) {
  const testing::TemporaryDirectory directory;
  const std::filesystem::path file = directory / "design.obj";
  {
    std::ofstream out(file);
    out.precision(17);
    for (const Eigen::Vector3d& v : mesh.vertices)
      out << "v " << v.x() * per_mm << " " << v.y() * per_mm << " " << v.z() * per_mm << "\n";
    for (const auto& f : mesh.faces) out << "f " << f[0] + 1 << " " << f[1] + 1 << " " << f[2] + 1 << "\n";
  }
  return plan(surface::read_obj(file, {units, 'z'}), along_x(), {});
}

ObjMesh mapped(ObjMesh mesh, const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& map) {
  for (Eigen::Vector3d& v : mesh.vertices) v = map(v);
  return mesh;
}

// Vertices, faces and each face's first corner in another order.
ObjMesh shuffled(const ObjMesh& mesh) {
  std::mt19937 random(7);
  std::vector<std::size_t> order(mesh.vertices.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), random);
  ObjMesh out;
  std::vector<int> place(order.size());
  for (const std::size_t v : order) {
    place[v] = static_cast<int>(out.vertices.size());
    out.vertices.push_back(mesh.vertices[v]);
  }
  for (const auto& f : mesh.faces) {
    std::array<int, 3> g;
    for (std::size_t i = 0; i < 3; ++i) g[i] = place[static_cast<std::size_t>(f[i])];
    std::rotate(g.begin(), g.begin() + static_cast<std::ptrdiff_t>(random() % 3), g.end());
    out.faces.push_back(g);
  }
  std::shuffle(out.faces.begin(), out.faces.end(), random);
  return out;
}

const ObjMesh& hill_mesh() {
  static const ObjMesh mesh = grid_mesh(24, 80, hills, false);
  return mesh;
}

const PlanResult& hill_plan() {
  static const PlanResult result = plan_mesh(hill_mesh());
  return result;
}

// The same strips, ribs and blades; shapes, deviations and times but for `mm`.
void expect_same(const PlanResult& is, const PlanResult& was, double mm) {
  EXPECT_EQ(is.program.verification.status, was.program.verification.status);
  ASSERT_EQ(is.strips.size(), was.strips.size());
  for (std::size_t i = 0; i < was.strips.size(); ++i) {
    EXPECT_EQ(is.strips[i].ribs, was.strips[i].ribs);
    EXPECT_EQ(is.strips[i].blade_length_mm, was.strips[i].blade_length_mm);
    EXPECT_NEAR(is.strips[i].worst_fit_mm, was.strips[i].worst_fit_mm, mm);
    EXPECT_NEAR(is.strips[i].deviation_max_mm, was.strips[i].deviation_max_mm, mm);
    EXPECT_NEAR(is.strips[i].motion.duration_s, was.strips[i].motion.duration_s,
                1e-2 * was.strips[i].motion.duration_s);
    ASSERT_EQ(is.program.strips[i].ribs.size(), was.program.strips[i].ribs.size());
    for (std::size_t r = 0; r < was.program.strips[i].ribs.size(); ++r) {
      const elastica::Elastica &e = is.program.strips[i].ribs[r].elastica,
                               &f = was.program.strips[i].ribs[r].elastica;
      EXPECT_NEAR(e.length, f.length, 2 * mm);
      const auto p = elastica::sample(e, 9), q = elastica::sample(f, 9);
      for (std::size_t k = 0; k < p.size(); ++k)
        EXPECT_LE((p[k].position() - q[k].position()).norm(), 2 * mm);
    }
  }
}

// A fit ends where it is within what is wanted, with one number of ribs or another: by as much two of them
// may differ that both do.
constexpr double kFitMm = 0.25;

// The same strips and blades; deviations but for `mm`.
void expect_same_strips(const PlanResult& is, const PlanResult& was, double mm) {
  EXPECT_EQ(is.program.verification.status, was.program.verification.status);
  ASSERT_EQ(is.strips.size(), was.strips.size());
  for (std::size_t i = 0; i < was.strips.size(); ++i) {
    EXPECT_EQ(is.strips[i].blade_length_mm, was.strips[i].blade_length_mm);
    EXPECT_NEAR(is.strips[i].deviation_max_mm, was.strips[i].deviation_max_mm, mm);
  }
}

// Fits take the same steps from the same data, so what is left is rounding, as the steps carry it on: 6e-11
// mm of the design's coordinates at 1e6 mm.
constexpr double kRoundingMm = 1e-5;

TEST(PlanInvariance, TheSampleIsCutInSeveralStrips) {
  EXPECT_EQ(hill_plan().program.verification.status, VerificationStatus::kPassed);
  EXPECT_GE(hill_plan().strips.size(), 2u);
}

TEST(PlanInvariance, MovingTheDesignByAKilometreChangesRoundingOnly) {
  const Eigen::Vector3d by(1e6, -1e6, 1e6);
  const PlanResult moved =
      plan_mesh(mapped(hill_mesh(), [&](const Eigen::Vector3d& p) -> Eigen::Vector3d { return p + by; }));
  expect_same(moved, hill_plan(), kRoundingMm);
}

TEST(PlanInvariance, TheOrderOfVerticesAndFacesChangesRoundingOnly) {
  expect_same(plan_mesh(shuffled(hill_mesh())), hill_plan(), kRoundingMm);
}

TEST(PlanInvariance, TheUnitOfTheFileChangesRoundingOnly) {
  expect_same(plan_mesh(hill_mesh(), "m", 1e-3), hill_plan(), kRoundingMm);
  expect_same(plan_mesh(hill_mesh(), "in", 1 / 25.4), hill_plan(), kRoundingMm);
}

TEST(PlanInvariance, OtherDiagonalsChangeNoStripAndDeviationsWithinTheMeshErrorOnly) {
  const PlanResult other = plan_mesh(grid_mesh(24, 80, hills, true));
  const double mesh_error = 0.1;  // of 12.5 x 8.75 mm cells on this surface, its chords and twist
  expect_same_strips(other, hill_plan(), mesh_error);
}

// Another mesh of the same surface: other numbers of cells, inner vertices moved about by up to a third of a
// cell, and a diagonal drawn by lot in each.
ObjMesh remeshed(int nu, int nv, const Point& p, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> off(-1.0 / 3, 1.0 / 3);
  ObjMesh mesh;
  for (int i = 0; i <= nu; ++i) {
    for (int j = 0; j <= nv; ++j) {
      const double du = i > 0 && i < nu ? off(random) : 0, dv = j > 0 && j < nv ? off(random) : 0;
      mesh.vertices.push_back(p((i + du) / nu, (j + dv) / nv));
    }
  }
  for (int i = 0; i < nu; ++i) {
    for (int j = 0; j < nv; ++j) {
      const int a = i * (nv + 1) + j, b = a + nv + 1, c = b + 1, d = a + 1;
      if (random() % 2 == 0) {
        mesh.faces.insert(mesh.faces.end(), {{a, b, d}, {b, c, d}});
      } else {
        mesh.faces.insert(mesh.faces.end(), {{a, b, c}, {a, c, d}});
      }
    }
  }
  return mesh;
}

// How far faces lie from the surface z(x, y) that `hills` is, along its normal, at their middles and those of
// their edges.
double mesh_error_mm(const ObjMesh& mesh) {
  const auto height = [](double x, double y) { return hills(x / 300, y / 700).z(); };
  double worst = 0;
  for (const auto& f : mesh.faces) {
    const auto at = [&](std::size_t k) { return mesh.vertices[static_cast<std::size_t>(f[k % 3])]; };
    for (std::size_t k = 0; k < 4; ++k) {
      const Eigen::Vector3d q =
          k < 3 ? Eigen::Vector3d(0.5 * (at(k) + at(k + 1))) : Eigen::Vector3d((at(0) + at(1) + at(2)) / 3);
      const double step = 1e-3, dx = (height(q.x() + step, q.y()) - height(q.x() - step, q.y())) / (2 * step),
                   dy = (height(q.x(), q.y() + step) - height(q.x(), q.y() - step)) / (2 * step);
      worst = std::max(worst, std::abs(q.z() - height(q.x(), q.y())) / std::sqrt(1 + dx * dx + dy * dy));
    }
  }
  return worst;
}

TEST(PlanInvariance, AnotherMeshChangesNoStripAndDeviationsWithinTheMeshErrorsOnly) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    const ObjMesh other = remeshed(21, 90, hills, seed);
    expect_same_strips(plan_mesh(other), hill_plan(),
                       mesh_error_mm(other) + mesh_error_mm(hill_mesh()) + kFitMm);
  }
}

}  // namespace
}  // namespace hotblade::pipeline

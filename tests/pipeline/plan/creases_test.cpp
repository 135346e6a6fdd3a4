// Designs with creases, as folded plates, hipped roofs and vaults side by side have them.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "pipeline/plan/face_plans.hpp"
#include "pipeline/plan/forecast.hpp"
#include "pipeline/plan/plan.hpp"
#include "pipeline/verify/budget.hpp"
#include "pipeline/verify/design_faces.hpp"
#include "pipeline/verify/verify.hpp"
#include "surface/slice/smooth_faces.hpp"
#include "tests/paths.hpp"
#include "tests/pipeline/plan_design.hpp"
#include "tests/pipeline/temporary_directory.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector3d;

Settings back() {
  Settings settings;
  settings.design.units = "mm";
  settings.design.keep = Keep::kBack;
  return settings;
}

// Two plates that rise from x = `at` of 600, by this slope.
surface::DesignSurface fold(double slope, double at = 0.5) {
  return grid_design("fold", 30, 10, [&](double u, double v) {
    return Vector3d(600 * u, 400 * v, slope * 600 * std::abs(u - at));
  });
}

// Four plates that fall by this slope from the two folds in which they meet, and which cross.
surface::DesignSurface crossed_folds(double edge, double slope) {
  return grid_design("crossed", 20, 20, [&](double u, double v) {
    return Vector3d(edge * u, edge * v, -slope * edge * (std::abs(u - 0.5) + std::abs(v - 0.5)));
  });
}

// A row of arcs, each with its crown in the middle.
surface::DesignSurface scallops(double bent) {
  return grid_design("scallops", 60, 20, [&](double u, double v) {
    return Vector3d(1000 * u + bent * std::sin(M_PI * v), 600 * v, 150 * std::abs(std::sin(2 * M_PI * u)));
  });
}

std::size_t faces_of(const surface::DesignSurface& design, const Settings& settings) {
  return surface::smooth_faces(design.mesh, crease_limits(settings, settings.blade)).size();
}

void expect_passes(const PlanResult& result, std::size_t strips, double most_mm) {
  for (const Refusal& r : result.refusals) ADD_FAILURE() << describe(r);
  EXPECT_EQ(result.program.verification.status, VerificationStatus::kPassed);
  EXPECT_LE(result.strips.size(), strips);
  EXPECT_LE(result.verification.deviation.max, most_mm);
  EXPECT_EQ(result.verification.uncut_mm2, 0);
  for (std::size_t i = 0; i < result.strips.size(); ++i) {
    const std::string& id = result.strips[i].id;
    EXPECT_EQ(id, "S" + std::string(i < 9 ? "00" : "0") + std::to_string(i + 1));
    EXPECT_EQ(result.program.strips[i].id, id);
    EXPECT_EQ(result.program.strips[i].ribs.front().id, id + "R001");
  }
}

TEST(PlanCreases, FoldedPlatesAreAStripEach) {
  for (const double slope : {0.3, 1.2}) {
    const PlanResult result = plan(fold(slope, 0.4), back(), {});
    expect_passes(result, 2, 0.01);
    EXPECT_EQ(result.decisions.back().way, SweepWay::kFaces);
    EXPECT_TRUE(result.decisions.back().taken);
    EXPECT_EQ(std::count_if(result.decisions.begin(), result.decisions.end(),
                            [](const Decision& d) { return d.taken; }),
              1);
    // What was tried is told of each face, and last of the whole.
    ASSERT_EQ(result.faces.size(), 2U);
    std::size_t strips = 0, decisions = 0, ranked = 0;
    for (const FacePlanned& face : result.faces) {
      EXPECT_EQ(face.strips.first, strips);
      EXPECT_EQ(face.decisions.first, decisions);
      EXPECT_EQ(face.ranking.first, ranked);
      EXPECT_GE(face.ranking.count, 1U);
      EXPECT_EQ(face.strips_lower_bound, 1U);
      strips += face.strips.count;
      decisions += face.decisions.count;
      ranked += face.ranking.count;
      EXPECT_TRUE(result.decisions[decisions - 1].passed);
    }
    EXPECT_EQ(strips, result.strips.size());
    EXPECT_EQ(decisions + 1, result.decisions.size());
    EXPECT_EQ(ranked, result.ranking.size());
    // The fold is no chord of a coarse mesh.
    EXPECT_LT(result.program.verification.budget_mm.front().second, 1e-9);
    EXPECT_TRUE(std::none_of(result.warnings.begin(), result.warnings.end(), [](const std::string& line) {
      return line.find("facets") != std::string::npos;
    }));
  }
}

// A blade rounds a fold of 14 degrees, but none is swept across two that cross.
TEST(PlanCreases, FoldsThatCrossPartADesignHoweverShallow) {
  const surface::DesignSurface design = crossed_folds(700, 0.12);
  ASSERT_EQ(faces_of(design, back()), 1U);
  const PlanResult result = plan(design, back(), {});
  expect_passes(result, 4, 0.01);
  EXPECT_EQ(result.faces.size(), 4U);
  EXPECT_EQ(result.decisions.back().way, SweepWay::kFaces);
  // The program says what counts as a crease, to those who measure it alone.
  EXPECT_EQ(result.program.settings.slice.shallow_folds, ShallowFolds::kParted);
  EXPECT_EQ(verify(result.program, design, {}).deviation.max, result.verification.deviation.max);
}

TEST(PlanCreases, AShallowFoldIsCrossedWhereThatTakesFewerStrips) {
  const surface::DesignSurface design = fold(0.0875);
  const PlanResult result = plan(design, back(), {});
  expect_passes(result, 1, 1);
  EXPECT_TRUE(result.faces.empty());
  EXPECT_EQ(result.program.settings.slice.shallow_folds, ShallowFolds::kCrossed);
  Settings parted = back();
  parted.slice.shallow_folds = ShallowFolds::kParted;
  const PlanResult apart = plan(design, parted, {});
  expect_passes(apart, 2, 0.01);
  EXPECT_EQ(apart.faces.size(), 2U);
}

// One strip comes within 0.1 mm of neither side, and two are no fewer than the faces.
TEST(PlanCreases, AShallowFoldIsPartedWhereCrossingTakesAsManyStrips) {
  Settings settings = back();
  settings.design.tolerance_mm = 0.3;
  const PlanResult result = plan(fold(0.0875), settings, {});
  expect_passes(result, 2, 0.01);
  EXPECT_EQ(result.program.settings.slice.shallow_folds, ShallowFolds::kParted);
  EXPECT_FALSE(result.decisions.front().way == SweepWay::kFaces);
  settings.slice.shallow_folds = ShallowFolds::kCrossed;
  EXPECT_TRUE(plan(fold(0.0875), settings, {}).faces.empty());
}

// Two plates of 300 by 400 mm that meet in a fold, with a chamfer of this width along it.
surface::DesignSurface chamfered(double fold_rad, double chamfer_mm) {
  constexpr int kAlong = 10, kPlate = 15;
  return grid_design("chamfered", 2 * kPlate + 1, kAlong, [&](double u, double v) {
    const auto i = std::lround(u * (2 * kPlate + 1));
    const double side = i <= kPlate ? -1 : 1;
    const double way_mm = 20.0 * static_cast<double>(i <= kPlate ? kPlate - i : i - kPlate - 1);
    return Vector3d(side * (0.5 * chamfer_mm + way_mm * std::cos(fold_rad / 2)), 400 * v,
                    -way_mm * std::sin(fold_rad / 2));
  });
}

// No blade forms a chamfer. Two strips meet in the corner that it stands for, and pass its middle by what it
// is off them.
TEST(PlanCreases, PlatesWithAChamferBetweenThemAreAStripEach) {
  const double fold_rad = 1.0, chamfer_mm = 2.5, off_mm = 0.5 * chamfer_mm * std::sin(fold_rad / 2);
  const surface::DesignSurface design = chamfered(fold_rad, chamfer_mm);
  const PlanResult result = plan(design, back(), {});
  expect_passes(result, 2, 1.001 * off_mm);
  EXPECT_GE(result.verification.deviation.max, 0.999 * off_mm);
  EXPECT_EQ(result.faces.size(), 2U);
  const auto settings = result.program.settings;
  EXPECT_LT(mesh_chord_mm(design.mesh, crease_limits(settings, settings.blade)), 1e-9);
  EXPECT_EQ(faces_of(design, settings), 2U);
}

// A height map has no edges along its folds: the cut has them, and a tooth across a cell of 5 x 5 mm is off
// it by what a chord of at most the cell's diagonal cuts off the corner.
TEST(PlanCreases, FoldsAcrossTheCellsOfAHeightMapPartIt) {
  const double slope = 0.3, turned = 0.3;
  const surface::DesignSurface design = grid_design("height map", 100, 80, [&](double u, double v) {
    const double x = 500 * (u - 0.5), y = 400 * (v - 0.5);
    return Vector3d(x, y, -slope * std::abs(x * std::cos(turned) + y * std::sin(turned)));
  });
  const PlanResult result = plan(design, back(), {});
  expect_passes(result, 2, 0.5 * std::hypot(5, 5) * std::sin(std::atan(slope)));
  EXPECT_EQ(result.faces.size(), 2U);
  EXPECT_LT(result.verification.deviation.p99, 0.1);
}

TEST(PlanCreases, AnUprightCornerIsTwoWalls) {
  const surface::DesignSurface walls = grid_design("walls", 40, 10, [](double u, double v) {
    return u < 0.5 ? Vector3d(300 - 600 * u, 0, 400 * v) : Vector3d(0, 600 * (u - 0.5), 400 * v);
  });
  expect_passes(plan(walls, back(), {}), 2, 0.01);
}

TEST(PlanCreases, ArcsSideBySideMeetInStraightAndInBentCreases) {
  for (const double bent : {0.0, 60.0}) {
    const surface::DesignSurface design = scallops(bent);
    const PlanResult result = plan(design, back(), {});
    expect_passes(result, bent > 0 ? 4 : 2, bent > 0 ? 0.7 : 0.4);
    // What verify says of the finished program alone.
    VerifyOptions options;
    const VerifyReport again = verify(result.program, design, options);
    EXPECT_EQ(again.deviation.max, result.verification.deviation.max);
  }
}

// Quarters of groin vaults of 3 m: triangles, of which a grid of parts has cells without any design. One
// takes four to seven strips, by how its seams lie: all together say more.
TEST(Plan, TrianglesThatTakeSeveralBlocksAreCut) {
  std::size_t strips = 0;
  for (const auto& [length, radius] :
       {std::pair{1400, 1800}, {1400, 2000}, {1500, 1800}, {1500, 2000}, {1600, 2000}}) {
    const int pieces = radius / 20 - 50;
    const surface::DesignSurface design =
        grid_design("sector", pieces, pieces, [length = length, radius = radius](double u, double v) {
          const double x = length * u, y = x * (2 * v - 1);
          return Vector3d(x, y, std::sqrt(radius * radius - y * y));
        });
    const PlanResult result = plan(design, back(), {});
    expect_passes(result, 12, 1);
    strips += result.strips.size();
  }
  EXPECT_LE(strips, 27U);
}

// Vaults so narrow and high that their strips' blades nearly snap or yield, and hang as far as they may where
// they meet.
TEST(Plan, VaultsWhoseStripsMeetAsFarAsTheirBladesGoAreCut) {
  std::size_t strips = 0;
  for (const double wide : {165.0, 175.0, 185.0}) {
    for (const double high : {0.8, 0.86}) {
      const surface::DesignSurface design = grid_design("narrow", 20, 20, [&](double u, double v) {
        return Vector3d(wide * u, 300 * v, high * wide * std::sin(M_PI * u));
      });
      const PlanResult result = plan(design, back(), {});
      expect_passes(result, 5, 1);
      strips += result.strips.size();
    }
  }
  EXPECT_LE(strips, 19U);
}

// A shell in rows of blocks: each strip by itself first, then all together.
TEST(Plan, OfManyBlocksLooksAtStripsByThemselvesFirst) {
  const surface::DesignSurface design = grid_design("shell", 60, 60, [](double u, double v) {
    const double x = 2 * u - 1, y = 2 * v - 1;
    return Vector3d(1500 * x, 1500 * y,
                    300 - 150 * (x * x + y * y) + 25 * std::sin(5 * x + 1) * std::sin(4 * y));
  });
  const PlanResult result = plan(design, back(), {});
  expect_passes(result, 20, 1);
  ASSERT_GE(result.decisions.size(), 2U);
  EXPECT_TRUE(result.decisions.front().alone);
  EXPECT_FALSE(result.decisions.front().taken);
  EXPECT_FALSE(result.decisions.back().alone);
  EXPECT_TRUE(result.decisions.back().taken);
  EXPECT_EQ(result.decisions.back().strips, result.strips.size());
  // A coarse look at a strip that then hardly moves finds what the full one does.
  EXPECT_NEAR(result.decisions.front().deviation_mm, result.decisions.back().deviation_mm, 0.1);
}

TEST(PlanCreases, AFaceThatNoBladeFollowsIsRefusedByItsStrip) {
  // The second plate has dents of a radius of some mm.
  const surface::DesignSurface design = grid_design("dents", 80, 30, [](double u, double v) {
    const double dent = u > 0.55 ? 8 * std::sin(60 * u) * std::sin(40 * v) : 0;
    return Vector3d(600 * u, 400 * v, 0.8 * 600 * std::abs(u - 0.5) + dent);
  });
  ASSERT_EQ(faces_of(design, back()), 2U);
  const PlanResult result = plan(design, back(), {});
  ASSERT_FALSE(result.refusals.empty());
  EXPECT_EQ(result.refusals.front().strip, "S002");
  // What is left of the second plate counts beside the first one's strip, at its own place.
  for (const Refusal& r : result.refusals)
    EXPECT_TRUE(r.strip != "S001" || (r.limit == Limit::kDeviation && r.at->x() > 300)) << describe(r);
}

// White noise: most of it is one face that no blade forms, with many of some facets in it.
TEST(PlanCreases, SmallFacesAreNotTriedBesideOneThatNoBladeForms) {
  std::mt19937 random(7);
  std::normal_distribution<double> height(0, 20);
  const surface::DesignSurface design = grid_design(
      "noise", 150, 150, [&](double u, double v) { return Vector3d(420 * u, 420 * v, height(random)); });
  ASSERT_GT(faces_of(design, back()), 2U);
  const PlanResult result = plan(design, back(), {});
  EXPECT_TRUE(result.program.strips.empty());
  ASSERT_FALSE(result.refusals.empty());
  EXPECT_EQ(result.refusals.front().limit, Limit::kFacing) << describe(result.refusals.front());
  ASSERT_EQ(result.faces.size(), faces_of(design, back()));
  EXPECT_EQ(std::count_if(result.faces.begin(), result.faces.end(),
                          [](const FacePlanned& face) { return face.decisions.count > 0; }),
            1);
  // Facets that steep lean towards no side: nothing is tried, and the refusal says why.
  Settings below = back();
  below.design.keep = Keep::kBelow;
  const PlanResult untried = plan(design, below, {});
  ASSERT_EQ(untried.refusals.size(), 1U);
  EXPECT_EQ(untried.refusals.front().limit, Limit::kLean) << describe(untried.refusals.front());
}

TEST(FacePlans, AreMadeOfTheLargestFirst) {
  const auto square = [](double edge_mm) {
    return grid_design("square", 2, 2,
                       [&](double u, double v) { return Vector3d(edge_mm * u, edge_mm * v, 0); })
        .mesh;
  };
  const std::vector<surface::TriangleMesh> faces{square(20), square(300), square(29), square(200),
                                                 square(31)};
  const auto order = [&](std::size_t without) {
    std::vector<std::size_t> planned;
    largest_first(faces, [&](std::size_t i) {
      planned.push_back(i);
      return i != without;
    });
    return planned;
  };
  EXPECT_EQ(order(5), (std::vector<std::size_t>{1, 3, 4, 2, 0}));
  // A hundredth of it is 30 mm long.
  EXPECT_EQ(order(1), (std::vector<std::size_t>{1, 3, 4}));
  EXPECT_EQ(order(4), (std::vector<std::size_t>{1, 3, 4, 2, 0}));
}

// Each strip is compared with the face that it forms: past the crease it cuts foam of its own block.
TEST(DesignFaces, AStripEndsAtTheCreasesOfItsFace) {
  const surface::DesignSurface design = fold(0.5);
  const Program program = plan(design, back(), {}).program;
  const DesignFaces faces(design.mesh, program, gpu::Backend::kCpu);
  ASSERT_EQ(faces.count(), 2U);
  ASSERT_EQ(program.strips.size(), 2U);
  EXPECT_NE(faces.face_of(0), faces.face_of(1));
  // On the plate beyond the crease, 20 mm from it.
  const std::vector<Vector3d> point{{320, 200, 0.5 * 20}};
  const double slant = std::sqrt(1 + 0.5 * 0.5);
  for (const int strip : {0, 1}) {
    const DesignFaces::Foot foot = faces.feet(point, [&](std::size_t) { return strip; }).front();
    const bool own = faces.face_of(strip) == faces.face_of(1);
    EXPECT_EQ(foot.on_border, !own);
    EXPECT_NEAR(foot.distance, own ? 0 : 20 * slant, 1e-9);
    EXPECT_NEAR(std::abs(foot.normal.z()), 1 / slant, 1e-9);
  }
}

TEST(DesignFaces, OfTheSamplesAndPanelsAreOneEach) {
  for (const char* name : {"barrel_vault", "s_wall", "hypar", "bump", "saddle", "vase", "window", "branch",
                           "ragged", "wave_wall", "corner", "petal"}) {
    const std::string base = hotblade::testing::source_dir() + "/samples/" + name;
    Settings settings = resolve({{base + ".toml"}, {}, {}});
    for (const ShallowFolds folds : {ShallowFolds::kAuto, ShallowFolds::kParted}) {
      settings.slice.shallow_folds = folds;
      EXPECT_EQ(faces_of(surface::read_obj(base + ".obj", {settings.design.units, 'z'}), settings), 1U)
          << name;
    }
  }
}

// A bent sheet with a border to which each second vertex of the last row adds a sliver that hangs down, as
// triangulations of points on an uneven hull have them.
surface::DesignSurface with_slivers() {
  constexpr int kColumns = 40, kRows = 30;
  const testing::TemporaryDirectory directory;
  const std::filesystem::path file = directory / "slivers.obj";
  {
    std::ofstream out(file);
    const auto vertex = [&](double u, double y, double drop) {
      out << "v " << 600 * u << " " << y << " " << 60 * u * u - drop << "\n";
    };
    for (int i = 0; i <= kColumns; ++i)
      for (int j = 0; j <= kRows; ++j) vertex(1.0 * i / kColumns, 400.0 * j / kRows, 0);
    const auto number = [](int i, int j) { return i * (kRows + 1) + j + 1; };
    for (int i = 0; i < kColumns; ++i) {
      for (int j = 0; j < kRows; ++j) {
        const int a = number(i, j), c = number(i + 1, j);
        out << "f " << a << " " << c << " " << c + 1 << "\nf " << a << " " << c + 1 << " " << a + 1 << "\n";
      }
    }
    int next = number(kColumns, kRows) + 1;
    for (int i = 0; i < kColumns; i += 2, ++next) {
      vertex((i + 0.5) / kColumns, 400.03, 0.4);
      out << "f " << number(i, kRows) << " " << number(i + 1, kRows) << " " << next << "\n";
    }
  }
  return surface::read_obj(file, {"mm", 'z'});
}

TEST(DesignFaces, SliversAtTheBorderAreCutWithTheRest) {
  const surface::DesignSurface design = with_slivers();
  EXPECT_EQ(design.mesh.triangles().size(), 2420U);
  EXPECT_EQ(faces_of(design, back()), 1U);
  const PlanResult result = plan(design, back(), {});
  expect_passes(result, 1, 1);
  EXPECT_TRUE(result.faces.empty());
}

// Two panels of 600 mm in one file, so many mm apart: one bent along x, the other one along y.
surface::DesignSurface two_panels(double apart_mm, double up_mm = 0) {
  return grid_design(
      "two", 61, 30,
      [=](double u, double v) {
        const double i = 61 * u;
        const bool right = i > 30.5;
        const double share = (right ? i - 31 : i) / 30;
        const double x = right ? 600 + apart_mm + 600 * share : 600 * share;
        return Vector3d(x, 500 * v, right ? up_mm + 90 * std::sin(3 * v) : 90 * std::sin(3 * share));
      },
      [](int i, int) { return i != 30; });
}

TEST(PlanParts, ThatLieApartArePlannedOneByOne) {
  const PlanResult far = plan(two_panels(2500, 400), back(), {});
  expect_passes(far, 2, 0.5);
  ASSERT_EQ(far.faces.size(), 2U);
  const auto planes = [&](std::size_t strip) {
    return far.program.strips[strip].ribs.front().frame.normal();
  };
  EXPECT_LT(std::abs(planes(0).dot(planes(1))), 0.99) << "each in planes of its own";
  // Each is compared with its own panel, however it passes by the other one.
  const DesignFaces faces(two_panels(2500, 400).mesh, far.program, gpu::Backend::kCpu);
  EXPECT_EQ(faces.count(), 1U);
  const std::vector<Vector3d> between{{1500, 250, 60}};
  std::vector<double> x;
  for (const int strip : {0, 1})
    x.push_back(faces.feet(between, [&](std::size_t) { return strip; }).front().point.x());
  EXPECT_LE(std::min(x[0], x[1]), 600.001);
  EXPECT_GE(std::max(x[0], x[1]), 3099.999);
  // One block holds both of these, and one blade follows them.
  const PlanResult near = plan(two_panels(100), back(), {});
  EXPECT_TRUE(near.refusals.empty());
  EXPECT_LE(near.program.strips.size(), 2U);
}

TEST(PlanParts, NearEachOtherAreOneSurfaceWithAJoint) {
  const surface::DesignSurface joint = grid_design(
      "joint", 60, 20, [](double u, double v) { return Vector3d(600 * u, 400 * v, 80 * std::sin(3 * u)); },
      [](int, int j) { return j != 10; });
  const PlanResult result = plan(joint, back(), {});
  expect_passes(result, 1, 1);
  EXPECT_TRUE(result.faces.empty());
  EXPECT_EQ(parts_apart(joint.mesh).size(), 1U);
  EXPECT_EQ(parts_apart(two_panels(59).mesh).size(), 1U);
  EXPECT_EQ(parts_apart(two_panels(61).mesh).size(), 2U);
}

TEST(Forecast, TellsTheFacesThatCreasesPart) {
  EXPECT_EQ(forecast(fold(0.5), back()).faces, 2U);
  EXPECT_EQ(forecast(fold(0.05), back()).faces, 1U);
  EXPECT_EQ(forecast(fold(0.05), back()).faces_between_folds, 1U);
  const Forecast shallow = forecast(crossed_folds(700, 0.12), back());
  EXPECT_EQ(shallow.faces, 1U);
  EXPECT_EQ(shallow.faces_between_folds, 4U);
  EXPECT_EQ(forecast(two_panels(500), back()).faces, 2U);
  EXPECT_EQ(forecast(two_panels(20), back()).faces, 1U);
  Settings crossed = back();
  crossed.slice.shallow_folds = ShallowFolds::kCrossed;
  EXPECT_EQ(forecast(crossed_folds(700, 0.12), crossed).faces_between_folds, 1U);
}

}  // namespace
}  // namespace hotblade::pipeline

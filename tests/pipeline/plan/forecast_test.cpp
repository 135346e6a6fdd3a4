#include "pipeline/plan/forecast.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "pipeline/plan/plan.hpp"
#include "pipeline/plan/thinned.hpp"
#include "pipeline/program/read_design.hpp"
#include "pipeline/settings/assignments.hpp"
#include "tests/paths.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector3d;

// A patch of a sphere about its pole, opening towards `open`.
Vector3d cap(double radius, double half_rad, double u, double v) {
  const double a = half_rad * (2 * u - 1), b = half_rad * (2 * v - 1);
  return radius * Vector3d(std::sin(a) * std::cos(b), std::sin(b), std::cos(a) * std::cos(b));
}

surface::DesignSurface cap(double radius, double half_rad, int n = 40) {
  return grid_design("cap", n, n, [=](double u, double v) { return cap(radius, half_rad, u, v); });
}

// A bowl that opens to the side.
surface::DesignSurface bowl_on_its_side() {
  return grid_design("side", 40, 40, [](double u, double v) -> Vector3d {
    const Vector3d p = cap(300, 0.6, u, v);
    return {-p.z(), p.y(), p.x()};
  });
}

// The forecast; a first look says the same as far as it goes.
Forecast met(const surface::DesignSurface& design, const Settings& settings) {
  Forecast whole = forecast(design, settings);
  const FirstLook look = first_look(design, settings);
  EXPECT_EQ(look.odd_size.has_value(), whole.odd_size.has_value());
  if (look.odd_size && whole.odd_size) {
    EXPECT_EQ(describe(*look.odd_size), describe(*whole.odd_size));
    EXPECT_EQ(look.odd_size->hopeless, whole.odd_size->hopeless);
  }
  EXPECT_EQ(look.planes_warning, whole.planes_warning);
  EXPECT_EQ(look.suggestions.size(), whole.suggestions.size());
  for (std::size_t i = 0; i < std::min(look.suggestions.size(), whole.suggestions.size()); ++i) {
    EXPECT_EQ(look.suggestions[i].assignments, whole.suggestions[i].assignments);
    EXPECT_EQ(look.suggestions[i].why, whole.suggestions[i].why);
  }
  return whole;
}

Settings in(const std::string& units) {
  return resolve({{}, {"design.units=" + units}, {}});
}

// The settings with a suggestion of the forecast, the first unless told otherwise.
Settings followed(const Forecast& f, std::size_t which = 0) {
  return with_assignments(in("mm"), f.suggestions.at(which).assignments);
}

TEST(Forecast, SaysTheSmallestRadiusOfKnownSurfaces) {
  const Forecast round = met(cap(300, 0.7), in("mm")), tube = met(cylinder_design(), in("mm"));
  EXPECT_NEAR(round.surface.radius_mm, 300, 0.1 * 300);
  EXPECT_NEAR(tube.surface.radius_mm, 400, 0.05 * 400);
  EXPECT_EQ(round.surface.sharper_share, 0);
  EXPECT_EQ(round.steep_share, 0);
  for (const Forecast* f : {&round, &tube}) {
    EXPECT_TRUE(f->suggestions.empty());
    EXPECT_TRUE(f->reasons.empty());
    EXPECT_FALSE(f->odd_size.has_value());
  }
  EXPECT_FALSE(round.upright);
  EXPECT_NEAR(round.blade_radius_mm, 70.5, 1);
}

TEST(Forecast, SaysThatABallBendsMoreSharplyThanTheBladeAllOver) {
  const Forecast f = met(cap(40, 0.7), in("mm"));
  EXPECT_GT(f.surface.sharper_share, 0.95);
  // Whatever the planes, what is not too steep for them is too sharp.
  EXPECT_GT(f.steep_share + f.sections.sharper_share, 0.95);
  EXPECT_NEAR(f.surface.radius_mm, 40, 4);
}

TEST(Forecast, SaysTheSameOfAFinerMesh) {
  const Forecast coarse = met(cap(300, 0.7, 30), in("mm")), fine = met(cap(300, 0.7, 240), in("mm"));
  EXPECT_NEAR(fine.surface.radius_mm, coarse.surface.radius_mm, 0.1 * 300);
  EXPECT_NEAR(fine.sections.radius_mm, coarse.sections.radius_mm, 0.15 * coarse.sections.radius_mm);
}

TEST(Forecast, SaysTheShareThatIsTooSteepForPlanesThatAreGiven) {
  Settings settings = in("mm");
  settings.slice.direction = {{0, 0, 1}};
  // Of a cap of 1.3 rad what lies within 30 degrees of the pole leans by over 60 degrees against level
  // planes.
  const auto wide = grid_design("wide", 60, 60, [](double u, double v) -> Vector3d {
    const double polar = 0.01 + 1.29 * u, round = 2 * std::numbers::pi * v;
    return 300 *
           Vector3d(std::sin(polar) * std::cos(round), std::sin(polar) * std::sin(round), std::cos(polar));
  });
  const double share = (1 - std::cos(std::numbers::pi / 6)) / (1 - std::cos(1.3));
  EXPECT_NEAR(met(wide, settings).steep_share, share, 0.03);
}

// Whether a plan by the settings passes.
void expect_planned(const surface::DesignSurface& design, const Settings& settings) {
  const PlanResult result = plan(design, settings, {});
  for (const Refusal& r : result.refusals) ADD_FAILURE() << describe(r);
}

using ::testing::ElementsAre;

TEST(Suggestion, OfABowlOnItsSideIsToKeepWhatLiesBehindIt) {
  const surface::DesignSurface side = bowl_on_its_side();
  const Forecast f = met(side, in("mm"));
  EXPECT_TRUE(f.upright);
  ASSERT_EQ(f.suggestions.size(), 1U);
  EXPECT_THAT(f.suggestions[0].assignments, ElementsAre("design.keep=back"));
  EXPECT_THAT(f.reasons,
              ElementsAre("design.keep = \"below\" says nothing about a surface that stands upright"));
  EXPECT_FALSE(plan(side, in("mm"), {}).refusals.empty());
  expect_planned(side, followed(f));
  EXPECT_TRUE(met(side, followed(f)).suggestions.empty());
  EXPECT_TRUE(met(side, followed(f)).reasons.empty());
}

TEST(Suggestion, OfAVaultWithYUpIsToReadItSo) {
  const testing::TemporaryDirectory directory;
  const auto file = directory / "y_up.obj";
  {
    std::ofstream out(file);
    constexpr int kRound = 60, kAlong = 4;
    for (int i = 0; i <= kAlong; ++i) {
      for (int j = 0; j <= kRound; ++j) {
        const double phi = 0.6 * (2.0 * j / kRound - 1);
        out << "v " << 400 * std::sin(phi) << " " << 400 * std::cos(phi) << " " << -100 * i << "\n";
      }
    }
    for (int i = 0; i < kAlong; ++i) {
      for (int j = 0; j < kRound; ++j) {
        const int a = i * (kRound + 1) + j + 1, c = a + kRound + 1;
        out << "f " << a << " " << a + 1 << " " << c + 1 << " " << c << "\n";
      }
    }
  }
  const Settings before = in("mm");
  const Forecast f = met(read_design(file, before.design), before);
  ASSERT_EQ(f.suggestions.size(), 2U);
  EXPECT_THAT(f.suggestions[0].assignments, ElementsAre("design.up=y"));
  EXPECT_THAT(f.suggestions[1].assignments, ElementsAre("design.keep=back"));
  EXPECT_FALSE(plan(read_design(file, before.design), before, {}).refusals.empty());
  for (const std::size_t which : {0U, 1U}) {
    const Settings after = followed(f, which);
    expect_planned(read_design(file, after.design), after);
  }
  // Read as told it asks for nothing more; a vault with z up, read with y up, is told to say that.
  const Settings after = followed(f);
  EXPECT_TRUE(met(read_design(file, after.design), after).suggestions.empty());
  const std::string vault = hotblade::testing::source_dir() + "/samples/barrel_vault.obj";
  const Settings lying = with_assignments(in("mm"), {"design.up=y"});
  const Forecast other = met(read_design(vault, lying.design), lying);
  ASSERT_FALSE(other.suggestions.empty());
  EXPECT_THAT(other.suggestions[0].assignments, ElementsAre("design.up=z"));
}

TEST(Suggestion, OfAClosedDesignIsTheSideThatShowsMostOfIt) {
  // A thick plate, bent, that stands upright: its two sides face along x.
  const testing::TemporaryDirectory directory;
  const auto file = directory / "plate.obj";
  {
    std::ofstream out(file);
    constexpr int kRound = 40;
    for (const double thick : {0.0, 30.0}) {
      for (const double z : {0.0, 300.0}) {
        for (int j = 0; j <= kRound; ++j) {
          const double phi = 0.5 * (2.0 * j / kRound - 1), r = 400 + thick;
          out << "v " << r * std::cos(phi) << " " << r * std::sin(phi) << " " << z << "\n";
        }
      }
    }
    constexpr int kRow = kRound + 1;  // inner low, inner high, outer low, outer high
    const auto quad = [&](int a, int b, int c, int d) {
      out << "f " << a + 1 << " " << b + 1 << " " << c + 1 << " " << d + 1 << "\n";
    };
    for (int j = 0; j < kRound; ++j) {
      quad(j, kRow + j, kRow + j + 1, j + 1);
      quad(2 * kRow + j, 2 * kRow + j + 1, 3 * kRow + j + 1, 3 * kRow + j);
      quad(j, j + 1, 2 * kRow + j + 1, 2 * kRow + j);
      quad(kRow + j, 3 * kRow + j, 3 * kRow + j + 1, kRow + j + 1);
    }
    quad(0, 2 * kRow, 3 * kRow, kRow);
    quad(kRound, kRow + kRound, 3 * kRow + kRound, 2 * kRow + kRound);
  }
  const Settings before = in("mm");
  const surface::DesignSurface plate = read_design(file, before.design);
  ASSERT_TRUE(plate.health.closed);
  const Forecast f = met(plate, before);
  ASSERT_TRUE(f.facing.has_value());
  EXPECT_NEAR(std::abs((*f.facing)[0]), 1, 1e-3);
  // It stands upright, so that `below` says nothing.
  ASSERT_EQ(f.suggestions.size(), 1U);
  ASSERT_EQ(f.suggestions[0].assignments.size(), 2U);
  EXPECT_EQ(f.suggestions[0].assignments[1], "design.keep=back");
  EXPECT_EQ(f.reasons.size(), 2U);
  const Settings after = followed(f);
  expect_planned(read_design(file, after.design), after);
}

// The vault of the samples, 900 x 500 x 140 mm, by a factor and in a unit.
surface::DesignSurface scaled_vault(double by, const std::string& units) {
  const surface::DesignSurface vault =
      surface::read_obj(hotblade::testing::source_dir() + "/samples/barrel_vault.obj", {"mm", 'z'});
  const testing::TemporaryDirectory directory;
  const auto file = directory / "scaled.obj";
  {
    std::ofstream out(file);
    out.precision(12);
    for (const Vector3d& p : vault.mesh.vertices())
      out << "v " << by * p.x() << " " << by * p.y() << " " << by * p.z() << "\n";
    for (const auto& t : vault.mesh.triangles())
      out << "f " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << "\n";
  }
  return surface::read_obj(file, {units, 'z'});
}

std::vector<std::string> units_of(const OddSize& odd) {
  std::vector<std::string> units;
  for (const OtherUnit& other : odd.others) units.push_back(other.units);
  return units;
}

TEST(OddSize, NamesEveryUnitThatSuitsAndNoneWhereTheSizeIsUsual) {
  const Settings settings =
      resolve({{hotblade::testing::source_dir() + "/samples/barrel_vault.toml"}, {}, {}});
  struct Case {
    double by;
    const char *read_as, *is;
    bool hopeless;
    double is_mm;  // its length in that unit
  };
  // Numbers of 0.9 read as mm or inches are 0.9 and 23 mm, of 900 read as inches or m 23 and 900 m.
  for (const Case& c : {Case{1e-3, "mm", "m", true, 900}, Case{1e-3, "in", "m", true, 900},
                        Case{1 / 25.4, "mm", "in", true, 900}, Case{0.023, "mm", "m", true, 20700},
                        Case{1, "in", "mm", false, 900}, Case{1, "m", "mm", false, 900}}) {
    const Forecast f = met(scaled_vault(c.by, c.read_as), settings);
    ASSERT_TRUE(f.odd_size.has_value()) << c.by << " " << c.read_as;
    EXPECT_EQ(f.odd_size->hopeless, c.hopeless) << c.by << " " << c.read_as << ": " << f.odd_size->why;
    EXPECT_THAT(units_of(*f.odd_size), ::testing::Contains(c.is)) << c.by << " " << c.read_as;
    EXPECT_THAT(units_of(*f.odd_size), ::testing::Not(::testing::Contains(c.read_as)));
    for (const OtherUnit& other : f.odd_size->others) {
      if (other.units == c.is) {
        EXPECT_NEAR(other.size_mm.x(), c.is_mm, 1) << c.by << " " << c.read_as;
      }
    }
    const bool small = c.is_mm < 10000;
    const bool suggested = std::any_of(f.suggestions.begin(), f.suggestions.end(), [&](const Suggestion& s) {
      return s.assignments == std::vector<std::string>{std::string("design.units=") + c.is};
    });
    EXPECT_EQ(suggested, small) << "what takes many strips is said, and not tried unasked";
  }
  for (const Case& c : {Case{1e-3, "m", "", false, 0}, Case{1 / 25.4, "in", "", false, 0},
                        Case{1, "mm", "", false, 0}, Case{0.3, "mm", "", false, 0}})
    EXPECT_FALSE(met(scaled_vault(c.by, c.read_as), settings).odd_size.has_value()) << c.read_as;
}

// A pipe of 58 mm radius is straight along its axis, and too sharp for the blade round it.
TEST(OddSize, IsNotAskedAboutWhereOnlyThePlanesGivenAreToBlame) {
  const auto pipe = grid_design("pipe", 30, 20, [](double u, double v) {
    const double a = 1.2 * (2 * v - 1);
    return Vector3d(700 * u, 58 * std::sin(a), 58 * std::cos(a));
  });
  Settings settings = in("mm");
  EXPECT_FALSE(met(pipe, settings).planes_warning.has_value());
  settings.slice.direction = {0, 1, 0};
  EXPECT_FALSE(met(pipe, settings).planes_warning.has_value());
  settings.slice.direction = {1, 0, 0};
  const Forecast across = met(pipe, settings);
  EXPECT_FALSE(across.odd_size.has_value());
  EXPECT_EQ(across.planes_warning.value_or(""),
            "100 % of the area is too steep or too sharp for the blade in the planes given: others suit more "
            "of it");
  for (const Suggestion& suggestion : across.suggestions) ADD_FAILURE() << suggestion.why;
  // A ball is too sharp in any planes.
  EXPECT_FALSE(met(cap(40, 0.7), settings).planes_warning.has_value());
}

// A roof of 20 x 15 m is large and no mistake; read as mm or inches, metres are among what may be meant.
TEST(OddSize, OfARoofIsAskedAboutOnlyWhereHardlyAnythingCouldBeCut) {
  const std::string roof = hotblade::testing::source_dir() + "/samples/roof.obj";
  const Settings in_m = resolve({{hotblade::testing::source_dir() + "/samples/roof.toml"}, {}, {}});
  const auto as_read = met(read_design(roof, in_m.design), in_m).odd_size;
  EXPECT_TRUE(!as_read || !as_read->hopeless);
  const Settings in_mm = with_assignments(in_m, {"design.units=mm"});
  const auto odd = met(read_design(roof, in_mm.design), in_mm).odd_size;
  ASSERT_TRUE(odd.has_value());
  EXPECT_TRUE(odd->hopeless);
  EXPECT_THAT(units_of(*odd), ElementsAre("cm", "m", "in", "ft"));
  EXPECT_THAT(describe(*odd), ::testing::HasSubstr("20000 x 15000 x "));
  EXPECT_THAT(describe(*odd), ::testing::HasSubstr("mm if in m (89 strips at least), "));
}

TEST(Thinned, LeavesACoarseMeshAndHoldsAFineOnesShape) {
  const surface::DesignSurface coarse = cap(300, 0.7, 10), fine = cap(300, 0.7, 200);
  EXPECT_EQ(thinned(coarse.mesh, 5).triangles().size(), coarse.mesh.triangles().size());
  const surface::TriangleMesh thin = thinned(fine.mesh, 10);
  EXPECT_LT(thin.vertices().size(), fine.mesh.vertices().size() / 10);
  for (const Vector3d& p : thin.vertices()) EXPECT_NEAR(p.norm(), 300, 1e-3);
  EXPECT_EQ(thin.border_loops().size(), 1U);
}

}  // namespace
}  // namespace hotblade::pipeline

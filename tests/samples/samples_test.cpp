#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "elastica/fit/fit.hpp"
#include "pipeline/plan/plan.hpp"
#include "pipeline/verify/verify.hpp"
#include "samples/bends.hpp"
#include "samples/sample_surfaces.hpp"
#include "surface/read/design_surface.hpp"

#include "tests/paths.hpp"

namespace hotblade::samples {
namespace {

using Eigen::Vector3d;
const std::filesystem::path kSamples = std::filesystem::path(hotblade::testing::source_dir()) / "samples";

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

// The hills at tolerances from coarse to fine: each kept, with more strips or ribs for less.
TEST(SampleBump, IsCutWithinEveryToleranceAskedFor) {
  pipeline::Settings settings = pipeline::resolve({{kSamples / "bump.toml"}, {}, {}});
  const surface::DesignSurface design =
      surface::read_obj(kSamples / "bump.obj", {settings.design.units, settings.design.up.front()});
  std::size_t before = 0;
  // At a tenth of a millimetre the registers' micrometres alone move its nearly straight blades by as much.
  for (const double tolerance_mm : {2.0, 1.0, 0.5, 0.2}) {
    settings.design.tolerance_mm = tolerance_mm;
    const pipeline::PlanResult result = pipeline::plan(design, settings, {});
    for (const pipeline::Refusal& r : result.refusals) ADD_FAILURE() << tolerance_mm << ": " << describe(r);
    EXPECT_EQ(result.program.verification.status, pipeline::VerificationStatus::kPassed);
    EXPECT_LE(result.verification.bound_mm, tolerance_mm);
    std::size_t ribs = 0;
    for (const pipeline::StripFacts& f : result.strips) ribs += f.ribs;
    EXPECT_GE(ribs, before);
    before = ribs;
  }
}

// Blades that turn, at four feeds: planned with one band and executed under bands that depend on the speed,
// the cut is off; planned by those bands it is as near as if there were one.
TEST(SampleCorner, IsCutAsNearByBandsThatDependOnTheSpeed) {
  pipeline::Settings settings = pipeline::resolve({{kSamples / "corner.toml"}, {}, {}});
  const surface::DesignSurface design =
      surface::read_obj(kSamples / "corner.obj", {settings.design.units, settings.design.up.front()});
  const robot::Melt melt{{{1, 2.6}, {3, 1.6}, {7, 1.0}, {15, 0.7}}, 0, 0};
  pipeline::VerifyOptions options;
  options.tolerance_mm = settings.design.tolerance_mm;
  for (const double feed : {3.0, 4.0, 7.0, 15.0}) {
    settings.motion.feed_mm_s = feed;
    settings.blade.melt = {};
    settings.blade.kerf_mm = melt.band_mm(feed);
    pipeline::PlanResult one = pipeline::plan(design, settings, {});
    ASSERT_EQ(one.program.verification.status, pipeline::VerificationStatus::kPassed) << feed;
    // Of 99 of a hundred points: the largest of all goes up and down by a tenth of the tolerance with each
    // fit.
    const double planned_mm = one.verification.deviation.p99;
    one.program.blade.melt = melt;
    const double executed_mm = pipeline::verify(one.program, design, options).deviation.p99;
    settings.blade.melt = melt;
    const pipeline::PlanResult coupled = pipeline::plan(design, settings, {});
    ASSERT_EQ(coupled.program.verification.status, pipeline::VerificationStatus::kPassed) << feed;
    const double coupled_mm = coupled.verification.deviation.p99;
    EXPECT_GT(executed_mm - planned_mm, feed < 10 ? 0.04 : 0.01) << feed;
    // At eight feeds from 2 to 13 mm/s the one is 0.011 mm nearer to 0.021 mm farther than the other.
    const double told_mm = 0.025 * settings.design.tolerance_mm;
    EXPECT_LT(coupled_mm - planned_mm, std::max(told_mm, (executed_mm - planned_mm) / 5)) << feed;
    // The program says its bands itself.
    const pipeline::Program read = pipeline::parse_program(pipeline::to_json(coupled.program), "corner");
    EXPECT_EQ(read.blade.melt, melt);
    EXPECT_EQ(pipeline::verify(read, design, options).deviation.p99, coupled_mm);
    double widest = 0, narrowest = 10;
    for (const pipeline::StripFacts& strip : coupled.strips) {
      widest = std::max(widest, strip.band_max_mm);
      narrowest = std::min(narrowest, strip.band_min_mm);
    }
    EXPECT_NEAR(narrowest, melt.band_mm(feed), 0.02);
    EXPECT_GT(widest, narrowest + 0.2);
  }
}

class Samples : public ::testing::TestWithParam<SampleSurface> {};

INSTANTIATE_TEST_SUITE_P(All, Samples, ::testing::ValuesIn(sample_surfaces()),
                         [](const auto& sample) { return sample.param.name; });

// The largest distance of the formula from the planes of the mesh's triangles, over a fine raster of each.
double chord_error(const SampleSurface& s) {
  constexpr int kRaster = 6;
  const double du = s.u_mm / s.u_cells, dv = s.v_mm / s.v_cells;
  double worst = 0;
  for (int j = 0; j < s.v_cells; ++j) {
    for (int i = 0; i < s.u_cells; ++i) {
      if (s.has != nullptr && !s.has((i + 0.5) * du, (j + 0.5) * dv)) continue;
      const auto at = [&](double a, double b) { return s.point((i + a) * du, (j + b) * dv); };
      const Vector3d p = at(0, 0), q = at(1, 1);
      for (const bool lower : {true, false}) {
        const Vector3d corner = lower ? at(1, 0) : at(0, 1);
        const Vector3d normal = (corner - p).cross(q - p).normalized();
        for (int k = 0; k <= kRaster; ++k) {
          for (int m = 0; m <= k; ++m) {
            const double major = static_cast<double>(k) / kRaster, minor = static_cast<double>(m) / kRaster;
            const Vector3d on = lower ? at(major, minor) : at(minor, major);
            worst = std::max(worst, std::abs(normal.dot(on - p)));
          }
        }
      }
    }
  }
  return worst;
}

// Largest principal curvature, by central differences over half a millimetre.
double max_curvature(const SampleSurface& s, double u, double v) {
  constexpr double kStep = 0.5;
  const auto at = [&](double a, double b) { return s.point(u + a * kStep, v + b * kStep); };
  const Vector3d fu = (at(1, 0) - at(-1, 0)) / (2 * kStep), fv = (at(0, 1) - at(0, -1)) / (2 * kStep);
  const Vector3d fuu = (at(1, 0) - 2 * at(0, 0) + at(-1, 0)) / (kStep * kStep);
  const Vector3d fvv = (at(0, 1) - 2 * at(0, 0) + at(0, -1)) / (kStep * kStep);
  const Vector3d fuv = (at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1)) / (4 * kStep * kStep);
  const Vector3d n = fu.cross(fv).normalized();
  const double e = fu.dot(fu), f = fu.dot(fv), g = fv.dot(fv), area = e * g - f * f;
  const double l = fuu.dot(n), m = fuv.dot(n), k = fvv.dot(n);
  const double mean = (e * k - 2 * f * m + g * l) / (2 * area), gauss = (l * k - m * m) / area;
  return std::abs(mean) + std::sqrt(std::max(0.0, mean * mean - gauss));
}

class Bends : public ::testing::TestWithParam<SampleSurface> {};

INSTANTIATE_TEST_SUITE_P(All, Bends, ::testing::ValuesIn(bends()),
                         [](const auto& bend) { return bend.param.name; });

TEST_P(Bends, LieWithinTheirChordsAndBendNoSharperThanTheySay) {
  EXPECT_LT(chord_error(GetParam()), GetParam().chord_mm);
  double curvature = 0;
  for (int i = 0; i <= 50; ++i) {
    for (int j = 0; j <= 50; ++j) {
      curvature =
          std::max(curvature, max_curvature(GetParam(), GetParam().u_mm * i / 50, GetParam().v_mm * j / 50));
    }
  }
  EXPECT_GT(1 / curvature, GetParam().radius_mm);
}

// Of the table that melt_table prints, its least favourable feed: the band differs least at the fastest. The
// simulator's execution is left out here: it differs by the registers' micrometre.
TEST_P(Bends, AreCutFiveTimesNearerByBandsThatDependOnTheSpeed) {
  pipeline::Settings settings = bend_settings(GetParam());
  const robot::Melt melt = bend_foam();
  settings.motion.feed_mm_s = 15;
  settings.blade.kerf_mm = melt.band_mm(settings.motion.feed_mm_s);
  const std::string obj = obj_text(GetParam());
  const surface::DesignSurface design = surface::surface_of(obj, GetParam().name + ".obj", {.units = "mm"});
  pipeline::PlanResult one = pipeline::plan(design, settings, {});
  ASSERT_EQ(one.program.verification.status, pipeline::VerificationStatus::kPassed);
  one.program.blade.melt = melt;
  pipeline::VerifyOptions options;
  options.tolerance_mm = settings.design.tolerance_mm;
  const double one_mm = pipeline::verify(one.program, design, options).deviation.max;
  settings.blade.melt = melt;
  const pipeline::PlanResult coupled = pipeline::plan(design, settings, {});
  ASSERT_EQ(coupled.program.verification.status, pipeline::VerificationStatus::kPassed);
  EXPECT_GT(one_mm, 5 * coupled.verification.deviation.max) << one_mm;
  EXPECT_GT(one_mm, 0.2) << "the bands differ by half a millimetre along the blade";
}

TEST_P(Samples, CommittedFileIsWhatTheGeneratorWrites) {
  const auto out =
      std::filesystem::path(hotblade::testing::binary_dir()) / "tests_tmp" / ("samples_" + GetParam().name);
  std::filesystem::create_directories(out);
  ASSERT_EQ(std::system((std::string("\"") + MAKE_SAMPLES + "\" \"" + out.string() + "\"").c_str()), 0);
  const std::string file = GetParam().name + ".obj";
  const std::string written = bytes_of(out / file);
  EXPECT_GT(written.size(), 100000u);
  EXPECT_TRUE(written == bytes_of(kSamples / file)) << file << ": run make_samples and commit what it writes";
  std::filesystem::remove_all(out);
}

TEST_P(Samples, MeshIsCloseToTheFormula) {
  EXPECT_LT(chord_error(GetParam()), GetParam().chord_mm);
}

TEST_P(Samples, MeshIsOfModestSize) {
  EXPECT_GE(triangle_count(GetParam()), 2000u);
  EXPECT_LE(bytes_of(kSamples / (GetParam().name + ".obj")).size(), 1'000'000u);
}

TEST_P(Samples, CurvatureRadiusIsWellAboveWhatTheBladeCanTake) {
  double curvature = 0;
  for (int i = 0; i <= 200; ++i) {
    for (int j = 0; j <= 200; ++j) {
      curvature = std::max(curvature,
                           max_curvature(GetParam(), GetParam().u_mm * i / 200, GetParam().v_mm * j / 200));
    }
  }
  EXPECT_GT(1 / curvature, GetParam().radius_mm);
}

TEST_P(Samples, JobFileResolvesAndTheDesignIsSliceable) {
  const std::string name = GetParam().name;
  const pipeline::Settings settings = pipeline::resolve({{kSamples / (name + ".toml")}, {}, {}});
  EXPECT_EQ(settings.design.units, GetParam().units);
  EXPECT_EQ(settings.design.tolerance_mm, GetParam().tolerance_mm);
  const auto design = surface::read_obj(kSamples / (name + ".obj"), {settings.design.units, 'z'});
  EXPECT_TRUE(design.health.blockers.empty());
  EXPECT_TRUE(design.health.repairs.empty());
  EXPECT_TRUE(design.health.warnings.empty());
  EXPECT_EQ(design.health.components, 1u);
  EXPECT_EQ(design.health.triangles, triangle_count(GetParam()));
}

// Evenly spaced points along the sample's line at this v, in its plane.
std::vector<Eigen::Vector2d> rib(const SampleSurface& surface, double v, int n) {
  constexpr int kFine = 4000;
  std::vector<Eigen::Vector2d> fine;
  std::vector<double> length{0};
  for (int i = 0; i <= kFine; ++i) {
    const Vector3d p = surface.point(surface.u_mm * i / kFine, v);
    fine.emplace_back(p.x(), p.z());
    if (i > 0) length.push_back(length.back() + (fine.back() - fine[fine.size() - 2]).norm());
  }
  std::vector<Eigen::Vector2d> points;
  for (int k = 0; k < n; ++k) {
    const double at = length.back() * k / (n - 1);
    const auto next = std::min(std::lower_bound(length.begin(), length.end(), at), length.end() - 1);
    points.push_back(fine[static_cast<std::size_t>(next - length.begin())]);
  }
  return points;
}

TEST(BumpSample, OneElasticaMissesTheToleranceOnTheMiddleRibOfTheBump) {
  const auto surfaces = sample_surfaces();
  const auto bump =
      std::find_if(surfaces.begin(), surfaces.end(), [](const auto& s) { return s.name == "bump"; });
  ASSERT_NE(bump, surfaces.end());
  const auto whole = rib(*bump, bump->v_mm / 2, 100);
  EXPECT_GT(elastica::fit_elastica(whole, {}, {}).max, 1.0);
  // A third of it is within reach, so splitting helps.
  const std::span<const Eigen::Vector2d> third(whole.data(), 34);
  EXPECT_LT(elastica::fit_elastica(third, {}, {}).max, 0.5);
}

}  // namespace
}  // namespace hotblade::samples

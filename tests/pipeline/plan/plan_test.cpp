#include "pipeline/plan/plan.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "pipeline/report/emit.hpp"
#include "pipeline/report/json/report_json.hpp"
#include "pipeline/verify/budget.hpp"
#include "robot/blade/blade_section.hpp"
#include "tests/paths.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

struct Sample {
  const char* name;
  std::size_t most_strips;
  double most_mm;
};

class PlanSample : public ::testing::TestWithParam<Sample> {};

PlanResult plan_sample(const std::string& name) {
  const std::string base = hotblade::testing::source_dir() + "/samples/" + name;
  Settings settings = resolve({{base + ".toml"}, {}, {}});
  return plan(surface::read_obj(base + ".obj", {settings.design.units, 'z'}), settings, {});
}

TEST_P(PlanSample, IsCutWithinItsTolerance) {
  const PlanResult result = plan_sample(GetParam().name);
  for (const Refusal& r : result.refusals) ADD_FAILURE() << describe(r);
  EXPECT_EQ(result.program.verification.status, VerificationStatus::kPassed);
  EXPECT_LE(result.verification.deviation.max, GetParam().most_mm);
  EXPECT_LT(result.verification.uncut_share(), 0.001);
  EXPECT_LE(result.strips.size(), GetParam().most_strips);
  for (const StripFacts& f : result.strips) {
    EXPECT_GE(f.smallest_radius_mm(), 1 / robot::max_curvature_per_mm(result.program.blade));
    EXPECT_GT(f.smallest_margin, 1);
    EXPECT_GE(f.motion.smallest_clearance_mm, 40);
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, PlanSample,
    ::testing::Values(Sample{"barrel_vault", 1, 0.5}, Sample{"s_wall", 2, 0.65}, Sample{"hypar", 1, 0.3},
                      Sample{"bump", 4, 0.5}, Sample{"saddle", 1, 0.5}, Sample{"vase", 4, 0.85},
                      Sample{"window", 1, 0.6}, Sample{"branch", 1, 0.4}, Sample{"ragged", 1, 0.3},
                      Sample{"wave_wall", 6, 0.95}, Sample{"corner", 3, 0.9}, Sample{"petal", 1, 0.2}),
    [](const ::testing::TestParamInfo<Sample>& sample) { return std::string(sample.param.name); });

TEST(Plan, ChoosesBladesThatClampsErrorsMoveLessAndSaysWhatTheyWereBefore) {
  const surface::DesignSurface arch = grid_design("shallow arch", 30, 24, [](double u, double v) {
    return Eigen::Vector3d(500 * u, 400 * v, 12 * std::sin(3 * u));
  });
  Settings settings = back_kept();
  const PlanResult shortest = plan(arch, settings, {});
  settings.design.over_budget = OverBudget::kRefuse;
  const PlanResult result = plan(arch, settings, {});
  EXPECT_EQ(result.program.verification.status, VerificationStatus::kPassed);
  for (const SweptFit& fit : shortest.decisions.back().fits) EXPECT_FALSE(fit.before);
  const Decision& taken = result.decisions.back();
  ASSERT_EQ(taken.fits.size(), result.strips.size());
  double before_mm = 0, most_mm = 0;
  for (std::size_t i = 0; i < result.strips.size(); ++i) {
    const StripFacts& strip = result.strips[i];
    const SweptFit& fit = taken.fits[i];
    ASSERT_TRUE(fit.before) << strip.id;
    EXPECT_GE(strip.blade_length_mm, fit.before->blade_length_mm);
    EXPECT_LT(fit.fit_mm, fit.before->fit_mm + 0.3 * result.program.settings.design.tolerance_mm);
    EXPECT_LT(fit.clamps_mm, 0.5 * fit.before->clamps_mm);
    before_mm = std::max(before_mm, fit.before->clamps_mm);
    most_mm = std::max(most_mm, strip.motion.clamp_error_mm);
  }
  EXPECT_LT(most_mm, 0.2 * before_mm);
}

// What fewer lengths or smaller blocks lead to is found where there are more and larger ones.
TEST(Plan, KeepsABindingBudgetWithALongerBladeOrAStripMore) {
  const surface::DesignSurface flat =
      grid_design("plate", 20, 15, [](double u, double v) { return Eigen::Vector3d(400 * u, 300 * v, 0); });
  Settings settings = back_kept();
  settings.design.over_budget = OverBudget::kRefuse;
  for (const std::vector<double>& lengths : {Settings{}.blade.free_lengths_mm, {1000, 1200}, {600, 1200}}) {
    settings.blade.free_lengths_mm = lengths;
    const PlanResult result = plan(flat, settings, {});
    EXPECT_EQ(result.program.verification.status, VerificationStatus::kPassed) << lengths.front();
    EXPECT_LE(budget_sum_mm(result.program.verification.budget_mm), 1) << lengths.front();
  }
}

TEST(Plan, GivesTheSameBytesWithOneThreadAndTwo) {
  std::string texts[2];
  for (const std::size_t threads : {1u, 2u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    texts[threads - 1] = to_json(plan(cylinder_design(), along_x(), {}).program);
  }
  EXPECT_EQ(texts[0], texts[1]);
}

TEST(Plan, SetsFewRibsWhereTheDesignChangesLittleAlongTheSweep) {
  // Every section of the cylinder is the same circle: five ribs tell that, of sixteen sections.
  const PlanResult result = plan(cylinder_design(), along_x(), {});
  ASSERT_EQ(result.strips.size(), 1u);
  EXPECT_EQ(result.strips[0].ribs, 5u);
}

TEST(Plan, SetsRibsAsCloseAsAskedAndCutsTheSame) {
  Settings settings = along_x();
  const PlanResult few = plan(cylinder_design(), settings, {});
  settings.slice.spacing_mm = 25;
  const PlanResult many = plan(cylinder_design(), settings, {});
  EXPECT_LE(many.spacing_mm, 25);
  EXPECT_GT(many.spacing_mm, 20);
  EXPECT_GT(many.strips.at(0).ribs, few.strips.at(0).ribs);
  EXPECT_NEAR(many.verification.deviation.max, few.verification.deviation.max, 0.02);
}

TEST(Plan, KeepsStripsApartAtAWindowWhereAskedTo) {
  // A panel on a cylinder of 900 mm with a window of 240 x 200 mm, which one strip spans.
  const auto panel = [](double s, double t) -> Eigen::Vector3d {
    const double angle = 0.7 * (s - 0.5);
    return {900 * std::sin(angle), 500 * t, 900 * std::cos(angle) - 800};
  };
  const auto window = [](int i, int j) { return !(20 <= i && i < 43 && 12 <= j && j < 28); };
  Settings settings = along_x();
  settings.slice.direction = {{0, 1, 0}};
  const auto design = grid_design("panel", 64, 40, panel, window);
  const PlanResult across = plan(design, settings, {});
  EXPECT_EQ(across.program.verification.status, VerificationStatus::kPassed);
  ASSERT_EQ(across.program.strips.size(), 1u);
  EXPECT_EQ(across.verification.uncut_mm2, 0);
  // The cut over the window, 240 x 200 mm without 1 mm along its border, as samples up to 10 mm apart tell
  // it, and what goes on past the design's ends.
  constexpr double kWindowMm2 = 238 * 198;
  EXPECT_NEAR(across.verification.beyond_mm2, kWindowMm2, 0.25 * kWindowMm2);
  settings.slice.gaps = Gaps::kApart;
  const PlanResult apart = plan(design, settings, {});
  EXPECT_EQ(apart.program.verification.status, VerificationStatus::kPassed);
  ASSERT_EQ(apart.program.strips.size(), 2u);
  EXPECT_LT(apart.strips.at(1).seam.gap_mm, 0.05);
  EXPECT_EQ(apart.verification.uncut_mm2, 0);
  // Each rib keeps to its side of the window's middle, x = -5, but for the overlap of 8 mm and half a band.
  for (const Strip& strip : apart.program.strips) {
    double low = 1e9, high = -1e9;
    for (const Rib& rib : strip.ribs) {
      for (const Eigen::Vector2d& q : rib.target) {
        const double x = rib.frame.point(q.x(), q.y()).x();
        low = std::min(low, x);
        high = std::max(high, x);
      }
    }
    EXPECT_TRUE(low > -30 || high < 30) << low << " to " << high;
  }
}

TEST(Plan, SetsMoreRibsForASmallerTolerance) {
  std::size_t before = 0;
  for (const double tolerance : {2.0, 0.5, 0.2}) {
    Settings settings = along_x();
    settings.design.tolerance_mm = tolerance;
    // An arch whose rise waves along the sweep.
    const auto wavy = grid_design("wavy", 120, 60, [](double u, double v) {
      const double rise = 60 + 8 * std::sin(9 * u), across = 2 * v - 1;
      return Eigen::Vector3d(600 * u, 300 * v, rise * (1 - across * across));
    });
    const PlanResult result = plan(wavy, settings, {});
    EXPECT_EQ(result.program.verification.status, VerificationStatus::kPassed) << tolerance;
    EXPECT_LE(result.verification.deviation.max, tolerance);
    std::size_t ribs = 0;
    for (const StripFacts& strip : result.strips) ribs += strip.ribs;
    EXPECT_GE(ribs, before);
    before = ribs;
  }
  EXPECT_GT(before, 5u);
}

TEST(Plan, RanksTheSamePlanesInATurnedDesign) {
  Settings settings;
  settings.design.units = "mm";
  settings.design.keep = Keep::kBack;
  Eigen::Isometry3d turn = Eigen::Isometry3d::Identity();
  turn.rotate(Eigen::AngleAxisd(0.8, Eigen::Vector3d(0.3, -1, 0.4).normalized()));
  turn.translation() = Eigen::Vector3d(5000, -300, 70);
  const auto arch = [](const Eigen::Isometry3d& placed) {
    return grid_design("arch", 40, 30, [&](double u, double v) -> Eigen::Vector3d {
      const double y = 500 * (v - 0.5);
      return placed * Eigen::Vector3d(800 * u, y, (100 + 20 * u) * (1 - y * y / 90000));
    });
  };
  const PlanResult here = plan(arch(Eigen::Isometry3d::Identity()), settings, {}),
                   there = plan(arch(turn), settings, {});
  EXPECT_EQ(here.program.verification.status, VerificationStatus::kPassed);
  EXPECT_EQ(here.strips.size(), there.strips.size());
  // Of planes that fit alike, thinned samples decide, which lie on other cells here and there.
  EXPECT_NEAR(here.verification.deviation.max, there.verification.deviation.max, 0.1);
  ASSERT_EQ(here.ranking.size(), there.ranking.size());
  // A sample at the edge of a cell falls to either side by rounding.
  for (std::size_t i = 0; i < here.ranking.size(); ++i)
    EXPECT_NEAR(here.ranking[i].missed_mm, there.ranking[i].missed_mm,
                1e-2 * (1 + here.ranking[i].missed_mm));
}

TEST(Plan, RefusesADesignThatBendsMoreSharplyThanTheBlade) {
  const auto pipe = grid_design("pipe", 4, 60, [](double u, double v) {
    const double phi = 2.0 * (v - 0.5);
    return Eigen::Vector3d(300 * u, 50 * std::sin(phi), 50 * std::cos(phi));
  });
  const PlanResult result = plan(pipe, along_x(), {});
  EXPECT_EQ(result.program.verification.status, VerificationStatus::kRefused);
  ASSERT_FALSE(result.refusals.empty());
  const std::string message = describe(result.refusals.front());
  EXPECT_NE(message.find("radius of a rib"), std::string::npos) << message;
  EXPECT_NEAR(result.refusals.front().value, 50.5, 2);
  EXPECT_NEAR(result.refusals.front().bound, 70.5, 0.1);
}

TEST(Plan, RefusesABladeThatReachesOverNoPartByItsReach) {
  const auto arch = grid_design("arch", 12, 12, [](double u, double v) {
    return Eigen::Vector3d(900 * u, 600 * v, 30 * std::sin(3 * u));
  });
  Settings settings = along_x();
  settings.blade.free_lengths_mm = {112};
  const PlanResult result = plan(arch, settings, {});
  ASSERT_FALSE(result.refusals.empty());
  EXPECT_EQ(result.refusals.front().limit, Limit::kRibLength) << describe(result.refusals.front());
  EXPECT_NEAR(result.refusals.front().bound, 6, 1);
}

TEST(Plan, RefusesMoreStripsThanAreEverPlanned) {
  const auto arch = grid_design("shallow arch", 30, 24, [](double u, double v) {
    return Eigen::Vector3d(9000 * u, 6000 * v, 60 * std::sin(3 * u));
  });
  Settings settings = along_x();
  settings.blade.free_lengths_mm = {124};
  const PlanResult result = plan(arch, settings, {});
  ASSERT_EQ(result.refusals.size(), 1U);
  EXPECT_EQ(result.refusals.front().limit, Limit::kStrips) << describe(result.refusals.front());
  EXPECT_GT(result.refusals.front().value, result.refusals.front().bound);
}

// A bump that no blade forms, away from the middle: it is where a picture puts its ring.
// A torus leans to no side as a whole.
TEST(Plan, SaysOfAClosedDesignThatOneSideIsCut) {
  const auto torus = [](double u, double v) {
    const double a = 2 * std::numbers::pi * u, b = 2 * std::numbers::pi * v, out = 300 + 80 * std::cos(b);
    return Eigen::Vector3d(out * std::cos(a), out * std::sin(a), 80 * std::sin(b));
  };
  surface::DesignSurface design = grid_design("torus", 48, 24, torus);
  Settings settings;
  settings.design.units = "mm";
  for (const bool closed : {false, true}) {
    design.health.closed = closed;
    const PlanResult refused = plan(design, settings, {});
    ASSERT_EQ(refused.refusals.size(), 1U);
    EXPECT_EQ(refused.refusals[0].limit, Limit::kLean);
    EXPECT_EQ(describe(refused.refusals[0]).find("design.facing") != std::string::npos, closed)
        << describe(refused.refusals[0]);
  }
}

TEST(Plan, TellsWhereAPartThatHasNoStripIsFarthestFromOne) {
  const auto bump = grid_design("bump", 40, 40, [](double u, double v) {
    const double r2 = std::pow(u - 0.25, 2) + std::pow(v - 0.25, 2);
    return Eigen::Vector3d(600 * u, 500 * v, 60 * std::exp(-r2 / 0.004));
  });
  Settings settings = along_x();
  settings.fit.max_splits = 0;
  const PlanResult result = plan(bump, settings, {});
  ASSERT_FALSE(result.refusals.empty());
  const Refusal& refusal = result.refusals.front();
  ASSERT_TRUE(refusal.at) << describe(refusal);
  EXPECT_LT((refusal.at->head<2>() - Eigen::Vector2d(150, 125)).norm(), 80) << describe(refusal);
  // Where nothing is cut, as no blade is as stable, there is no budget that could be over the tolerance.
  settings.blade.min_margin = 1000;
  const PlanResult nothing = plan(bump, settings, {});
  ASSERT_FALSE(nothing.refusals.empty());
  ASSERT_EQ(nothing.verification.cut_samples, 0u);
  for (const std::string& line : nothing.warnings)
    EXPECT_EQ(line.find("error budget"), std::string::npos) << line;
}

TEST(Plan, RefusesAnUncutShareOverTheLimitByName) {
  // A floor that ends in a wall down, square to the sweep, which no rib plane meets.
  const auto step = grid_design("step", 3, 12, [](double u, double v) {
    const double x[] = {0, 200, 400, 400}, z[] = {0, 0, 0, -120};
    const auto i = static_cast<std::size_t>(std::lround(3 * u));
    return Eigen::Vector3d(x[i], 300 * v, z[i]);
  });
  const PlanResult result = plan(step, along_x(), {});
  const bool named = std::any_of(result.refusals.begin(), result.refusals.end(),
                                 [](const Refusal& r) { return r.limit == Limit::kUncutShare; });
  EXPECT_TRUE(named);
}

TEST(Plan, FindsTheSameCutInADesignTurnedUpsideDownAndKeptAbove) {
  Settings settings = along_x();
  const PlanResult below = plan(cylinder_design(), settings, {});
  settings.design.keep = Keep::kAbove;
  const auto turned = grid_design("turned", 4, 120, [](double u, double v) {
    const double phi = 0.6 * (v - 0.5);
    return Eigen::Vector3d(300 * u, 400 * std::sin(phi), -400 * std::cos(phi));
  });
  const PlanResult above = plan(turned, settings, {});
  ASSERT_EQ(above.strips.size(), below.strips.size());
  // Both lie in other cells: what the grid's quadratic patches leave differs.
  EXPECT_NEAR(above.verification.deviation.max, below.verification.deviation.max, 5e-4);
  EXPECT_NEAR(above.strips[0].smallest_margin, below.strips[0].smallest_margin, 1e-3);
  EXPECT_EQ(above.strips[0].blade_length_mm, below.strips[0].blade_length_mm);
}

TEST(Plan, WithoutPreheatStillGivesAReadableProgram) {
  Settings settings = along_x();
  settings.motion.preheat_s = 0;
  settings.motion.approach_mm = settings.motion.lead_mm = 40;
  const PlanResult result = plan(cylinder_design(), settings, {});
  EXPECT_EQ(result.program.verification.status, VerificationStatus::kPassed);
  EXPECT_NO_THROW((void)parse_program(to_json(result.program), "program.json"));
}

// Bent by 137 degrees: the clamps hang below the block's sides, and pass below it when the blade withdraws.
surface::DesignSurface half_tube() {
  return grid_design("half_tube", 8, 160, [](double u, double v) {
    const double phi = 2.4 * (v - 0.5);
    return Eigen::Vector3d(200 * u, 150 * std::sin(phi), 150 * std::cos(phi));
  });
}

TEST(Plan, TakesALeadThatKeepsTheClampsClearWhenTheBladeWithdraws) {
  Settings settings = along_x();
  const PlanResult result = plan(half_tube(), settings, {});
  for (const Refusal& r : result.refusals) ADD_FAILURE() << describe(r);
  for (const StripFacts& f : result.strips)
    EXPECT_GE(f.motion.smallest_clearance_mm, settings.stock.clearance_mm);
}

TEST(Plan, SaysWhenTheLeadGivenIsTooShortForTheClamps) {
  Settings settings = along_x();
  settings.design.tolerance_mm = 2;
  settings.motion.lead_mm = 20;
  const PlanResult result = plan(half_tube(), settings, {});
  // One strip does not get out; two, less bent, do.
  const bool said = std::any_of(result.decisions.begin(), result.decisions.end(), [](const Decision& d) {
    return d.why().find("motion.lead_mm ends nearer behind the block") != std::string::npos;
  });
  EXPECT_TRUE(said);
}

TEST(Plan, RefusesABladeWhoseDroopTakesTheTolerance) {
  // The cylinder leans along the sweep, so that sag out of the rib plane moves the surface.
  const auto leaning = grid_design("leaning", 60, 60, [](double u, double v) {
    return Eigen::Vector3d(300 * u, 1300 * (v - 0.5), 60 * u - 120 * (v - 0.5) * (v - 0.5));
  });
  Settings settings = along_x();
  settings.stock.max_size_mm = {{1500, 1500, 1500}};
  settings.blade.free_lengths_mm = {2000};
  // What of the droop is known is planned for: the rest must take the tolerance.
  settings.blade.density_kg_m3 = 40000;
  settings.fit.max_splits = 0;
  settings.design.tolerance_mm = 0.5;
  settings.machine.plinth_mm = 500;
  const PlanResult result = plan(leaning, settings, {});
  const bool named = std::any_of(result.refusals.begin(), result.refusals.end(), [](const Refusal& r) {
    return r.limit == Limit::kSag || r.limit == Limit::kDeviationWithSag;
  });
  EXPECT_TRUE(named);
  EXPECT_EQ(result.program.verification.status, VerificationStatus::kRefused);
}

TEST(Plan, RefusesASlowBladePointByName) {
  // A helicoid: the blade turns about the middle of its part in foam, which goes along at less than its ends.
  const auto helicoid = grid_design("helicoid", 60, 60, [](double u, double v) {
    const double along = 400 * (u - 0.5), across = 500 * (v - 0.5), turn = along / 600;
    return Eigen::Vector3d(along, across * std::cos(turn), across * std::sin(turn));
  });
  Settings settings = along_x();
  settings.motion.min_feed_mm_s = settings.motion.feed_mm_s;
  const PlanResult result = plan(helicoid, settings, {});
  const auto slow = std::find_if(result.refusals.begin(), result.refusals.end(),
                                 [](const Refusal& r) { return r.limit == Limit::kSlowestFeed; });
  ASSERT_NE(slow, result.refusals.end());
  // The blade's points at the sides of the block, 26 mm beyond the design's, go a way longer by
  // sqrt(1 + (276 / 600)^2).
  const double of_the_whole = settings.motion.feed_mm_s / std::hypot(1, 276.0 / 600);
  const auto whole = std::find_if(result.decisions.begin(), result.decisions.end(), [](const Decision& d) {
    return d.stopped_by && d.stopped_by->limit == Limit::kSlowestFeed;
  });
  ASSERT_NE(whole, result.decisions.end());
  EXPECT_NEAR(whole->stopped_by->value, of_the_whole, 0.05);
  // Parts that are narrower turn less, and come nearer: these are shown.
  EXPECT_GT(slow->value, of_the_whole);
  EXPECT_LT(slow->value, settings.motion.feed_mm_s);
}

TEST(MeshChordMm, OfACylinderIsItsSagitta) {
  const double step = 0.6 / 60;
  EXPECT_NEAR(mesh_chord_mm(cylinder_design(60).mesh, {1, 110}), 400 * (1 - std::cos(step / 2)),
              0.2 * 400 * step * step / 8);
}

TEST(ReportJson, SaysTheVerdictTheBudgetAndWhatWasNotChecked) {
  const PlanResult result = plan(cylinder_design(), along_x(), {});
  const auto report = nlohmann::json::parse(report_json(result));
  EXPECT_EQ(report["status"], "passed");
  EXPECT_EQ(report["strips"].size(), result.strips.size());
  EXPECT_GT(report["not_checked"].size(), 3u);
  EXPECT_GT(report["budget_mm"].size(), 4u);
  EXPECT_EQ(report["directions"].size(), 1u);
}

}  // namespace
}  // namespace hotblade::pipeline

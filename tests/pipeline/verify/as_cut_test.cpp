#include "pipeline/verify/as_cut.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "pipeline/plan/plan.hpp"
#include "pipeline/run/dryrun.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/verify/budget.hpp"
#include "tests/pipeline/executed.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

using testing::Executed;

const Program& cylinder_program() {
  static const Program program = plan(cylinder_design(), along_x(), {}).program;
  return program;
}

const Executed& cylinder() {
  static const Executed executed(cylinder_program());
  return executed;
}

AsCutReport measured(const Executed& run, const std::vector<ExecutedStrip>& strips) {
  return as_cut(run.work.program, strips, cylinder_design(), {});
}

TEST(AsCut, IsThePlannedSurfaceToTheRegistersRounding) {
  const auto strips = read_executed(cylinder().work, cylinder().log);
  ASSERT_EQ(strips.size(), 1u);
  EXPECT_NEAR(strips[0].executed_s, cylinder_program().strips[0].poses.back().t, 0.011);
  const AsCutReport report = measured(cylinder(), strips);
  EXPECT_TRUE(report.cut.within_tolerance);
  EXPECT_NEAR(report.cut.deviation.max, cylinder_program().verification.deviation_mm.max, 0.02);
  EXPECT_LT(report.shape_mismatch_mm, 1e-3 + 0.01)
      << "rounding, five times as much at the belly of a shallow arc";
  EXPECT_EQ(report.cut.gouge_mm, 0);
  EXPECT_GT(report.touch_samples, 100u) << "lead-in, lead-out and the blade's ends lie in the block's border";
  EXPECT_EQ(report.strip, "S001");
}

TEST(AsCut, TheBudgetIsNoLessThanTheWhole) {
  const AsCutReport report = measured(cylinder(), read_executed(cylinder().work, cylinder().log));
  EXPECT_GE(report.budget_sum_mm(), report.cut.deviation.max);
  EXPECT_TRUE(report.not_in_budget.empty());
  // What was cut is as far off as planned, and with what no log tells as the plan's budget says, which has
  // lines for what was measured now.
  const double planned_mm = budget_sum_mm(cylinder_program().verification.budget_mm);
  EXPECT_LT(report.in_cell_mm(), planned_mm + 0.005);
  EXPECT_GT(report.in_cell_mm(), planned_mm - 0.06);
  EXPECT_EQ(report.budget_mm.size(), 11u);
  for (const auto& [name, mm] : report.budget_mm) EXPECT_TRUE(mm >= 0 && mm < 1) << name << " " << mm;
}

// The clamps of a cell are off by what its settings say, and its blades are longer.
Settings off_settings() {
  Settings settings = along_x();
  settings.machine.clamps = {{{0.8, -0.5, 0.6}, {0.004, -0.003, 0.005}},
                             {{-0.4, 0.7, 0.3}, {0.002, 0.006, -0.004}}};
  settings.blade.length_error_mm = 1.3;
  return settings;
}

TEST(AsCut, ClampsThatAreKnownToBeOffAreToldOtherwiseAndCutTheSame) {
  const Program program = plan(cylinder_design(), off_settings(), {}).program;
  ASSERT_EQ(program.verification.status, VerificationStatus::kPassed);
  EXPECT_EQ(program.settings.blade.length_error_mm, 1.3);
  EXPECT_EQ(program.settings.blade.free_lengths_mm, along_x().blade.free_lengths_mm);
  const Strip &off = program.strips[0], &plain = cylinder_program().strips[0];
  EXPECT_NEAR(off.blade_length_mm, plain.blade_length_mm + 1.3, 1e-9);
  // The clamps hold the blade where it ends.
  const BladePose& pose = off.poses[off.poses.size() / 2];
  const robot::ClampPoses holding = robot::held({pose.a, pose.b}, program.settings.machine.clamps);
  EXPECT_LT((holding.a.p - pose.frame.point(pose.blade.x, pose.blade.y)).norm(), 1e-6);
  EXPECT_GT((pose.a.p - holding.a.p).norm(), 1);

  // The file comes back, the controller that knows its clamps runs it, and its log's blades cut the design.
  const Executed run(program);
  const AsCutReport report = measured(run, read_executed(run.work, run.log));
  EXPECT_TRUE(report.cut.within_tolerance);
  EXPECT_NEAR(report.cut.deviation.max, program.verification.deviation_mm.max, 0.02);
  EXPECT_LT(report.shape_mismatch_mm, 0.02);
}

TEST(AsCut, AControllerThatDoesNotKnowItsClampsRefusesThem) {
  const Program program = plan(cylinder_design(), off_settings(), {}).program;
  const testing::TemporaryDirectory directory;
  std::ofstream(directory / "program.json") << to_json(program);
  const StripJobs work = read_strip_jobs(directory / "program.json", true);
  DryRunOptions options;
  options.log_file = directory / "execution.jsonl";
  options.limits = planned_limits(work.program);
  options.blade = planned_blade(work.program);
  options.limits.clamps = options.blade.offsets = {};
  EXPECT_FALSE(dry_run(work.jobs, options).holds());
}

// Its program says what it melts at each speed.
const Program& melting_program() {
  static const Program program = [] {
    Settings settings = along_x();
    settings.blade.melt = {{{1, 2.6}, {3, 1.6}, {7, 1.0}}, 0, 0};
    return plan(cylinder_design(), settings, {}).program;
  }();
  return program;
}

TEST(AsCut, MeltsByTheSpeedsOfTheLog) {
  ASSERT_EQ(melting_program().verification.status, VerificationStatus::kPassed);
  const Executed run(melting_program());
  auto strips = read_executed(run.work, run.log);
  const auto line = [](const AsCutReport& report) {
    for (const auto& [name, mm] : report.budget_mm)
      if (name == "melt_speed") return mm;
    return -1.0;
  };
  const AsCutReport as_planned = measured(run, strips);
  EXPECT_NEAR(as_planned.cut.deviation.max, melting_program().verification.deviation_mm.max, 0.02);
  EXPECT_LT(line(as_planned), 0.02);
  EXPECT_GE(as_planned.budget_sum_mm(), as_planned.cut.deviation.max);
  // A hold of a minute in the foam, the blade where it was: the motion that goes on melts as it did.
  const auto whole = strips;
  ExecutedStrip& strip = strips[0];
  std::size_t middle = strip.poses.size() / 2;
  while (!strip.poses[middle].foam) ++middle;
  BladePose held = strip.poses[middle];
  for (std::size_t i = middle + 1; i < strip.poses.size(); ++i) strip.poses[i].t += 60;
  for (const double after : {20.0, 59.9}) {
    held.t = strip.poses[middle].t + after;
    const auto at = static_cast<std::ptrdiff_t>(middle) + (after > 20 ? 2 : 1);
    strip.poses.insert(strip.poses.begin() + at, held);
    strip.after.insert(strip.after.begin() + at, strip.after[middle]);
    strip.path_s.insert(strip.path_s.begin() + at, strip.path_s[middle]);
  }
  EXPECT_NEAR(measured(run, strips).cut.deviation.max, as_planned.cut.deviation.max, 0.01);
  // Half as fast, it melts 0.25 mm more to each side, and the budget has a line for it.
  auto slow = whole;
  for (BladePose& pose : slow[0].poses) pose.t *= 2;
  const AsCutReport slower = measured(run, slow);
  EXPECT_NEAR(slower.cut.deviation.max, as_planned.cut.deviation.max + 0.25, 0.1);
  EXPECT_NEAR(line(slower), 0.25, 0.06);
  EXPECT_GE(slower.budget_sum_mm(), slower.cut.deviation.max);
}

TEST(AsCut, AHotBladeBesideTheCutCountsOnTheKeptSideOnly) {
  for (const double depth : {3.0, -3.0}) {
    auto strips = read_executed(cylinder().work, cylinder().log);
    ExecutedStrip& strip = strips[0];
    std::size_t middle = strip.poses.size() / 2;
    while (!strip.poses[middle].foam) ++middle;
    BladePose stray = strip.poses[middle];
    stray.foam.reset();
    stray.frame.origin -= depth * stray.frame.y() * (stray.frame.y().z() > 0 ? 1 : -1);
    strip.poses.push_back(stray);
    strip.after.push_back(strip.after.back());
    strip.path_s.push_back(strip.path_s.back());
    const AsCutReport report = measured(cylinder(), strips);
    if (depth > 0) {
      EXPECT_NEAR(report.cut.gouge_mm, depth, 0.3);
      EXPECT_FALSE(report.cut.within_tolerance);
    } else {
      EXPECT_EQ(report.cut.gouge_mm, 0);
      EXPECT_TRUE(report.cut.within_tolerance);
    }
  }
}

// What an executed strip goes through between two of its poses, in its own order of time.
class Interruption {
 public:
  explicit Interruption(const ExecutedStrip& whole) : whole_(whole), t_(0) {}

  void poses(std::size_t from, std::size_t to, bool hot) {
    for (std::size_t i = from;; i += from < to ? 1 : static_cast<std::size_t>(-1)) {
      BladePose pose = whole_.poses[i];
      pose.t = t_ += 0.01;
      pose.heat = hot && pose.heat;
      if (!pose.heat) pose.foam.reset();
      out_.poses.push_back(pose);
      out_.after.push_back(whole_.after[i]);
      out_.path_s.push_back(whole_.path_s[i]);
      if (i == to) break;
    }
  }
  [[nodiscard]] const ExecutedStrip& strip() const { return out_; }

 private:
  const ExecutedStrip& whole_;
  ExecutedStrip out_;
  double t_;
};

struct Places {
  std::size_t first = 0, middle = 0, last = 0;  // hot poses in foam, and the one half-way
};
Places forming(const ExecutedStrip& strip) {
  Places places;
  while (!strip.poses[places.first].foam) ++places.first;
  places.last = strip.poses.size() - 1;
  while (!strip.poses[places.last].foam) --places.last;
  places.middle = (places.first + places.last) / 2;
  return places;
}

TEST(AsCut, FoamThatABladePassesColdIsUncut) {
  const auto whole = read_executed(cylinder().work, cylinder().log);
  const auto [first, middle, last] = forming(whole[0]);
  const std::size_t tenth = (last - first) / 10;
  const auto passed = [&](std::size_t from, std::size_t to, bool only_foam) {
    auto strips = whole;
    for (std::size_t i = from; i < to; ++i) {
      if (!only_foam) strips[0].poses[i].heat = false;
      strips[0].poses[i].foam.reset();
    }
    return measured(cylinder(), strips);
  };
  const auto expect_tenth_uncut = [](const AsCutReport& report) {
    EXPECT_FALSE(report.cut.within_tolerance);
    EXPECT_GT(report.cut.uncut_share(), 0.07);
    EXPECT_LT(report.cut.uncut_share(), 0.13);
  };
  expect_tenth_uncut(passed(middle, middle + tenth, false));
  expect_tenth_uncut(passed(middle, middle + tenth, true));
  expect_tenth_uncut(passed(first, first + tenth, false));
  // So is what a job that ends half-way does not reach.
  EXPECT_GT(passed(middle, last + 1, false).cut.uncut_share(), 0.4);
}

TEST(AsCut, ABladeThatGoesThroughItsKerfAgainCutsAsIfNothingHadBeen) {
  const auto whole = read_executed(cylinder().work, cylinder().log);
  const ExecutedStrip& strip = whole[0];
  const auto [first, middle, last] = forming(strip);
  std::size_t hot = first;
  while (strip.poses[hot - 1].heat) --hot;
  const double planned_mm = measured(cylinder(), whole).cut.deviation.max;
  // Held and gone cold, or stopped by ESTOP and cold at once, a little farther on: out of the kerf cold, hot
  // where the heat came on, in again and on.
  for (const std::size_t run_on : {std::size_t{0}, std::size_t{30}}) {
    Interruption held(strip);
    held.poses(0, middle, true);
    held.poses(middle, middle + run_on, false);
    held.poses(middle + run_on, hot, false);
    held.poses(hot, strip.poses.size() - 1, true);
    const AsCutReport report = measured(cylinder(), {held.strip()});
    EXPECT_TRUE(report.cut.within_tolerance);
    EXPECT_EQ(report.cut.uncut_mm2, measured(cylinder(), whole).cut.uncut_mm2);
    EXPECT_NEAR(report.cut.deviation.max, planned_mm, 0.005);
  }
  // Drawn out as far, but cold until it is where it was held farther on: that part stays.
  Interruption cold(strip);
  const std::size_t tenth = (last - first) / 10;
  cold.poses(0, middle, true);
  cold.poses(middle, hot, false);
  cold.poses(hot, middle + tenth, false);
  cold.poses(middle + tenth + 1, strip.poses.size() - 1, true);
  const AsCutReport report = measured(cylinder(), {cold.strip()});
  EXPECT_FALSE(report.cut.within_tolerance);
  EXPECT_GT(report.cut.uncut_share(), 0.07);
}

TEST(AsCut, IsNowhereFartherOffThanAPlanOfNearlyStraightBladesSays) {
  // Standing waves: their ribs become straight between a crest and a hollow, and a micrometre moves them by
  // tenths of a millimetre there.
  const surface::DesignSurface waves = grid_design("waves", 60, 60, [](double u, double v) {
    constexpr double kTurn = 6.283185307179586;
    return Eigen::Vector3d(700 * u, 500 * v, 9 * std::sin(kTurn * u) * std::sin(kTurn * v));
  });
  const PlanResult planned = plan(waves, back_kept(), {});
  ASSERT_TRUE(planned.refusals.empty());
  const double deviation_mm = planned.verification.deviation.max, bound_mm = planned.verification.bound_mm;
  const Executed run(planned.program);
  const AsCutReport report = as_cut(run.work.program, read_executed(run.work, run.log), waves, {});
  EXPECT_LT(report.cut.deviation.max, bound_mm);
  EXPECT_GT(report.cut.deviation.max, deviation_mm + 0.02) << "the case does not show it";
  for (const auto& [line, mm] : planned.program.verification.budget_mm) {
    if (line != "quantisation") continue;
    // Registers move the blade the most where it is not the farthest off: the bound takes both place by
    // place.
    EXPECT_LT(bound_mm, deviation_mm + mm + 0.03);
    EXPECT_GT(bound_mm, deviation_mm + 0.02);
  }
}

TEST(AsCut, AProgramMovedAwayIsOverTheTolerance) {
  Program moved = cylinder_program();
  for (BladePose& pose : moved.strips[0].poses) {
    for (Eigen::Vector3d* p : {&pose.a.p, &pose.b.p, &pose.frame.origin}) *p += Eigen::Vector3d(0, 0, 1.5);
  }
  const Executed run(moved);
  const AsCutReport report = measured(run, read_executed(run.work, run.log));
  EXPECT_FALSE(report.cut.within_tolerance);
  EXPECT_NEAR(report.cut.deviation.max, 1.5, 0.2);
}

void expect_refused(const StripJobs& work, const std::filesystem::path& log, ErrorKind kind,
                    const std::string& why) {
  try {
    (void)read_executed(work, log);
    FAIL() << why;
  } catch (const Error& error) {
    EXPECT_EQ(error.kind, kind);
    EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
  }
}

TEST(ReadExecuted, RefusesALogThatProvesSomethingElse) {
  const testing::TemporaryDirectory directory;
  StripJobs other = cylinder().work;
  other.jobs[0].id ^= 1;
  expect_refused(other, cylinder().log, ErrorKind::kBadInput, "another program");
  other = cylinder().work;
  other.jobs[0].raw[7][9] ^= 1;
  expect_refused(other, cylinder().log, ErrorKind::kBadInput, "bytes of a waypoint differ");
  expect_refused(cylinder().work, directory / "none.jsonl", ErrorKind::kFile, "cannot be read");
  const std::string whole = testing::read_bytes(cylinder().log);
  const auto cut = directory / "cut.jsonl";
  std::ofstream(cut) << whole.substr(0, whole.size() / 2);
  expect_refused(cylinder().work, cut, ErrorKind::kBadInput, "incomplete");
}

TEST(ReadExecuted, RefusesALogWithoutShapes) {
  const testing::TemporaryDirectory directory;
  std::string text = testing::read_bytes(cylinder().log);
  const auto at = text.find("\"blade\":{", text.size() / 3), end = text.find('}', at) + 1;
  text.replace(at, end - at, "\"blade\":null");
  const auto log = directory / "log.jsonl";
  std::ofstream(log) << text;
  expect_refused(cylinder().work, log, ErrorKind::kBadInput, "no blade shape");
}

TEST(AsCut, JsonHasWhatTheTextSays) {
  const AsCutReport report = measured(cylinder(), read_executed(cylinder().work, cylinder().log));
  const auto json = nlohmann::json::parse(to_json(report, {}));
  EXPECT_EQ(json["deviation_mm"]["max"].get<double>(), report.cut.deviation.max);
  EXPECT_EQ(json["deviation_mm"]["bound"].get<double>(), report.cut.bound_mm);
  EXPECT_EQ(json["deviation_mm"]["capped"], false);
  EXPECT_EQ(json["budget_mm"].size(), report.budget_mm.size());
  EXPECT_EQ(json["budget_sum_mm"].get<double>(), report.budget_sum_mm());
  EXPECT_EQ(describe(report, {}).find("as cut: deviation max >= "), std::string::npos);
  // Where the search for it ended it is that much or more.
  AsCutReport capped = report;
  capped.cut.capped = true;
  EXPECT_EQ(describe(capped, {}).find("as cut: deviation max >= "), 0u);
  EXPECT_EQ(nlohmann::json::parse(to_json(capped, {}))["deviation_mm"]["capped"], true);
}

}  // namespace
}  // namespace hotblade::pipeline

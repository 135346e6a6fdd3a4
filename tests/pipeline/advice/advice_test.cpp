// What is told to help was tried, and passed.
#include "pipeline/advice/advice.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <tuple>

#include "pipeline/advice/remedies.hpp"
#include "pipeline/plan/forecast.hpp"
#include "pipeline/program/read_design.hpp"
#include "pipeline/settings/error.hpp"
#include "tests/pipeline/plan_design.hpp"
#include "tests/pipeline/temporary_directory.hpp"

namespace hotblade::pipeline {
namespace {

using ::testing::HasSubstr;

// A vault of 240 x 120 mm in a file of its own: over z, over y, or as the top of a closed solid over z or y.
class Design {
 public:
  enum class Kind { kVault, kYUp, kSolid, kSolidYUp };
  explicit Design(Kind kind) {
    std::ofstream out(file_);
    out.precision(17);
    constexpr int kAcross = 40, kAlong = 4;
    const auto vertex = [&](double x, double y, double z) {
      if (kind == Kind::kYUp || kind == Kind::kSolidYUp) {
        out << "v " << x << " " << z << " " << -y << "\n";
      } else {
        out << "v " << x << " " << y << " " << z << "\n";
      }
    };
    const auto x_of = [](int i) { return 120.0 * i / kAlong; };
    const auto y_of = [](int j) { return 240.0 * (static_cast<double>(j) / kAcross - 0.5); };
    for (int i = 0; i <= kAlong; ++i)
      for (int j = 0; j <= kAcross; ++j)
        vertex(x_of(i), y_of(j), std::sqrt(400 * 400 - y_of(j) * y_of(j)) - 380);
    const auto top = [](int i, int j) { return i * (kAcross + 1) + j + 1; };
    for (int i = 0; i < kAlong; ++i)
      for (int j = 0; j < kAcross; ++j)
        out << "f " << top(i, j) << " " << top(i + 1, j) << " " << top(i + 1, j + 1) << " " << top(i, j + 1)
            << "\n";
    if (kind != Kind::kSolid && kind != Kind::kSolidYUp) return;
    constexpr int kBelow = (kAlong + 1) * (kAcross + 1);
    for (int i = 0; i <= kAlong; ++i)
      for (int j = 0; j <= kAcross; ++j) vertex(x_of(i), y_of(j), -50);
    const auto bottom = [&](int i, int j) { return top(i, j) + kBelow; };
    for (int i = 0; i < kAlong; ++i)
      for (int j = 0; j < kAcross; ++j)
        out << "f " << bottom(i, j) << " " << bottom(i, j + 1) << " " << bottom(i + 1, j + 1) << " "
            << bottom(i + 1, j) << "\n";
    const auto wall = [&](int i, int j, int k, int l) {
      out << "f " << top(i, j) << " " << bottom(i, j) << " " << bottom(k, l) << " " << top(k, l) << "\n";
    };
    for (int i = 0; i < kAlong; ++i) {
      wall(i, 0, i + 1, 0);
      wall(i + 1, kAcross, i, kAcross);
    }
    for (int j = 0; j < kAcross; ++j) {
      wall(0, j + 1, 0, j);
      wall(kAlong, j, kAlong, j + 1);
    }
  }

  [[nodiscard]] surface::DesignSurface read(const Settings& settings) const {
    return read_design(file_, settings.design);
  }
  [[nodiscard]] PlanResult plan_with(const Settings& settings) const {
    ++plans_;
    return plan(read(settings), settings, {});
  }
  [[nodiscard]] std::vector<TriedRemedy> advice(const PlanResult& refused, const Settings& settings) const {
    return try_changes(settings, likely_changes(refused, suggested(settings)),
                       [this](const Settings& s) { return plan_with(s); });
  }
  [[nodiscard]] std::vector<Suggestion> suggested(const Settings& settings) const {
    return forecast(read(settings), settings).suggestions;
  }
  [[nodiscard]] int plans() const { return plans_; }

 private:
  testing::TemporaryDirectory directory_;
  std::filesystem::path file_ = directory_ / "design.obj";
  mutable int plans_ = 0;
};

Settings in_mm() {
  Settings settings;
  settings.design.units = "mm";
  return settings;
}

// Resolves what was told as a user would give it, and plans with it.
PlanResult planned_as_told(const Design& design, const TriedRemedy& remedy,
                           const std::vector<std::string>& before) {
  std::vector<std::string> assignments{"design.units=mm"};
  for (const std::string& assignment : before) {
    if (remedy.without.empty() || !assignment.starts_with(remedy.without + "="))
      assignments.push_back(assignment);
  }
  assignments.insert(assignments.end(), remedy.assignments.begin(), remedy.assignments.end());
  return design.plan_with(resolve({{}, assignments, {}}));
}

TEST(Advice, IsWhatPassesWhenItIsFollowed) {
  const Design design(Design::Kind::kVault);
  Settings settings = in_mm();
  settings.slice.direction = {{1, 0, 0}};
  settings.machine.plinth_mm = 20;  // too low for the clamps
  const PlanResult refused = design.plan_with(settings);
  ASSERT_FALSE(refused.refusals.empty());
  const std::vector<TriedRemedy> told = design.advice(refused, settings);
  ASSERT_FALSE(told.empty());
  for (const TriedRemedy& remedy : told) {
    const PlanResult again =
        planned_as_told(design, remedy, {"slice.direction=[1,0,0]", "machine.plinth_mm=20"});
    EXPECT_TRUE(again.refusals.empty()) << as_options(remedy) << ": " << describe(again.refusals.front());
    EXPECT_EQ(again.program.verification.deviation_mm.max, remedy.deviation_mm) << as_options(remedy);
    EXPECT_EQ(again.strips.size(), remedy.strips);
    EXPECT_THAT(describe(remedy), HasSubstr("passes, deviation "));
  }
}

TEST(Advice, OfAClosedSolidIsToTakeItsUpperFaces) {
  const Design design(Design::Kind::kSolid);
  const Settings settings = in_mm();
  ASSERT_TRUE(design.read(settings).health.closed);
  const PlanResult refused = design.plan_with(settings);
  ASSERT_FALSE(refused.refusals.empty());
  // Its faces meet in edges, and none of them is closed itself.
  EXPECT_THAT(describe(refused.refusals.front()), HasSubstr("the design is closed"));
  const auto told = design.advice(refused, settings);
  ASSERT_FALSE(told.empty());
  EXPECT_EQ(as_options(told.front()), "--set \"design.facing=[0, 0, 1]\"");
  EXPECT_TRUE(planned_as_told(design, told.front(), {}).refusals.empty());
}

TEST(Advice, OfADesignWithYUpIsToSayIt) {
  const Design design(Design::Kind::kYUp);
  Settings settings = in_mm();
  PlanResult refused;
  refused.program.settings = settings;
  refused.refusals.push_back({"design", "", Limit::kLean, 0.9, 0.5});
  const auto told = design.advice(refused, settings);
  ASSERT_FALSE(told.empty());
  EXPECT_EQ(as_options(told.front()), "--up y");
  EXPECT_TRUE(planned_as_told(design, told.front(), {}).refusals.empty());
  // The same surface with z up is not told so.
  const Design upright(Design::Kind::kVault);
  for (const Suggestion& suggestion : upright.suggested(settings)) ADD_FAILURE() << suggestion.why;
}

TEST(Advice, OfAClosedSolidWithYUpIsToSayBoth) {
  const Design design(Design::Kind::kSolidYUp);
  const Settings settings = in_mm();
  const auto told = try_changes(settings, changes_by_shape(design.suggested(settings)),
                                [&](const Settings& s) { return design.plan_with(s); });
  ASSERT_FALSE(told.empty());
  EXPECT_EQ(as_options(told.front()), "--up y --set \"design.facing=[0, 0, 1]\"");
  EXPECT_TRUE(planned_as_told(design, told.front(), {}).refusals.empty());
}

TEST(Advice, OfADesignInAnotherUnitIsEveryUnitThatPassed) {
  const Design design(Design::Kind::kVault);
  Settings settings = in_mm();
  settings.stock.clearance_mm = settings.motion.approach_mm = 150;  // so that 240 mm are small
  const std::vector<Suggestion> suggested = design.suggested(settings);
  ASSERT_FALSE(suggested.empty());
  std::vector<std::string> tried;
  const auto told = try_changes(settings, changes_by_shape(suggested), [&](const Settings& s) {
    tried.push_back(s.design.units);
    PlanResult again;
    again.program.settings = s;
    if (s.design.units == "ft") again.refusals.push_back({"design", "", Limit::kStrips, 0, 1});
    return again;
  });
  EXPECT_THAT(tried, ::testing::Contains("cm"));
  for (const TriedRemedy& remedy : told) {
    EXPECT_THAT(as_options(remedy), ::testing::StartsWith("--units "));
    EXPECT_NE(as_options(remedy), "--units ft");
  }
  EXPECT_EQ(told.size(), tried.size() - (std::count(tried.begin(), tried.end(), "ft")));
}

// Planes that a blade cannot follow were given: the search finds others.
TEST(Advice, OfPlanesThatWereGivenIsToLeaveThemOut) {
  const Design design(Design::Kind::kVault);
  Settings settings = in_mm();
  settings.slice.direction = {{0, 0, 1}};
  const PlanResult refused = design.plan_with(settings);
  ASSERT_FALSE(refused.refusals.empty());
  const auto told = design.advice(refused, settings);
  ASSERT_FALSE(told.empty());
  EXPECT_EQ(as_options(told.front()), "without slice.direction");
  EXPECT_TRUE(planned_as_told(design, told.front(), {"slice.direction=[0,0,1]"}).refusals.empty());
}

TEST(Advice, OfASurfaceThatLeansNowhereSaysSo) {
  PlanResult refused;
  refused.program.settings = in_mm();
  refused.refusals.push_back({"design", "", Limit::kLean, 0, 0.1});
  std::vector<std::string> kept;
  for (const SettingsChange& change : likely_changes(refused, {})) {
    EXPECT_EQ(change.why, "the surface leans neither up nor down");
    kept.insert(kept.end(), change.assignments.begin(), change.assignments.end());
  }
  EXPECT_THAT(kept, ::testing::ElementsAre("design.keep=back", "design.keep=front"));
}

TEST(Advice, IsNotGivenWhereNothingPasses) {
  const Design design(Design::Kind::kVault);
  Settings settings = in_mm();
  settings.slice.direction = {{1, 0, 0}};
  settings.blade.min_margin = 1000;  // which no tolerance settles
  PlanResult refused;
  refused.program.settings = settings;
  refused.refusals.push_back({"S001", "", Limit::kDeviation, 1.2, 1});
  ASSERT_FALSE(remedies(refused).empty());
  EXPECT_TRUE(design.advice(refused, settings).empty());
  EXPECT_GE(design.plans(), 1);
  EXPECT_LE(design.plans(), kMostTrials);
}

TEST(Advice, GoesOnFromANumberThatDidNotDo) {
  const Design design(Design::Kind::kVault);
  const Settings settings = in_mm();
  PlanResult refused;
  refused.program.settings = settings;
  refused.refusals.push_back({"S001", "", Limit::kDeviation, 2.997, 1});
  refused.refusals.back().capped = true;
  EXPECT_THAT(describe(refused.refusals.back()), HasSubstr("deviation >= 2.997 mm"));
  std::vector<double> tried;
  const auto told =
      try_changes(settings, likely_changes(refused, design.suggested(settings)), [&](const Settings& s) {
        tried.push_back(s.design.tolerance_mm);
        PlanResult again;
        again.program.settings = s;
        if (s.design.tolerance_mm < 9)
          again.refusals.push_back({"S001", "", Limit::kDeviation, 9, s.design.tolerance_mm});
        return again;
      });
  // Three is where the search ended: six is tried, then what was found with it, and then a step less.
  EXPECT_THAT(tried, ::testing::ElementsAre(6, 9, 8.99));
  ASSERT_EQ(told.size(), 1u);
  EXPECT_THAT(describe(told.front()), HasSubstr("; 9 mm passes, 8.99 mm does not"));
  // A flag wins over --set: advice names the flag.
  EXPECT_EQ(as_options(told.front()), "--tolerance 9");
}

// A job that passes from some value of a setting on, and every value that was tried.
struct PassesFrom {
  double least = 0;
  std::vector<double> tried{};
  PlanResult operator()(const Settings& settings) {
    const double value = settings.design.tolerance_mm;
    tried.push_back(value);
    PlanResult again;
    again.program.settings = settings;
    if (value < least) again.refusals.push_back({"S001", "", Limit::kDeviation, 1.251, value});
    return again;
  }
};

TEST(Advice, OfANumberIsTheSmallestChangeThatPasses) {
  Settings settings = in_mm();
  PlanResult refused;
  refused.program.settings = settings;
  refused.refusals.push_back({"S001", "", Limit::kDeviation, 1.251, 1});
  PassesFrom job{1.235};
  const auto told = try_changes(settings, likely_changes(refused, {}), std::ref(job));
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(as_options(told.front()), "--tolerance 1.24");
  ASSERT_TRUE(told.front().narrowed);
  EXPECT_EQ(describe(*told.front().narrowed), "1.24 mm passes, 1.23 mm does not");
  EXPECT_THAT(describe(told.front()), HasSubstr("; 1.24 mm passes, 1.23 mm does not"));
  // Both were tried, and 30 steps lie between today's setting and the first that passed.
  EXPECT_THAT(job.tried, ::testing::IsSupersetOf({1.24, 1.23}));
  EXPECT_LE(job.tried.size(), 1u + kMostSteps);
  // Where every change passes, the last that does not is today's setting.
  PassesFrom any{1};
  EXPECT_EQ(describe(*try_changes(settings, likely_changes(refused, {}), std::ref(any)).front().narrowed),
            "1.01 mm passes, 1 mm does not");
}

// However far away the number is that the refused plan asks for: to the millimetre.
TEST(Advice, OfAPlinthIsTheSmallestFromEveryHeightThatIsTooLow) {
  for (const double refused_mm : {1.0, 20.0, 40.0, 57.0, 59.0}) {
    Settings settings = in_mm();
    settings.machine.plinth_mm = refused_mm;
    int plans = 0;
    const auto planned = [&](const Settings& s) {
      ++plans;
      PlanResult again;
      again.program.settings = s;
      // It asks for 148 mm, whatever it has.
      if (const double now = s.machine.plinth_mm; now < 60)
        again.refusals.push_back({"S001", "", Limit::kClampHeight, 40 - (148 - now), 40});
      return again;
    };
    const auto told = try_changes(settings, likely_changes(planned(settings), {}), planned);
    ASSERT_EQ(told.size(), 1u) << refused_mm;
    EXPECT_EQ(describe(*told.front().narrowed), "60 mm passes, 59 mm does not") << refused_mm;
    EXPECT_LE(plans, 2 + kMostSteps);
  }
}

TEST(Advice, TakesNoMorePlansThanItSays) {
  const Settings settings = in_mm();
  PlanResult refused;
  refused.program.settings = settings;
  for (const auto& [limit, value, bound] : {std::tuple{Limit::kDeviation, 9.7, 1.0},
                                            {Limit::kUncutShare, 9.0, 1.0},
                                            {Limit::kSlowestFeed, 0.3, 1.0},
                                            {Limit::kRibRadius, 40.0, 70.0},
                                            {Limit::kBlockEdge, 5000.0, 1200.0}})
    refused.refusals.push_back({"S001", "", limit, value, bound});
  int plans = 0;
  const auto told = try_changes(settings, likely_changes(refused, {}), [&](const Settings& s) {
    ++plans;
    PlanResult again;
    again.program.settings = s;
    return again;
  });
  EXPECT_EQ(told.size(), 5u);
  EXPECT_LE(plans, kMostPlans);
  EXPECT_GE(plans, kMostNarrowing);
}

// Of refusals of different kinds: what is told to pass does, and what is told not to does not.
TEST(Advice, OfEveryKindHoldsOnBothSides) {
  const surface::DesignSurface design = cylinder_design(24);
  const auto planned = [&](const Settings& settings) { return plan(design, settings, {}); };
  const struct {
    const char* setting;
    std::function<void(Settings&, double)> set;
    double refused;
  } kinds[] = {{"design.tolerance_mm", [](Settings& s, double x) { s.design.tolerance_mm = x; }, 0.02},
               {"machine.plinth_mm", [](Settings& s, double x) { s.machine.plinth_mm = x; }, 20},
               {"motion.min_feed_mm_s", [](Settings& s, double x) { s.motion.min_feed_mm_s = x; }, 7.5}};
  for (const auto& kind : kinds) {
    Settings settings = along_x();
    kind.set(settings, kind.refused);
    const PlanResult refused = planned(settings);
    ASSERT_FALSE(refused.refusals.empty()) << kind.setting;
    bool found = false;
    auto changes = likely_changes(refused, {});
    std::erase_if(changes,
                  [&](const SettingsChange& c) { return !c.remedy || c.remedy->setting != kind.setting; });
    for (const TriedRemedy& told : try_changes(settings, changes, planned)) {
      if (!told.narrowed) continue;
      found = true;
      Settings enough = settings, less = settings;
      kind.set(enough, told.narrowed->passes);
      EXPECT_TRUE(planned(enough).refusals.empty()) << describe(told);
      kind.set(less, told.narrowed->fails);
      EXPECT_FALSE(planned(less).refusals.empty()) << describe(told);
      // By a step: one of the third digit, or of the setting's own.
      const double step = std::abs(told.narrowed->passes - told.narrowed->fails);
      EXPECT_LE(step, std::max(0.0101 * told.narrowed->passes, 1.0) * 1.0001) << describe(told);
      ::testing::Test::RecordProperty(kind.setting, describe(told));
    }
    EXPECT_TRUE(found) << kind.setting << ": " << describe(refused.refusals.front());
  }
}

TEST(Advice, IsStoppedByTheUserWhileItNarrows) {
  const Settings settings = in_mm();
  PlanResult refused;
  refused.program.settings = settings;
  refused.refusals.push_back({"S001", "", Limit::kDeviation, 1.251, 1});
  int plans = 0;
  EXPECT_THROW((void)try_changes(settings, likely_changes(refused, {}),
                                 [&](const Settings& s) -> PlanResult {
                                   if (++plans == 3) throw Error(ErrorKind::kInterrupted, "interrupted");
                                   PlanResult again;
                                   again.program.settings = s;
                                   return again;
                                 }),
               Error);
  EXPECT_EQ(plans, 3);
}

TEST(Advice, StopsWhenTheUserDoes) {
  const Design design(Design::Kind::kVault);
  PlanResult refused;
  refused.program.settings = in_mm();
  refused.refusals.push_back({"S001", "", Limit::kDeviation, 1.2, 1});
  EXPECT_THROW((void)try_changes(in_mm(), likely_changes(refused, design.suggested(in_mm())),
                                 [](const Settings&) -> PlanResult {
                                   throw Error(ErrorKind::kInterrupted, "interrupted");
                                 }),
               Error);
}

}  // namespace
}  // namespace hotblade::pipeline

#include "pipeline/settings/settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "pipeline/settings/assignments.hpp"
#include "pipeline/settings/error.hpp"
#include "robot/blade/blade_section.hpp"

#include "tests/paths.hpp"

namespace hotblade::pipeline {
namespace {

using ::testing::HasSubstr;

// A folder of its own for every test, gone afterwards.
class SettingsFiles : public ::testing::Test {
 protected:
  SettingsFiles() {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(hotblade::testing::binary_dir()) / "tests_tmp" /
              (std::string("settings_") + info->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~SettingsFiles() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }

  std::filesystem::path folder_;
};

Settings with(const std::string& assignment) {
  return resolve({{}, {assignment}, {}});
}

// Kind and message of the error that resolving throws; fails the test when it throws none.
std::pair<ErrorKind, std::string> error_of(const SettingsSources& sources) {
  try {
    (void)resolve(sources);
  } catch (const Error& error) {
    return {error.kind, error.what()};
  }
  ADD_FAILURE() << "resolve() threw nothing";
  return {ErrorKind::kInterrupted, ""};
}

std::string usage_error(const SettingsSources& sources) {
  const auto [kind, message] = error_of(sources);
  EXPECT_EQ(kind, ErrorKind::kBadSettings) << message;
  return message;
}

std::string set_error(const std::string& assignment) {
  return usage_error({{}, {assignment}, {}});
}

TEST(Settings, DefaultsAreValidAndKeepTheBladeAboveSeventyMillimetres) {
  const Settings defaults = resolve({});
  EXPECT_NO_THROW(validate(defaults));
  const double radius = 1 / max_curvature_per_mm(defaults.blade);
  EXPECT_GT(radius, 70.0);
  EXPECT_LT(radius, 71.0);
  EXPECT_DOUBLE_EQ(radius, 1.5 * 190000 * 0.5 / (2 * 1010));
}

TEST(Settings, MaxCurvatureKeepsTheBendingStressAtYieldOverSafety) {
  BladeSettings blade;
  blade.thickness_mm = 0.8;
  blade.safety = 2;
  const double stress = blade.youngs_modulus_mpa * max_curvature_per_mm(blade) * blade.thickness_mm / 2;
  EXPECT_NEAR(stress, blade.yield_strength_mpa / blade.safety, 1e-9);
}

TEST_F(SettingsFiles, AbsentTakesBackWhatAFileSays) {
  const auto file = write("job.toml",
                          "[slice]\ndirection = [1, 0, 0]\n[stock]\nsizes_mm = [[1300, 1300, 700]]\n"
                          "[job]\nnumber = \"7\"\n");
  const Settings said =
      resolve({{file}, {"slice.direction=absent", "stock.sizes_mm=absent", "job.number=absent"}, {}});
  EXPECT_FALSE(said.slice.direction);
  EXPECT_TRUE(said.stock.sizes_mm.empty());
  EXPECT_EQ(said.job.number, "absent");  // any text is the text itself
  EXPECT_THAT(usage_error({{file}, {"design.tolerance_mm=absent"}, {}}),
              HasSubstr("design.tolerance_mm (string"));
}

TEST_F(SettingsFiles, LaterSourcesWin) {
  const auto first =
      write("a.toml", "[design]\ntolerance_mm = 2\nkeep = \"above\"\n[blade]\nkerf_mm = 1.5\n");
  const auto second = write("b.toml", "[design]\ntolerance_mm = 3.5\n");
  const Settings files = resolve({{first, second}, {}, {}});
  EXPECT_EQ(files.design.tolerance_mm, 3.5);
  EXPECT_EQ(files.design.keep, Keep::kAbove);
  EXPECT_EQ(files.blade.kerf_mm, 1.5);
  EXPECT_EQ(resolve({{second, first}, {}, {}}).design.tolerance_mm, 2);
  EXPECT_EQ(resolve({{first}, {"design.tolerance_mm=4"}, {}}).design.tolerance_mm, 4);
  const SettingsSources all{
      {first}, {"design.tolerance_mm=4"}, {{"--tolerance", "design.tolerance_mm", "5"}}};
  EXPECT_EQ(resolve(all).design.tolerance_mm, 5);
}

TEST(Settings, AssignmentsTakeTomlValuesAndBareWords) {
  EXPECT_EQ(with("design.keep=back").design.keep, Keep::kBack);
  EXPECT_EQ(with("design.keep=\"back\"").design.keep, Keep::kBack);
  EXPECT_EQ(with("blade.free_lengths_mm=[500, 700.5]").blade.free_lengths_mm,
            (std::vector<double>{500, 700.5}));
  EXPECT_EQ(with("fit.max_splits=3").fit.max_splits, 3);
  EXPECT_EQ(with("slice.direction=[0, 1, 0.5]").slice.direction, (std::array<double, 3>{0, 1, 0.5}));
  EXPECT_EQ(with("design.group=").design.group, "");
  EXPECT_EQ(with("job.author=A. Planner, Ltd").job.author, "A. Planner, Ltd") << "a text needs no quotes";
  EXPECT_EQ(with("job.author='A \\ B'").job.author, "A \\ B");
  EXPECT_EQ(with("job.number=17").job.number, "17");
  EXPECT_EQ(with("job.date=2026-11-23").job.date, "2026-11-23");
  EXPECT_EQ(with("design.group=\"roof | \u00fc\"").design.group, "roof | \u00fc");
}

TEST(Settings, MalformedAssignmentsAreUsageErrors) {
  EXPECT_THAT(set_error("nonsense"), HasSubstr("must be section.key=value"));
  EXPECT_THAT(set_error("kerf_mm=1"), HasSubstr("did you mean blade.kerf_mm?"));
  EXPECT_THAT(set_error("slice.direction=[0, 1"), HasSubstr("no TOML value"));
  EXPECT_THAT(set_error("blade.safety=2\nextra = 1"), HasSubstr("more than one"));
}

TEST_F(SettingsFiles, UnknownKeysNameThePlaceAndTheNearestKey) {
  const auto file = write("job.toml", "[blade]\nsafety = 2\n\nkerf_m = 1\n");
  EXPECT_EQ(usage_error({{file}, {}, {}}),
            file.string() + ":4: blade.kerf_m: unknown key: did you mean blade.kerf_mm?");
  const auto section = write("section.toml", "\n[blad]\nsafety = 2\n");
  EXPECT_EQ(usage_error({{section}, {}, {}}),
            section.string() + ":2: [blad]: unknown section: did you mean [blade]?");
  const auto top = write("top.toml", "tolerance_mm = 1\n");
  EXPECT_THAT(usage_error({{top}, {}, {}}),
              HasSubstr("top.toml:1: tolerance_mm: a key outside a section: did you mean "
                        "design.tolerance_mm?"));
  EXPECT_THAT(set_error("stock.kerf_mm=1"), HasSubstr("did you mean blade.kerf_mm?"));
  EXPECT_THAT(set_error("blade.wobble=1"), HasSubstr("`hotblade config defaults` lists every key"));
}

TEST_F(SettingsFiles, BrokenFilesNameTheLine) {
  const auto syntax = write("syntax.toml", "[blade]\nsafety = = 2\n");
  EXPECT_THAT(usage_error({{syntax}, {}, {}}), HasSubstr("syntax.toml:2: "));
  const auto twice = write("twice.toml", "[blade]\nsafety = 2\nsafety = 3\n");
  EXPECT_THAT(usage_error({{twice}, {}, {}}), HasSubstr("twice.toml:3: "));
  const auto encoding = write("encoding.toml", "[blade]\n# \xff\xfe\n");
  EXPECT_THAT(usage_error({{encoding}, {}, {}}), HasSubstr("encoding.toml:2: "));
  const auto text = write("text.toml", "[job]\n\nauthor = \"A. \xff\"\n");
  EXPECT_THAT(usage_error({{text}, {}, {}}), HasSubstr("text.toml:3: "));
}

// A device has no end.
TEST_F(SettingsFiles, AreReadToALimit) {
  EXPECT_THAT(usage_error({{"/dev/zero"}, {}, {}}), HasSubstr("/dev/zero: longer than 4000000 bytes"));
  EXPECT_NO_THROW((void)resolve({{write("long.toml", std::string(4'000'000, '\n'))}, {}, {}}));
  EXPECT_THAT(usage_error({{write("longer.toml", std::string(4'000'001, '\n'))}, {}, {}}),
              HasSubstr("longer.toml: longer than 4000000 bytes"));
}

TEST_F(SettingsFiles, UnreadableFilesAreFileErrors) {
  EXPECT_EQ(error_of({{folder_ / "missing.toml"}, {}, {}}).first, ErrorKind::kFile);
  EXPECT_EQ(error_of({{folder_}, {}, {}}).first, ErrorKind::kFile);
  EXPECT_EQ(to_toml(resolve({{write("empty.toml", "")}, {}, {}})), to_toml(Settings{}));
}

TEST(Settings, TextsThatAreNoUtf8AreRefused) {
  EXPECT_EQ(set_error("job.author=M\xfcller"),
            "--set: job.author (M\ufffdller) is no UTF-8: write it as UTF-8");
  EXPECT_THAT(set_error("design.group=\"\xff\""), HasSubstr("is no UTF-8"));
  EXPECT_EQ(with("job.author=M\u00fcller").job.author, "M\u00fcller");
}

TEST(Settings, WholeNumbersBeyond64BitsAreOutOfRange) {
  const std::string digits = "10000000000000000000";
  EXPECT_EQ(set_error("design.tolerance_mm=" + digits),
            "--set: design.tolerance_mm (1e+19, must be 0.01 to 100)");
  EXPECT_THAT(set_error("design.tolerance_mm=-" + digits), HasSubstr("(-1e+19, must be 0.01 to 100)"));
  EXPECT_THAT(set_error("design.tolerance_mm=1" + std::string(400, '0')), HasSubstr("(inf, must be"));
  EXPECT_THAT(set_error("fit.max_splits=" + digits), HasSubstr("fit.max_splits (2.147483647e+09, must be"));
  EXPECT_EQ(with("job.number=" + digits).job.number, digits);
}

TEST(Settings, WhatWasSaidIsKnownWhateverItIs) {
  const auto said = [](std::vector<SettingsFlag> flags) {
    return resolve_said({{}, {}, std::move(flags)}).said;
  };
  EXPECT_TRUE(resolve_said({}).said.empty());
  EXPECT_EQ(said({{"a", "design.up", "z"}}), std::set<std::string>{"design.up"});
  EXPECT_TRUE(said({{"a", "design.up", "y"}, {"b", "design.up", "z", false}}).empty());
  EXPECT_EQ(with_flags(SaidSettings{}, {{"a", "design.facing", kAbsent}}).said,
            std::set<std::string>{"design.facing"});
}

TEST(Settings, WrongTypesAreRefused) {
  EXPECT_EQ(set_error("blade.kerf_mm=wide"), "--set: blade.kerf_mm (string, must be a number)");
  EXPECT_THAT(set_error("fit.max_splits=2.5"), HasSubstr("must be a whole number"));
  EXPECT_THAT(set_error("design.keep=1"), HasSubstr("must be a string"));
  EXPECT_THAT(set_error("blade.free_lengths_mm=400"), HasSubstr("must be a list of numbers"));
  EXPECT_THAT(set_error("blade.free_lengths_mm=[400, \"x\"]"), HasSubstr("must be a list of numbers"));
  EXPECT_THAT(set_error("stock.max_size_mm=[1, 2]"), HasSubstr("must be a list of 3 numbers"));
}

// Every number of every key, pushed out of its range, NaN and infinite.
TEST(Settings, EveryNumberIsCheckedForRangeAndFiniteness) {
  std::size_t checked = 0;
  for (const SettingInfo& info : describe_settings()) {
    std::string before, after;
    if (info.range.starts_with("3 numbers")) {
      before = "[200, 200, ", after = "]";
    } else if (info.range.starts_with("6 numbers")) {
      before = "[200, 200, 200, 200, 200, ", after = "]";
    } else if (info.range.starts_with("1 to 100 numbers")) {
      before = "[", after = "]";
    } else if (info.range.starts_with("1 to 100 pairs")) {
      before = "[[1, 2], [3, ", after = "]]";
    } else if (info.range.starts_with("1 to 100 triples")) {
      before = "[[100, 200, 300], [300, 200, ", after = "]]";
    } else if (info.range.find(" to ") == std::string::npos) {
      continue;
    }
    const bool whole = info.key == "fit.max_splits";
    for (const std::string value : {"1e300", "-1e300", "nan", "inf", "-inf"}) {
      const std::string bad = whole ? (value[0] == '-' ? "-9000000000" : "9000000000") : value;
      EXPECT_THAT(set_error(info.key + "=" + before + bad + after), HasSubstr(info.key + " (")) << info.key;
      ++checked;
    }
  }
  EXPECT_GE(checked, 5u * 30u);
}

TEST(Settings, PartsThatDoNotFitTogetherAreRefused) {
  EXPECT_THAT(set_error("blade.kerf_mm=0.4"), HasSubstr("must be at least blade.thickness_mm, 0.5"));
  EXPECT_THAT(set_error("blade.thickness_mm=1.2"),
              HasSubstr("blade.thickness_mm (1.2, must be at most blade.kerf_mm, 1)"));
  // The one that was given is blamed.
  EXPECT_THAT(set_error("blade.width_mm=0.3"),
              HasSubstr("--set: blade.width_mm (0.3, must be at least blade.thickness_mm, 0.5)"));
  EXPECT_THAT(set_error("motion.approach_mm=5"), HasSubstr("--set: motion.approach_mm (5, must be at least"));
  EXPECT_THAT(set_error("blade.free_lengths_mm=[600, 400]"), HasSubstr("not ascending"));
  EXPECT_THAT(set_error("blade.free_lengths_mm=[400, 400]"), HasSubstr("not ascending"));
  EXPECT_THAT(set_error("blade.free_lengths_mm=[]"), HasSubstr("0 numbers"));
  EXPECT_THAT(set_error("slice.direction=[0, 0, 0]"), HasSubstr("zero"));
  EXPECT_THAT(set_error("slice.fan_axis=[1, 2, 3, 0, 0, 0]"), HasSubstr("direction zero"));
  EXPECT_THAT(set_error("slice.fan_axis=[1, 2, 3]"), HasSubstr("3 numbers, must be a list of 6 numbers"));
  EXPECT_THAT(usage_error({{}, {"slice.direction=[1, 0, 0]", "slice.fan_axis=[0, 0, 0, 0, 0, 1]"}, {}}),
              HasSubstr("given with slice.direction"));
  EXPECT_EQ(set_error("slice.spacing_mm=0.3"),
            "--set: slice.spacing_mm (0.3, must be 0 or at least 0.5): 0 takes as few ribs as the fit does");
  EXPECT_EQ(with("slice.spacing_mm=0.5").slice.spacing_mm, 0.5);
  EXPECT_EQ(set_error("motion.jerk_mm_s3=0.001"),
            "--set: motion.jerk_mm_s3 (0.001, must be 0 or at least 1): 0 is no limit");
  EXPECT_THAT(set_error("motion.angular_jerk_rad_s3=0.001"), HasSubstr("must be 0 or at least 0.01"));
  EXPECT_EQ(set_error("stock.clearance_mm=61"),
            "--set: stock.clearance_mm (61, must be at most motion.approach_mm, 60)");
  EXPECT_THAT(set_error("motion.lead_mm=61"), HasSubstr("at most motion.approach_mm, 60"));
  EXPECT_THAT(set_error("motion.min_feed_mm_s=8"), HasSubstr("at most motion.feed_mm_s, 7"));
  EXPECT_THAT(set_error("motion.feed_mm_s=101"), HasSubstr("at most motion.travel_mm_s, 100"));
  EXPECT_THAT(usage_error({{}, {"machine.envelope_mm=[4000, 4000, 100]", "machine.plinth_mm=150"}, {}}),
              HasSubstr("machine.plinth_mm (150"));
  EXPECT_THAT(set_error("design.facing=[0, 0, 0]"), HasSubstr("leave it out to cut all faces"));
}

TEST(Settings, TheBandBySpeedIsKnownForEverySpeedOfThePlan) {
  const std::string pairs = "foam.band_mm_at_mm_s=";
  EXPECT_THAT(set_error(pairs + "1"), HasSubstr("must be a list of pairs of numbers"));
  EXPECT_THAT(set_error(pairs + "[]"), HasSubstr("must be a list of pairs of numbers"));
  EXPECT_THAT(set_error(pairs + "[[1, 2], [3]]"), HasSubstr("must be a list of pairs of numbers"));
  EXPECT_THAT(set_error(pairs + "[[1, 2], [1, 1.5], [7, 1]]"),
              HasSubstr("1.5 mm at 1 mm/s after 2 mm at 1 mm/s"));
  EXPECT_THAT(set_error(pairs + "[[1, 1], [7, 1.5]]"), HasSubstr("a faster blade melts no wider band"));
  EXPECT_THAT(set_error(pairs + "[[2, 1.5], [7, 1]]"), HasSubstr("must reach from motion.min_feed_mm_s, 1"));
  EXPECT_THAT(set_error(pairs + "[[1, 1.5], [6, 1]]"), HasSubstr("to motion.feed_mm_s, 7"));
  EXPECT_THAT(set_error(pairs + "[[1, 1.5], [7, 0.4]]"),
              HasSubstr("must be at least blade.thickness_mm, 0.5"));
  EXPECT_THAT(set_error("foam.loss_mm_s=5"), HasSubstr("it says nothing alone"));
  EXPECT_THAT(set_error("foam.melt_mm2_s=12"), HasSubstr("foam.loss_mm_s (0 with foam.melt_mm2_s)"));
  EXPECT_THAT(usage_error({{}, {pairs + "[[1, 1.5], [7, 1]]", "foam.melt_mm2_s=12", "foam.loss_mm_s=5"}, {}}),
              HasSubstr("one of both says the band"));
  const Settings good = resolve({{}, {"foam.melt_mm2_s=12", "foam.loss_mm_s=5"}, {}});
  EXPECT_DOUBLE_EQ(good.blade.band_mm(7), 1);
}

TEST(Settings, ValidateChecksSettingsMadeInCode) {
  Settings settings;
  settings.design.tolerance_mm = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(validate(settings), Error);
  settings = {};
  settings.blade.kerf_mm = 0.1;
  EXPECT_THROW(validate(settings), Error);
}

TEST(Settings, FlagsAreNamedInErrors) {
  const std::string message = usage_error({{}, {}, {{"--units", "design.units", "furlong"}}});
  EXPECT_EQ(message, "--units: design.units (\"furlong\", must be one of mm, cm, m, in, ft)");
}

TEST_F(SettingsFiles, TomlRoundTripsToTheSameBytes) {
  Settings settings;
  settings.design.units = "in";
  settings.design.tolerance_mm = 1.0 / 3.0;
  settings.slice.fan_axis = {0.1, -1.0 / 7.0, 1, 0, 2, 1e-3};
  settings.blade.free_lengths_mm = {333.3333333333333, 1000};
  settings.blade.melt.band_mm_at_mm_s = {{1, 8.0 / 3.0}, {7, 1}};
  settings.fit.max_splits = 7;
  settings.job.number = "a\x7f\x01\"\\b";
  const std::string text = to_toml(settings);
  const Settings back = resolve({{write("out.toml", text)}, {}, {}});
  EXPECT_EQ(to_toml(back), text);
  EXPECT_EQ(to_json(back), to_json(settings));
  EXPECT_EQ(back.design.tolerance_mm, settings.design.tolerance_mm);
  EXPECT_EQ(back.slice.fan_axis, settings.slice.fan_axis);
  EXPECT_EQ(back.blade.melt, settings.blade.melt);
  EXPECT_EQ(back.job.number, settings.job.number);
}

TEST(Settings, JsonHoldsEverySectionAndKey) {
  Settings settings;
  settings.motion.jerk_mm_s3 = settings.motion.angular_jerk_rad_s3 = 1;  // left out where they are 0
  settings.blade.melt = {{{1, 2}}, 12, 5};
  settings.stock.sizes_mm = {{1200, 1200, 600}};
  settings.stock.saw_mm = 4;
  settings.blade.length_error_mm = settings.blade.stiffness_error = 0.1;
  settings.machine.clamps = {{{1, 0, 0}, {0, 0.1, 0}}, {{0, 1, 0}, {0.1, 0, 0}}};
  const auto json = to_json(settings);
  for (const SettingInfo& info : describe_settings()) {
    const auto dot = info.key.find('.');
    ASSERT_TRUE(json.contains(info.key.substr(0, dot))) << info.key;
    EXPECT_TRUE(json[info.key.substr(0, dot)].contains(info.key.substr(dot + 1))) << info.key;
  }
  EXPECT_TRUE(json["slice"]["direction"].is_null());
  EXPECT_EQ(json["blade"]["kerf_mm"], 1.0);
}

std::string documented_row(const SettingInfo& info) {
  return "| `" + info.key + "` | " + info.unit + " | `" + info.default_value + "` | " + info.range + " | " +
         info.description + " |";
}

TEST(Settings, TheDocumentedTableIsTheOneTheProgramUses) {
  std::ifstream in(std::filesystem::path(hotblade::testing::source_dir()) / "docs" / "configuration.md");
  ASSERT_TRUE(in);
  std::vector<std::string> documented, expected;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("| `")) documented.push_back(line);
  }
  for (const SettingInfo& info : describe_settings()) expected.push_back(documented_row(info));
  EXPECT_THAT(documented, ::testing::ElementsAreArray(expected));
}

}  // namespace
}  // namespace hotblade::pipeline

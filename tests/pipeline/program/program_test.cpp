#include "pipeline/program/program.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <string_view>

#include "pipeline/program/atomic_file.hpp"
#include "pipeline/program/program_scan.hpp"
#include "pipeline/program/program_text.hpp"
#include "pipeline/settings/error.hpp"
#include "tests/pipeline/temporary_directory.hpp"
#include "tests/pipeline/vault_program.hpp"

namespace hotblade::pipeline {
namespace {

using Json = nlohmann::ordered_json;
using ::testing::HasSubstr;
using testing::TemporaryDirectory;
using testing::vault_program;

Json good() {
  return Json::parse(to_json(vault_program({.strips = 2})));
}

// The message parse_program refuses the text with.
std::string refusal(const std::string& text) {
  try {
    static_cast<void>(parse_program(text, "job.json"));
  } catch (const Error& error) {
    EXPECT_EQ(error.kind, ErrorKind::kBadInput);
    return error.what();
  }
  ADD_FAILURE() << "accepted";
  return "";
}

TEST(ProgramVersion, OneIsReadAndWrittenAgainAsItWas) {
  Program program = vault_program();
  program.design.format.reset();
  const std::string text = to_json(program);
  const Json json = Json::parse(text);
  EXPECT_EQ(json["version"], 1);
  EXPECT_FALSE(json["design"].contains("format"));
  EXPECT_EQ(to_json(parse_program(text, "job.json")), text);
}

TEST(ProgramVersion, TwoSaysWhatTheDesignWasReadAs) {
  Program program = vault_program();
  program.design.format = surface::FileFormat::kGltf;
  const std::string text = to_json(program);
  const Json json = Json::parse(text);
  EXPECT_EQ(json["version"], 2);
  EXPECT_EQ(json["design"]["format"], "gltf");
  EXPECT_EQ(parse_program(text, "job.json").design.format, surface::FileFormat::kGltf);
}

struct Breakage {
  const char* name;
  std::function<void(Json&)> break_it;
  const char* message;  // what the refusal contains
};

void PrintTo(const Breakage& breakage, std::ostream* out) {
  *out << breakage.name;
}

class ParseProgram : public ::testing::TestWithParam<Breakage> {};

TEST_P(ParseProgram, RefusesWithThePlaceOf) {
  Json json = good();
  GetParam().break_it(json);
  EXPECT_THAT(refusal(json.dump()),
              ::testing::AllOf(::testing::StartsWith("job.json: "), HasSubstr(GetParam().message)));
}

Json& pose(Json& json) {
  return json["strips"][1]["poses"][17];
}
Json& rib(Json& json) {
  return json["strips"][0]["ribs"][2];
}

INSTANTIATE_TEST_SUITE_P(
    Header, ParseProgram,
    ::testing::Values(
        Breakage{"AnotherFormat", [](Json& j) { j["format"] = "gcode"; }, "format: is not a cut program"},
        Breakage{"AnotherVersion", [](Json& j) { j["version"] = 3; }, "version: unknown version (3, 1 or 2)"},
        Breakage{"VersionOfOtherKeys", [](Json& j) { j["version"] = 1; }, "unknown key \"format\""},
        Breakage{"NoFormatOfTheDesign", [](Json& j) { j["design"].erase("format"); },
                 "\"format\" is missing"},
        Breakage{"UnknownFormatOfTheDesign", [](Json& j) { j["design"]["format"] = "step"; },
                 "design.format: unknown"},
        Breakage{"MissingKey", [](Json& j) { j.erase("overrides"); }, "\"overrides\" is missing"},
        Breakage{"UnknownKey", [](Json& j) { j["note"] = 1; }, "unknown key \"note\""},
        Breakage{"PathForBaseName", [](Json& j) { j["design"]["file"] = "a/b.obj"; },
                 "design.file: is not a base"},
        Breakage{"ShortHash", [](Json& j) { j["design"]["sha256"] = "abc"; },
                 "design.sha256: is not a SHA-256"},
        Breakage{"UnknownUnit", [](Json& j) { j["design"]["source_units"] = "ell"; },
                 "design.source_units: unknown"},
        Breakage{"ZeroScale", [](Json& j) { j["design"]["scale_to_mm"] = 0; },
                 "design.scale_to_mm: out of range"},
        Breakage{"UnknownKeep", [](Json& j) { j["design"]["keep"] = "left"; }, "design.keep: unknown word"},
        Breakage{"FractionOfAVertex", [](Json& j) { j["design"]["vertices"] = 1.5; },
                 "design.vertices: is not a"},
        Breakage{"NegativeFaces", [](Json& j) { j["design"]["faces"] = -1; }, "design.faces: is not a whole"},
        Breakage{"InsideOutBox", [](Json& j) { j["design"]["bbox_mm"][0][0] = 1e9; },
                 "design.bbox_mm: the first"},
        Breakage{"ThreeCornersOfABox",
                 [](Json& j) {
                   j["design"]["bbox_mm"].push_back({0, 0, 0});
                 },
                 "(3, exactly 2)"},
        Breakage{"SettingsNotAnObject", [](Json& j) { j["settings"] = "x"; }, "settings: is not an object"},
        Breakage{"UnknownSection", [](Json& j) { j["settings"]["laser"] = Json::object(); },
                 "settings.laser: unknown section of settings: use the hotblade that wrote it"},
        Breakage{"SectionNotAnObject", [](Json& j) { j["settings"]["fit"] = 1; },
                 "settings.fit: is not an object"},
        Breakage{"UnknownSetting", [](Json& j) { j["settings"]["blade"]["colour"] = 1; },
                 "settings.blade.colour: unknown setting: use the hotblade that wrote it"},
        Breakage{"SettingOfAnotherType", [](Json& j) { j["settings"]["motion"]["feed_mm_s"] = "fast"; },
                 "settings.motion.feed_mm_s: is not a number"},
        Breakage{"SettingOutOfRange", [](Json& j) { j["settings"]["machine"]["clamp_error_mm"] = 11; },
                 "settings.machine.clamp_error_mm: out of range (11"},
        Breakage{"SettingOfAnUnknownWord", [](Json& j) { j["settings"]["slice"]["gaps"] = "jump"; },
                 "settings.slice.gaps: unknown word (\"jump\""},
        Breakage{"TwoNumbersOfThree",
                 [](Json& j) {
                   j["settings"]["stock"]["max_size_mm"] = {100, 100};
                 },
                 "settings.stock.max_size_mm: "},
        Breakage{"HalfASplit", [](Json& j) { j["settings"]["fit"]["max_splits"] = 0.5; },
                 "settings.fit.max_splits: is not a whole"},
        Breakage{"TooManySplits", [](Json& j) { j["settings"]["fit"]["max_splits"] = 1001; },
                 "settings.fit.max_splits: out of range (1001"},
        Breakage{"SettingsThatDoNotGoTogether", [](Json& j) { j["settings"]["blade"]["kerf_mm"] = 0.1; },
                 "settings: do not go together: settings: blade.thickness_mm (0.5, must be at most "
                 "blade.kerf_mm, 0.1)"},
        Breakage{"NoBladeLengths", [](Json& j) { j["blade"]["free_lengths_mm"] = Json::array(); },
                 "(0, at least 1)"},
        Breakage{"FallingBladeLengths", [](Json& j) { j["blade"]["free_lengths_mm"][2] = 600; },
                 "blade.free_lengths_mm[2]: is not above the one before (600, above 600)"},
        Breakage{"BandsThatRise",
                 [](Json& j) {
                   j["blade"]["band_mm_at_mm_s"] = {{1, 1.5}, {7, 2}};
                 },
                 "blade.band_mm_at_mm_s[1]: speeds rise from pair to pair, and bands do not"},
        Breakage{"MeltWithoutLoss", [](Json& j) { j["blade"]["melt_mm2_s"] = 12; },
                 "blade: \"loss_mm_s\" is missing"},
        Breakage{"NegativeThickness", [](Json& j) { j["blade"]["thickness_mm"] = -0.5; },
                 "blade.thickness_mm: out of range (-0.5, above 0)"},
        Breakage{"NoStrips", [](Json& j) { j["strips"] = Json::array(); }, "strips: wrong number of items"}),
    [](const auto& test) { return test.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Strip, ParseProgram,
    ::testing::Values(Breakage{"RepeatedStripId", [](Json& j) { j["strips"][1]["id"] = "S001"; },
                               "strips[1].id: stands twice (S001)"},
                      Breakage{"RepeatedRibId", [](Json& j) { rib(j)["id"] = "S001R001"; },
                               "strips[0].ribs[2].id: stands twice"},
                      Breakage{"BladeNotInTheList", [](Json& j) { j["strips"][0]["blade_length_mm"] = 601; },
                               "strips[0].blade_length_mm: no such blade (601, one of 400, 600, 800)"},
                      Breakage{"FlatStock", [](Json& j) { j["strips"][0]["stock"]["size_mm"][2] = 0; },
                               "strips[0].stock.size_mm[2]: out of range (0, above 0)"},
                      Breakage{"LongAxis",
                               [](Json& j) {
                                 rib(j)["frame"]["x"] = {1.001, 0, 0};
                               },
                               "strips[0].ribs[2].frame.x: is not of length 1"},
                      Breakage{"SkewAxes",
                               [](Json& j) {
                                 rib(j)["frame"]["y"] = {0.6, 0, 0.8};
                               },
                               "strips[0].ribs[2].frame: x and y are not square"},
                      Breakage{"OnePointTarget",
                               [](Json& j) {
                                 rib(j)["target"] = {{0, 0}};
                               },
                               "ribs[2].target: wrong number"},
                      Breakage{"ThreePointBezier", [](Json& j) { rib(j)["bezier"].erase(3); },
                               "ribs[2].bezier: wrong number of items (3"},
                      Breakage{"PointInSpace", [](Json& j) { rib(j)["bezier"][1].push_back(0); },
                               "bezier[1]: wrong number of items (3"},
                      Breakage{"NegativeHausdorff", [](Json& j) { rib(j)["hausdorff_mm"] = -1; },
                               "hausdorff_mm: out of range"},
                      Breakage{"EmptyElastica", [](Json& j) { rib(j)["elastica"]["length"] = 0; },
                               "elastica.length: out of range"},
                      Breakage{"NoRibs", [](Json& j) { j["strips"][0]["ribs"] = Json::array(); },
                               "strips[0].ribs: wrong number"}),
    [](const auto& test) { return test.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Pose, ParseProgram,
    ::testing::Values(
        Breakage{"RepeatedTime", [](Json& j) { pose(j)["t"] = j["strips"][1]["poses"][16]["t"]; },
                 "strips[1].poses[17].t: is not a microsecond after the pose before (0.8 s, above 0.8)"},
        Breakage{"NegativeTime", [](Json& j) { j["strips"][1]["poses"][0]["t"] = -0.1; },
                 "poses[0].t: out of range"},
        Breakage{"TimeBeyondTheController", [](Json& j) { j["strips"][1]["poses"][39]["t"] = 4295; },
                 "poses[39].t: out of range (4295, 0 to 4294.967295)"},
        Breakage{"TextForTime", [](Json& j) { pose(j)["t"] = "1"; }, "poses[17].t: is not a number (\"1\")"},
        Breakage{"NullForANumber", [](Json& j) { pose(j)["blade"]["kappa"] = nullptr; },
                 "blade.kappa: is not a number"},
        Breakage{"UnknownPhase", [](Json& j) { pose(j)["phase"] = "dance"; },
                 "poses[17].phase: unknown word (\"dance\""},
        Breakage{"HeatAsANumber", [](Json& j) { pose(j)["heat"] = 1; },
                 "poses[17].heat: is not true or false"},
        Breakage{"LongQuaternion",
                 [](Json& j) {
                   pose(j)["a"]["q"] = {1, 0, 0, 0.01};
                 },
                 "poses[17].a.q: is not of length 1"},
        Breakage{"ShortQuaternion", [](Json& j) { pose(j)["b"]["q"].erase(3); },
                 "poses[17].b.q: wrong number of items (3"},
        Breakage{"ClampsApart", [](Json& j) { pose(j)["a"]["p"][0] = -5000; },
                 "poses[17]: clamps a and b are farther"},
        Breakage{"AnotherBladeLength", [](Json& j) { pose(j)["blade"]["length"] = 599; },
                 "poses[17].blade: length is not the strip's blade length (599, 600)"},
        Breakage{"FoamBeyondTheBlade", [](Json& j) { pose(j)["foam"][1] = 700; },
                 "poses[17].foam[1]: out of range"},
        Breakage{"FoamBackwards",
                 [](Json& j) {
                   pose(j)["foam"] = {300, 200};
                 },
                 "poses[17].foam: ends before it starts"},
        Breakage{"NegativeMargin", [](Json& j) { pose(j)["margin_mm"] = -1; },
                 "poses[17].margin_mm: out of range"},
        Breakage{"RibThatIsNotThere", [](Json& j) { pose(j)["rib"] = 6; },
                 "poses[17].rib: no such rib (6, the strip has 6)"},
        Breakage{"OnePose", [](Json& j) { j["strips"][0]["poses"] = {j["strips"][0]["poses"][0]}; },
                 "(1, at least 2)"}),
    [](const auto& test) { return test.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Verification, ParseProgram,
    ::testing::Values(
        Breakage{"UnknownStatus", [](Json& j) { j["verification"]["status"] = "fine"; },
                 "verification.status: unknown"},
        Breakage{"ZeroTolerance", [](Json& j) { j["verification"]["tolerance_mm"] = 0; },
                 "tolerance_mm: out of range"},
        Breakage{"PercentileAboveMax", [](Json& j) { j["verification"]["deviation_mm"]["p99"] = 9; },
                 "p99: out of range"},
        Breakage{"BudgetAsArray", [](Json& j) { j["verification"]["budget_mm"] = Json::array(); },
                 "budget_mm: is not an"},
        Breakage{"NegativeBudget", [](Json& j) { j["verification"]["budget_mm"]["mesh"] = -1; },
                 "budget_mm.mesh: out of"},
        Breakage{"OverrideAsNumber", [](Json& j) { j["overrides"] = {1}; }, "overrides[0]: is not a string"}),
    [](const auto& test) { return test.param.name; });

TEST(ProgramText, ComesInPiecesThatMakeTheWhole) {
  const Program program = vault_program({.strips = 3});
  const ProgramFrame frame = program_frame(program);
  std::string text = frame.before;
  for (const Strip& strip : program.strips)
    text += (&strip == &program.strips.front() ? "" : ",\n") + to_json(strip);
  EXPECT_EQ(text + frame.after, to_json(program));
}

TEST(ParseProgramInAnyOrder, TakesStripsThatStandBeforeTheBlade) {
  Json json = good();
  Json turned;
  for (const char* key : {"strips", "verification", "overrides", "format", "blade", "version", "settings",
                          "created_by", "design"}) {
    turned[key] = json[key];
  }
  EXPECT_EQ(to_json(parse_program(turned.dump(), "job.json")),
            to_json(parse_program(json.dump(), "job.json")));
}

TEST(ParseProgramInAnyOrder, NamesThePlaceInALaterStripWhereverTheBladeStands) {
  Json json = good();
  json["strips"][1]["poses"][17]["t"] = "late";
  Json turned;
  for (const auto& [key, value] : json.items()) {
    if (key != "blade") turned[key] = value;
  }
  turned["blade"] = json["blade"];
  for (const Json& text : {json, turned})
    EXPECT_THAT(refusal(text.dump()), HasSubstr("strips[1].poses[17].t: is not a number"));
}

TEST(ParseProgramText, NamesTheLineOfASyntaxError) {
  std::string text = to_json(vault_program());
  const std::size_t third_line = text.find("\"created_by\"");
  text.insert(third_line, "oops ");
  EXPECT_THAT(refusal(text), ::testing::StartsWith("job.json:3: not JSON: "));
}

TEST(ParseProgramText, RefusesEmptyTextTrailingTextNanAndHugeNumbers) {
  const std::string text = to_json(vault_program());
  EXPECT_THAT(refusal(""), HasSubstr("the file is empty"));
  EXPECT_THAT(refusal(text + "{}"), HasSubstr("not JSON"));
  for (const std::string& behind : {std::string(1, '\0'), std::string("\0garbage{{{", 12)})
    EXPECT_THAT(refusal(text + behind), HasSubstr("not JSON: a NUL byte"));
  EXPECT_THAT(refusal(text.substr(0, text.size() / 2)), HasSubstr("not JSON"));
  const auto with_tolerance = [&](const std::string& value) {
    std::string changed = text;
    const std::string was = "\"tolerance_mm\":1,";
    return changed.replace(changed.find(was), was.size(), "\"tolerance_mm\":" + value + ",");
  };
  EXPECT_THAT(refusal(with_tolerance("NaN")), HasSubstr("not JSON"));
  EXPECT_THAT(refusal(with_tolerance("1e999")), HasSubstr("too large"));
}

TEST(ParseProgramText, RefusesAKeyThatStandsTwice) {
  std::string text = to_json(vault_program());
  text.insert(text.find("\"phase\""), "\"t\":0,");
  EXPECT_THAT(refusal(text), HasSubstr("key \"t\" stands twice"));
}

// What parse_program makes of a text: the program it stands for, or the refusal.
std::string outcome(const std::string& text) {
  try {
    return to_json(parse_program(text, "job.json"));
  } catch (const Error& error) {
    return error.what();
  }
}

// The same values in another layout, which is read as a tree.
std::string relaid(std::string text) {
  constexpr std::string_view kStrips = "\n\"strips\": [\n";
  const std::size_t at = text.find(kStrips);
  return at == std::string::npos ? text : text.replace(at, kStrips.size(), "\n\"strips\":\t[\n");
}

TEST(ScanPoses, TakesWhatIsWritten) {
  const Strip strip = vault_program({.strips = 1}).strips[0];
  const std::string text = to_json(strip);
  constexpr std::string_view kPoses = "\n\"poses\":[";
  std::string_view left(text);
  left.remove_prefix(text.find(kPoses) + kPoses.size());
  const auto scanned = scan_poses(left, strip.blade_length_mm, 0, strip.ribs.size());
  ASSERT_TRUE(scanned);
  EXPECT_TRUE(scanned->joints.empty());
  EXPECT_EQ(left, "}");
  Strip read = strip;
  read.poses = scanned->poses;
  EXPECT_EQ(to_json(read), text);
}

// That a program as it was written takes the quick way shows in its time alone.
TEST(ParseProgramQuickly, ReadsWhatTheTreeReads) {
  const std::string text = to_json(vault_program({.strips = 3}));
  EXPECT_EQ(outcome(text), text);
  EXPECT_EQ(outcome(relaid(text)), text);
}

// Every change of a character in a pose, a strip's head or between strips is taken or refused as by the tree,
// with the same words, and understood alike.
TEST(ParseProgramQuickly, TakesAndRefusesWhatTheTreeDoes) {
  const std::string text = to_json(vault_program({.strips = 2}));
  std::mt19937_64 random(7);
  constexpr std::string_view kOther = "0123456789-+.eEx\"{}[],:\\ \nnu";
  std::size_t taken = 0;
  for (int trial = 0; trial < 400; ++trial) {
    std::string changed = text;
    const std::size_t at = random() % text.size();
    const char other = kOther[random() % kOther.size()];
    switch (trial % 3) {
      case 0:
        changed[at] = other;
        break;
      case 1:
        changed.erase(at, 1);
        break;
      default:
        changed.insert(at, 1, other);
    }
    const std::string by_tree = outcome(relaid(changed));
    taken += by_tree.starts_with("{") ? 1 : 0;
    EXPECT_EQ(outcome(changed), by_tree) << trial;
  }
  EXPECT_GT(taken, 50);  // digits of a number, mostly
}

TEST(ParseProgramQuickly, TakesNoNumbersThatJsonHasNot) {
  const std::string text = to_json(vault_program({.strips = 2}));
  const std::size_t poses = text.find("\"poses\""), at = text.find("\"kappa\":", poses) + 8;
  const std::size_t size = text.find(',', at) - at;
  for (const char* number :
       {"01", "-01", ".5", "-.5", "5.", "1.e3", "+1", "inf", "-inf", "nan", "0x1p-3", "1e400", "-", ""}) {
    std::string changed = text;
    EXPECT_THAT(outcome(changed.replace(at, size, number)), ::testing::StartsWith("job.json")) << number;
  }
  for (const char* number :
       {"0", "-0", "0.0", "-0.0", "5e-324", "1E+2", "1e-400", "0.1000000000000000055511151231257827"}) {
    std::string changed = text;
    changed.replace(at, size, number);
    EXPECT_EQ(outcome(changed), outcome(relaid(changed))) << number;
  }
}

TEST(ParseProgramQuickly, IsNotMisledByStripsInTheSettings) {
  const std::string text = to_json(vault_program({.strips = 1}));
  const std::size_t from = text.find("\n\"strips\""), to = text.find(",\n\"verification\"");
  const std::size_t settings = text.find("\"settings\": {") + 13;
  std::string changed = text.substr(0, settings) + text.substr(from, to - from) + text.substr(settings);
  changed.replace(changed.rfind("\n\"strips\""), to - from, "\n\"strips\": []");
  EXPECT_THAT(outcome(changed), HasSubstr("job.json"));
  EXPECT_EQ(outcome(changed), outcome(relaid(changed)));
}

TEST(ProgramJson, RoundTripsByteForByte) {
  const std::string text = to_json(vault_program({.strips = 3, .poses = 57, .bulge_mm = 1.7}));
  EXPECT_EQ(to_json(parse_program(text, "job.json")), text);
}

TEST(ProgramJson, KeepsEveryBitOfAwkwardNumbers) {
  Program program = vault_program();
  BladePose& pose = program.strips[0].poses[3];
  pose.frame.origin = {5e-324, 1.7976931348623157e308, 1.0 / 3};
  pose.margin = -12345678901234567890.0;
  const Program back = parse_program(to_json(program), "job.json");
  EXPECT_EQ(back.strips[0].poses[3].frame.origin, pose.frame.origin);
  EXPECT_EQ(back.strips[0].poses[3].margin, pose.margin);
}

TEST(ProgramJson, KeepsLoadsOfAnySize) {
  Program program = vault_program();
  constexpr auto kMost = static_cast<float>(kLargestLoad);
  constexpr float kLeast = std::numeric_limits<float>::min();
  const PoseLoads loads{0.1F, -123456, 1e-5F / 3, kMost, kLeast, 0};
  program.strips[0].poses[3].loads = loads;
  const std::string text = to_json(program);
  EXPECT_THAT(text, HasSubstr("\"loads\":{\"force_n\":0.1,\"moment_a_n_mm\":-123456,"));
  for (const std::string& way : {text, relaid(text)}) {
    const PoseLoads back = parse_program(way, "job.json").strips[0].poses[3].loads.value();
    for (const auto load : {&PoseLoads::force_n, &PoseLoads::moment_a_n_mm, &PoseLoads::moment_b_n_mm,
                            &PoseLoads::stress_mpa, &PoseLoads::droop_mm, &PoseLoads::in_plane_sag_mm})
      EXPECT_EQ(back.*load, loads.*load);
  }
  std::string larger = text;
  larger.replace(larger.find("1e+38"), 5, "2e+38");
  EXPECT_THAT(outcome(larger), HasSubstr("poses[3].loads.stress_mpa"));
  EXPECT_EQ(outcome(larger), outcome(relaid(larger)));
}

TEST(ProgramJson, RoundTripsStringsThatNeedEscapes) {
  Program program = vault_program();
  program.overrides = {"deviation 2.1 mm, \"accepted\"\nby line \t2", "gr\xc3\xbc\xc3\x9f"};
  EXPECT_EQ(parse_program(to_json(program), "job.json").overrides, program.overrides);
}

TEST(ProgramJson, WritesOneRibOrPoseALine) {
  const Program program = vault_program({.strips = 2});
  const std::string text = to_json(program);
  std::size_t pose_lines = 0, rib_lines = 0;
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; ++at) {
    pose_lines += text.compare(at + 1, 5, "{\"t\":") == 0;
    rib_lines += text.compare(at + 1, 10, "{\"id\":\"S00") == 0 && text.compare(at + 11, 2, "1R") == 0;
  }
  EXPECT_EQ(pose_lines, 80u);
  EXPECT_EQ(rib_lines, 6u);
}

TEST(ProgramJson, WritesNullForWhatIsAbsent) {
  const Json json = good();
  const Json& first = json["strips"][0]["poses"][0];
  EXPECT_TRUE(first["foam"].is_null());
  EXPECT_TRUE(first["rib"].is_null());
  EXPECT_EQ(first["margin_mm"], 12.5);
  EXPECT_TRUE(json["strips"][0]["poses"][1]["margin_mm"].is_null());
  EXPECT_EQ(json["overrides"], Json::array());
}

TEST(ProgramJson, RefusesToWriteNumbersThatAreNotFinite) {
  Program program = vault_program();
  program.strips[0].poses[0].a.p.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(static_cast<void>(to_json(program)), std::logic_error);
}

TEST(ProgramSettings, ComeBackAsTheyWereWritten) {
  Program program = vault_program();
  program.settings =
      resolve({{},
               {"design.units=ft", "design.keep=back", "design.group=roof", "design.facing=[0, 0.5, -1]",
                "slice.fan_axis=[1, 2, 3, 0, 0, 0.1]", "slice.gaps=apart", "fit.max_splits=7",
                "blade.free_lengths_mm=[410.5]", "stock.max_size_mm=[800, 900, 1000]", "motion.feed_mm_s=0.3",
                "motion.min_feed_mm_s=0.1", "machine.clamp_error_rad=1e-5"},
               {}});
  const std::string text = to_json(program);
  const Program read = parse_program(text, "job.json");
  EXPECT_EQ(to_toml(read.settings), to_toml(program.settings));
  EXPECT_EQ(to_json(read), text);
}

TEST(ProgramSettings, ThatAnOldProgramLeavesOutHaveTheirDefaults) {
  Json json = good();
  json["settings"]["design"].erase("stitch_mm");
  json["settings"]["design"]["facing_max_deg"] = 50;
  json["settings"].erase("machine");
  const Settings settings = parse_program(json.dump(), "job.json").settings;
  EXPECT_EQ(settings.design.stitch_mm, Settings{}.design.stitch_mm);
  EXPECT_EQ(settings.machine.envelope_mm, Settings{}.machine.envelope_mm);
  EXPECT_EQ(settings.design.facing_max_deg, 50);
}

TEST(ReadProgram, TellsAMissingFileFromABadOne) {
  const TemporaryDirectory directory;
  write_file_atomically(directory / "bad.json", "{}", false);
  const auto kind = [&](const std::string& name) -> std::optional<ErrorKind> {
    try {
      static_cast<void>(read_program(directory / name));
    } catch (const Error& error) {
      return error.kind;
    }
    return std::nullopt;
  };
  EXPECT_EQ(kind("missing.json"), ErrorKind::kFile);
  EXPECT_EQ(kind("."), ErrorKind::kFile);
  // A device has no end.
  EXPECT_EQ(kind("/dev/zero"), ErrorKind::kBadInput);
  EXPECT_EQ(kind("bad.json"), ErrorKind::kBadInput);
}

TEST(ReadProgram, ReadsWhatWasWritten) {
  const TemporaryDirectory directory;
  const std::string text = to_json(vault_program());
  write_file_atomically(directory / "program.json", text, false);
  EXPECT_EQ(to_json(read_program(directory / "program.json")), text);
}

// A long job must not make the commands that read it feel slow; the bound is generous for sanitizers and busy
// hosts.
TEST(ReadProgram, ReadsTwentyThousandPosesInSeconds) {
  const Program program = vault_program({.poses = 20000});
  const auto start = std::chrono::steady_clock::now();
  const std::string text = to_json(program);
  const Program back = parse_program(text, "job.json");
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  EXPECT_EQ(back.strips[0].poses.size(), 20000u);
  EXPECT_LT(taken.count(), 20);
  RecordProperty("seconds", std::to_string(taken.count()));
}

TEST(Waypoints, AreThePosesInTheCellFrameInMicroseconds) {
  Program program = vault_program();
  Strip& strip = program.strips[0];
  strip.design_to_cell = {{10, 20, 30},
                          Eigen::Quaterniond(Eigen::AngleAxisd(1.2, Eigen::Vector3d(1, 2, 3).normalized()))};
  const auto points = waypoints(strip);
  ASSERT_EQ(points.size(), strip.poses.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const BladePose& pose = strip.poses[i];
    EXPECT_EQ(points[i].t_us, 50000u * i);
    EXPECT_EQ(points[i].heat, pose.heat);
    const Eigen::Matrix3d turn = strip.design_to_cell.q.toRotationMatrix();
    const double rounding = 1e-12 * 1000;  // a few ulps of coordinates below a metre
    EXPECT_LT((points[i].a.p - (turn * pose.a.p + strip.design_to_cell.p)).norm(), rounding);
    EXPECT_LT((points[i].b.q.toRotationMatrix() - turn * pose.b.q().toRotationMatrix()).norm(), rounding);
    EXPECT_GT(points[i].b.q.coeffs().cwiseAbs().maxCoeff(), 0);
    EXPECT_EQ(points[i].b.q.coeffs().cwiseAbs().maxCoeff(), points[i].b.q.coeffs().maxCoeff());
  }
}

}  // namespace
}  // namespace hotblade::pipeline

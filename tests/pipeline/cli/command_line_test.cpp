// The program from outside: exit codes, what goes to stdout and what to stderr, and messages with a place.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/paths.hpp"
#include "tests/pipeline/run_program.hpp"

namespace hotblade::pipeline {
namespace {

using ::testing::AllOf;
using testing::Ended;
using ::testing::HasSubstr;
using testing::hotblade;
using ::testing::IsEmpty;
using ::testing::MatchesRegex;
using ::testing::Not;
using ::testing::StartsWith;
using testing::TemporaryDirectory;
using Words = std::vector<std::string>;

const std::string kVault = hotblade::testing::source_dir() + "/samples/barrel_vault.obj";
const std::string kVaultJob = hotblade::testing::source_dir() + "/samples/barrel_vault.toml";

class CommandLine : public ::testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(files_ / name, std::ios::binary) << bytes;
    return (files_ / name).string();
  }
  // Checks a file with the given bytes.
  Ended check(const std::string& name, const std::string& bytes) const {
    return hotblade({"check", write(name, bytes), "--units", "mm"});
  }
  TemporaryDirectory files_;
};

const std::string kTriangle = "v 0 0 0\nv 100 0 0\nv 0 100 0\n";

// ---- usage ----

struct Usage {
  std::string name;
  Words args;
  std::string message;
};
class WrongUsage : public ::testing::TestWithParam<Usage> {};

TEST_P(WrongUsage, ExitsWithTwoAndSaysWhatIsWrongOnStderrAlone) {
  const Ended ended = hotblade(GetParam().args);
  EXPECT_EQ(ended.code, 2);
  EXPECT_THAT(ended.err, HasSubstr(GetParam().message));
  EXPECT_THAT(ended.out, IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(
    CommandLine, WrongUsage,
    ::testing::Values(
        Usage{"no_command", {}, "no command was given: give one of check, plan, "},
        Usage{"no_curve_tool", {"curve"}, "no command was given: give one of "},
        Usage{"help_on_nothing", {"help", "pln"}, "unknown command or option: pln: did you mean plan?"},
        Usage{"help_on_no_tool", {"help", "curve", "fot"}, "did you mean fit?\n`hotblade curve --help`"},
        Usage{"nothing_near", {"nix"}, "unknown command or option: nix: give one of check, "},
        Usage{"an_update_of_what_was_asked_with_more",
              {"batch", "init", "none", "--update", "--set", "design.tolerance_mm=2"},
              "--set: without --design or --list, --update makes the batch as it was asked before: give them "
              "too, or leave --set out"},
        Usage{"misspelt_global_option", {"--vesion"}, "did you mean --version?"},
        Usage{"unknown_study", {"study", "rays"}, "rays: give one of projection, zone, quadratic, arcs"},
        Usage{"no_address", {"run", "program.json"}, "--connect HOST:PORT is missing: "},
        Usage{
            "unknown_command", {"slicing"}, "unknown command or option: slicing: give one of check, plan, "},
        Usage{"misspelt_command", {"pln"}, "unknown command or option: pln: did you mean plan?"},
        Usage{"unknown_config_command",
              {"config", "edit"},
              "unknown command or option: edit: give one of show, defaults, validate\n`hotblade config "
              "--help`"},
        Usage{"unknown_option", {"check", kVault, "--units", "mm", "--fast"}, "--fast"},
        Usage{"unknown_global_option", {"--fast"}, "unknown command or option: --fast"},
        Usage{"extra_word", {"check", kVault, "more.obj", "--units", "mm"}, "more.obj"},
        Usage{"no_design",
              {"check", "--units", "mm"},
              "design FILE is missing: The design surface: OBJ, STL, PLY, glTF or GLB"},
        Usage{"option_without_value", {"check", kVault, "--units"}, "--units"},
        Usage{
            "unknown_progress", {"check", kVault, "--progress", "loud"}, "loud not in {auto,bar,json,none}"},
        Usage{"missing_unit", {"check", kVault}, "the file carries none: say --units mm, cm, m, in or ft"},
        Usage{"unknown_unit",
              {"check", kVault, "--units", "furlong"},
              "--units: design.units (\"furlong\", must be one of mm, cm, m, in, ft)"},
        Usage{
            "unknown_up", {"check", kVault, "--units", "mm", "--up", "x"}, "--up: design.up (\"x\", must be"},
        Usage{"unknown_key", {"config", "show", "--set", "blade.kerf=1"}, "did you mean blade.kerf_mm?"},
        Usage{"jerk_below_none",
              {"config", "show", "--set", "motion.jerk_mm_s3=-1"},
              "motion.jerk_mm_s3 (-1, must be 0 to"},
        Usage{"value_not_finite",
              {"config", "show", "--set", "blade.kerf_mm=nan"},
              "blade.kerf_mm (nan, must be"}),
    [](const auto& usage) { return usage.param.name; });

TEST_F(CommandLine, EveryCommandHasHelpWithAnExampleAndASectionInTheDocs) {
  const Ended help = hotblade({"--help"});
  EXPECT_EQ(help.code, 0);
  EXPECT_THAT(help.err, IsEmpty());
  // The subcommands are the indented first words after the heading.
  std::istringstream text(help.out.substr(help.out.find("Subcommands:")));
  std::string line;
  std::getline(text, line);
  const std::string docs = testing::read_bytes(hotblade::testing::source_dir() + "/docs/commands.md");
  std::size_t commands = 0;
  while (std::getline(text, line) && line.starts_with("  ")) {
    std::string command;
    std::istringstream(line) >> command;
    const Ended ended = hotblade({command, "--help"});
    EXPECT_EQ(ended.code, 0) << command;
    // Something may be piped into it.
    const std::size_t example = ended.out.find("\nExample: ");
    ASSERT_NE(example, std::string::npos) << command;
    EXPECT_THAT(ended.out.substr(example), HasSubstr("hotblade " + command)) << command;
    EXPECT_THAT(docs, HasSubstr("## hotblade " + command + "\n")) << "docs/commands.md";
    ++commands;
  }
  EXPECT_GE(commands, 2u);
}

TEST_F(CommandLine, HelpSaysKindsOfValuesOnceAndForPeople) {
  const std::string ribs = hotblade({"ribs", "--help"}).out;
  EXPECT_THAT(ribs, HasSubstr("--format dxf|svg|csv|gcode REQUIRED"));
  EXPECT_THAT(ribs, HasSubstr("--tolerance MM (1e-06 - 100)"));
  EXPECT_THAT(hotblade({"sim", "--help"}).out, HasSubstr("--listen HOST:PORT=127.0.0.1:1502"));
  EXPECT_THAT(hotblade({"plan", "--help"}).out, HasSubstr("--jobs INT (1 - 1024)"));
  EXPECT_THAT(hotblade({"completion", "man"}).out, HasSubstr("listen HOST:PORT"));
}

TEST_F(CommandLine, VersionIsOneLineOnStdout) {
  const Ended ended = hotblade({"--version"});
  EXPECT_EQ(ended.code, 0);
  EXPECT_THAT(ended.out, MatchesRegex("hotblade [0-9]+\\.[0-9]+\\.[0-9]+\n"));
  EXPECT_THAT(ended.err, IsEmpty());
}

TEST_F(CommandLine, GlobalOptionsAreTakenBeforeAndAfterTheCommand) {
  for (const Words& args : {Words{"-q", "-v", "--progress", "none", "config", "defaults"},
                            Words{"config", "defaults", "--progress", "none", "-v", "-q"},
                            Words{"config", "--progress=json", "defaults"}}) {
    EXPECT_EQ(hotblade(args).code, 0);
  }
}

TEST_F(CommandLine, LogFileTakesTheErrorsToo) {
  const std::string log = (files_ / "log").string();
  const Ended ended = hotblade({"check", "missing.obj", "--units", "mm", "--log-file", log});
  EXPECT_EQ(ended.code, 7);
  EXPECT_EQ(testing::read_bytes(log), ended.err);
  EXPECT_EQ(hotblade({"config", "defaults", "--log-file", (files_ / "no" / "log").string()}).code, 7);
}

// ---- check ----

TEST_F(CommandLine, CheckPrintsTheHealthOfASample) {
  const Ended ended = hotblade({"check", kVault, "--config", kVaultJob});
  EXPECT_EQ(ended.code, 0);
  EXPECT_THAT(ended.err, IsEmpty());
  EXPECT_THAT(ended.out, HasSubstr("900.000 x 500.000 x 140.000 mm"));
  EXPECT_THAT(ended.out, MatchesRegex("(.|\n)*sliceable +yes\n"));
}

TEST_F(CommandLine, CheckSaysWhatAPlanWillMeet) {
  const Ended text = hotblade({"check", kVault, "--units", "m"});
  EXPECT_THAT(text.out, HasSubstr("smallest radius"));
  EXPECT_THAT(text.out, HasSubstr("below is back, above is front"));
  EXPECT_THAT(text.out, HasSubstr(": is that the design's unit? 900 x 500 x 140 mm if in mm, "));
  // What was not tried is not advised.
  EXPECT_THAT(text.out, Not(HasSubstr("--set")));
  EXPECT_THAT(text.err, HasSubstr("--advise plans the job again"));
  const auto met =
      nlohmann::json::parse(hotblade({"check", kVault, "--units", "mm", "--json"}).out)["forecast"];
  EXPECT_NEAR(met["surface"]["radius_mm"].get<double>(), 219, 10);
  EXPECT_NEAR(met["blade_radius_mm"].get<double>(), 70.5, 0.1);
  EXPECT_EQ(met["steep_share"], 0);
  EXPECT_EQ(met["keep_suits"], nlohmann::json::parse(R"(["below", "above", "back", "front"])"));
  EXPECT_EQ(met["facing"], nullptr);
  EXPECT_EQ(met["odd_size"], nullptr);
  EXPECT_EQ(met["reasons"], nlohmann::json::array());
  // Nothing bends of one triangle.
  const std::string triangle = write("one.obj", kTriangle + "f 1 2 3\n");
  const auto flat = nlohmann::json::parse(hotblade({"check", triangle, "--units", "mm", "--json"}).out);
  EXPECT_EQ(flat["forecast"]["surface"]["radius_mm"], nullptr);
}

TEST_F(CommandLine, CheckScalesAndTurnsAsToldAndPrintsJson) {
  const std::string file = write("one.obj", "v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n");
  const Ended ended = hotblade({"check", file, "--units", "in", "--up", "y", "--json"});
  EXPECT_EQ(ended.code, 0) << ended.err;
  const auto json = nlohmann::json::parse(ended.out);
  EXPECT_EQ(json["scale_to_mm"], 25.4);
  EXPECT_EQ(json["bbox_mm"], nlohmann::json::parse("[[0,0,0],[25.4,0,50.8]]"));
  EXPECT_EQ(json["sliceable"], true);
  EXPECT_EQ(json["triangles"], 1);
  EXPECT_EQ(ended.out,
            hotblade({"check", file, "--json", "--set", "design.units=in", "--set", "design.up=y"}).out);
}

TEST_F(CommandLine, CheckNamesTheBlockersOfADesignThatCannotBeSliced) {
  // Three triangles on one edge.
  const Ended ended = check("fan.obj", kTriangle + "v 0 -100 0\nv 0 0 100\nf 1 2 3\nf 1 2 4\nf 1 2 5\n");
  EXPECT_EQ(ended.code, 3);
  EXPECT_THAT(ended.out, HasSubstr("blocker"));
  EXPECT_THAT(ended.out, MatchesRegex("(.|\n)*sliceable +no\n"));
}

TEST_F(CommandLine, BadMeshTextIsNamedWithFileAndLine) {
  const struct {
    std::string name, bytes, place;
  } cases[] = {
      {"empty.obj", "", "empty.obj"},
      {"nan.obj", kTriangle + "v 0 nan 0\nf 1 2 3\n", "nan.obj:4: "},
      {"infinite.obj", kTriangle + "v 0 1e999 0\nf 1 2 3\n", "infinite.obj:4: "},
      {"index0.obj", kTriangle + "f 0 1 2\n", "index0.obj:4: "},
      {"index9.obj", kTriangle + "f 1 2 9\n", "index9.obj:4: "},
      {"corner.obj", kTriangle + "f 1\n", "corner.obj:4: "},
      {"word.obj", kTriangle + "f 1 2 x\n", "word.obj:4: "},
      {"utf16.obj",
       std::string("\xff\xfev\0 \0"
                   "0\0",
                   8),
       "utf16.obj"},
      {"binary.obj", std::string("\0\1\2\3", 4), "binary.obj"},
  };
  for (const auto& bad : cases) {
    const Ended ended = check(bad.name, bad.bytes);
    EXPECT_EQ(ended.code, 3) << bad.name;
    EXPECT_THAT(ended.err, HasSubstr(bad.place)) << bad.name;
    EXPECT_THAT(ended.err, Not(HasSubstr("internal error"))) << bad.name;
    EXPECT_THAT(ended.out, IsEmpty()) << bad.name;
  }
}

TEST_F(CommandLine, FilesThatCannotBeReadExitWithSeven) {
  const Ended missing = hotblade({"check", (files_ / "missing.obj").string(), "--units", "mm"});
  EXPECT_EQ(missing.code, 7);
  EXPECT_THAT(missing.err, AllOf(HasSubstr("missing.obj: "), Not(HasSubstr("internal error"))));
  EXPECT_EQ(hotblade({"check", files_.path().string(), "--units", "mm"}).code, 7);
  EXPECT_EQ(hotblade({"check", kVault, "--config", (files_ / "missing.toml").string()}).code, 7);
}

// ---- config ----

TEST_F(CommandLine, UnknownConfigKeysNameFileAndLine) {
  const std::string file = write("job.toml", "[design]\nunits = \"mm\"\nkeeps = \"back\"\n");
  for (const Words& args : {Words{"check", kVault, "--config", file},
                            Words{"config", "show", "--config", file}, Words{"config", "validate", file}}) {
    const Ended ended = hotblade(args);
    EXPECT_EQ(ended.code, 2);
    EXPECT_EQ(ended.err, file + ":3: design.keeps: unknown key: did you mean design.keep?\n");
  }
}

TEST_F(CommandLine, ConfigDefaultsAreASettingsFileThatChangesNothing) {
  const Ended defaults = hotblade({"config", "defaults"});
  EXPECT_EQ(defaults.code, 0);
  const std::string file = write("defaults.toml", defaults.out);
  EXPECT_EQ(hotblade({"config", "show", "--config", file}).out, defaults.out);
  EXPECT_EQ(hotblade({"config", "validate", file}).code, 0);
}

TEST_F(CommandLine, ConfigShowAppliesFilesThenAssignments) {
  const std::string first = write("a.toml", "[blade]\nkerf_mm = 2\nsafety = 2\n");
  const std::string second = write("b.toml", "[blade]\nkerf_mm = 3\n");
  const Ended ended =
      hotblade({"config", "show", "--config", first, "--config", second, "--set", "blade.safety=4"});
  EXPECT_THAT(ended.out, AllOf(HasSubstr("\nkerf_mm = 3\n"), HasSubstr("\nsafety = 4\n")));
}

TEST_F(CommandLine, ConfigValidateLooksAtEveryFile) {
  const std::string good = write("good.toml", "[blade]\nsafety = 2\n");
  const std::string bad = write("bad.toml", "[blade]\nsafety = 0.5\n");
  const Ended ended = hotblade({"config", "validate", bad, good});
  EXPECT_EQ(ended.code, 2);
  EXPECT_EQ(ended.out, good + ": ok\n");
  EXPECT_EQ(ended.err, bad + ":2: blade.safety (0.5, must be 1 to 10)\n");
}

// ---- plan ----

// The smallest job that plans: coarse ribs on the sample that plans fastest.
Words plan_hypar(const std::filesystem::path& directory, const Words& more = {}) {
  const std::string sample = hotblade::testing::source_dir() + "/samples/hypar";
  Words args{
      "plan",  sample + ".obj",        "--config", sample + ".toml",  "--set", "slice.direction=[1, 0, 0]",
      "--set", "slice.spacing_mm=100", "-o",       directory.string()};
  args.insert(args.end(), more.begin(), more.end());
  return args;
}

TEST_F(CommandLine, PlanLeavesWhatIsThereWithoutForce) {
  const auto directory = files_ / "cut";
  std::filesystem::create_directory(directory);
  write("cut/program.json", "precious");
  const Ended refused = hotblade(plan_hypar(directory));
  EXPECT_EQ(refused.code, 7);
  EXPECT_THAT(refused.err, AllOf(HasSubstr(directory.string()), HasSubstr("--force")));
  EXPECT_EQ(testing::read_bytes(directory / "program.json"), "precious");
  EXPECT_EQ(testing::files_in(directory), 1u);
  EXPECT_EQ(hotblade(plan_hypar(directory, {"--force"})).code, 0);
  EXPECT_THAT(testing::read_bytes(directory / "program.json"), StartsWith("{"));
}

TEST_F(CommandLine, PlanWritesRibsThatComeAndGoWithTheProgram) {
  const auto directory = files_ / "cut", ribs = directory / "ribs";
  ASSERT_EQ(hotblade(plan_hypar(directory)).code, 0);
  const auto drawing = ribs / "S001.dxf";
  const std::string drawn = testing::read_bytes(drawing), beziers = testing::read_bytes(ribs / "beziers.csv");
  EXPECT_THAT(drawn, HasSubstr("S001R001"));
  EXPECT_THAT(beziers, HasSubstr("\nS001R001,3,"));

  // The ribs alone stand in the way of a plan too.
  for (const auto& entry : std::filesystem::directory_iterator(directory)) {
    if (entry.path() != ribs) std::filesystem::remove(entry.path());
  }
  const Ended refused = hotblade(plan_hypar(directory));
  EXPECT_EQ(refused.code, 7);
  EXPECT_THAT(refused.err, AllOf(HasSubstr(ribs.string()), HasSubstr("--force")));

  // Those of an older plan go, what is not ours stays; the same plan gives the same bytes.
  write("cut/ribs/S077.dxf", "old");
  write("cut/ribs/S077 with my notes.dxf", "mine");
  ASSERT_EQ(hotblade(plan_hypar(directory, {"--force"})).code, 0);
  EXPECT_FALSE(std::filesystem::exists(ribs / "S077.dxf"));
  EXPECT_EQ(testing::read_bytes(ribs / "S077 with my notes.dxf"), "mine");
  EXPECT_EQ(testing::read_bytes(drawing), drawn);
  EXPECT_EQ(testing::read_bytes(ribs / "beziers.csv"), beziers);

  // A refused plan leaves no ribs to cut templates from.
  EXPECT_EQ(hotblade(plan_hypar(directory, {"--set", "blade.min_margin=100", "--force"})).code, 4);
  EXPECT_EQ(testing::files_in(ribs), 1u);
}

TEST_F(CommandLine, PlanSaysSoWhenAFileStandsWhereTheRibsGo) {
  std::filesystem::create_directory(files_ / "cut");
  write("cut/ribs", "a file");
  const Ended refused = hotblade(plan_hypar(files_ / "cut", {"--force"}));
  EXPECT_EQ(refused.code, 7);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("cut/ribs"), HasSubstr("not a directory")));
  EXPECT_EQ(testing::read_bytes(files_ / "cut/ribs"), "a file");
}

TEST_F(CommandLine, ARefusedPlanWritesItsReportAndAProgramOnlyWhenOverridden) {
  const auto directory = files_ / "cut";
  const std::vector<std::string> too_stable{"--set", "blade.min_margin=100"};
  const Ended refused = hotblade(plan_hypar(directory, too_stable));
  EXPECT_EQ(refused.code, 4);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("stability margin"), HasSubstr("limit 100")));
  EXPECT_TRUE(std::filesystem::exists(directory / "report.json"));
  EXPECT_FALSE(std::filesystem::exists(directory / "program.json"));

  // Strips that no blade serves cannot be written at all: overridden is a limit of the motion.
  const std::vector<std::string> too_slow{
      "--set", "motion.min_feed_mm_s=6.99", "--set", "motion.feed_mm_s=7", "--force", "--override"};
  const Ended overridden = hotblade(plan_hypar(directory, too_slow));
  EXPECT_EQ(overridden.code, 4);
  EXPECT_THAT(overridden.err, HasSubstr("feed of the slowest blade point"));
  const std::string program = (directory / "program.json").string();
  EXPECT_THAT(testing::read_bytes(program), HasSubstr("feed of the slowest blade point"));
  const Ended verified =
      hotblade({"verify", program, "--design", hotblade::testing::source_dir() + "/samples/hypar.obj"});
  EXPECT_EQ(verified.code, 4) << "a good cut of a refused plan";
  EXPECT_THAT(verified.err, HasSubstr("not to be run"));
  EXPECT_EQ(hotblade({"dryrun", program}).code, 4);

  // A later refusal takes the program away with it.
  EXPECT_EQ(hotblade(plan_hypar(directory, {"--set", "blade.min_margin=100", "--force"})).code, 4);
  EXPECT_FALSE(std::filesystem::exists(program));
}

TEST_F(CommandLine, StrictTurnsWarningsIntoARefusal) {
  const auto directory = files_ / "cut";
  // Smaller than anything that is cut: a sign of wrong units.
  write("speck.obj", "v 0 0 0\nv 15 0 0\nv 15 15 0\nv 0 15 0\nf 1 2 3 4\n");
  const std::vector<std::string> plan{
      "plan", (files_ / "speck.obj").string(), "--units", "mm", "-o", directory.string()};
  auto strict = plan;
  strict.insert(strict.end(), {"--strict", "--force"});
  const Ended lenient = hotblade(plan);
  const Ended refused = hotblade(strict);
  EXPECT_THAT(lenient.err, HasSubstr("warning"));
  EXPECT_EQ(refused.code, 4);
  EXPECT_THAT(refused.err, HasSubstr("--strict"));
  EXPECT_FALSE(std::filesystem::exists(directory / "program.json"));
}

TEST_F(CommandLine, AToleranceOutOfRangeNamesTheFlag) {
  const Ended ended = hotblade(plan_hypar(files_ / "cut", {"--tolerance", "nan"}));
  EXPECT_EQ(ended.code, 2);
  EXPECT_THAT(ended.err, HasSubstr("--tolerance"));
}

TEST_F(CommandLine, PlanCannotWriteUnderAFile) {
  write("file", "");
  const Ended ended = hotblade(plan_hypar(files_ / "file" / "cut"));
  EXPECT_EQ(ended.code, 7);
  EXPECT_THAT(ended.err, AllOf(HasSubstr("file"), Not(HasSubstr("internal error"))));
}

TEST_F(CommandLine, PlanProgressIsJsonThatNeverGoesBack) {
  const Ended ended = hotblade(plan_hypar(files_ / "cut", {"--progress", "json"}));
  EXPECT_EQ(ended.code, 0);
  EXPECT_THAT(ended.out, Not(HasSubstr("progress")));
  std::istringstream lines(ended.err);
  double before = 0;
  std::size_t count = 0;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("{")) continue;
    const double now = nlohmann::json::parse(line).at("progress");
    EXPECT_GE(now, before);
    before = now;
    ++count;
  }
  EXPECT_GE(count, 3u);
  EXPECT_EQ(before, 1.0);
}

TEST_F(CommandLine, PlanThatIsInterruptedExitsWith130AndLeavesNoProgram) {
  // Fine ribs: long enough to be caught at work.
  testing::Process program(
      plan_hypar(files_ / "cut", {"--set", "slice.spacing_mm=0.5", "--progress", "json"}));
  constexpr int kPatienceMs = 60000;
  for (int ms = 0; ms < kPatienceMs && !program.printed_to_stderr("progress"); ++ms) usleep(1000);
  ::kill(program.pid(), SIGINT);
  const Ended ended = program.wait();
  EXPECT_EQ(ended.code, 130) << ended.err;
  EXPECT_FALSE(std::filesystem::exists(files_ / "cut" / "program.json"));
}

// At several moments, of its making as of its writing: it takes seconds.
TEST_F(CommandLine, ExportThatIsInterruptedExitsWith130AndLeavesNothing) {
  ASSERT_EQ(hotblade(plan_hypar(files_ / "cut")).code, 0);
  const std::string program = (files_ / "cut" / "program.json").string();
  for (const int ms : {100, 300, 600}) {
    testing::Process exports(
        {"export", program, "--format", "obj", "--sample", "0.25", "-o", (files_ / "as_cut").string()});
    usleep(1000 * static_cast<useconds_t>(ms));
    ::kill(exports.pid(), SIGINT);
    const Ended ended = exports.wait();
    EXPECT_EQ(ended.code, 130) << "after " << ms << " ms: " << ended.err;
    EXPECT_EQ(ended.out, "");
    EXPECT_FALSE(std::filesystem::exists(files_ / "as_cut"));
  }
}

// ---- slips of the keyboard ----

TEST_F(CommandLine, SlipsAreAnsweredWithWhatWasMeant) {
  const std::string obj = hotblade::testing::source_dir() + "/samples/hypar.obj";
  const struct {
    Words words;
    const char* answer;
  } slips[] = {
      {{"plan", obj, "--unit=mm"}, "did you mean --units?"},
      {{"plan", obj, "--units", "mm", "--tolerence", "2"}, "did you mean --tolerance?"},
      {{"plan", obj, "one", "two", "three"}, "unexpected arguments: one two three"},
      {{"plan", obj, "--units", "mm", "--jobs", "0"}, "1 to 1024"},
      {{"plan", obj, "--units", "mm", "--tolerance", "1,5"}, "did you mean 1.5?"},
      {{"config", "show", "--set", "blade.kerf_mm=1,25"}, "did you mean 1.25?"},
      {{"preview", obj, "--units", "mm", "--keys", "foo", "--shot", "a.png"}, "unknown key (foo)"},
      {{"preview", obj, "--units", "mm", "--shot", (files_ / "q.jpg").string()}, "write .png"},
      {{"preview", obj, "--units", "furlong", "--shot", "a.png"}, "furlong"},
      {{"preview", "program.json", "--units", "furlong", "--shot", "a.png"}, "--units: goes with a design"},
      {{"preview", "program.json", "--up", "y", "--shot", "a.png"}, "--up: goes with a design"},
      {{"preview", "program.json", "--format", "obj"}, "--format: goes with a design"},
      {{"preview", "program.json.gz", "--config", "a.toml"}, "--config: goes with a design"},
      {{"preview", "refused.json", "--set", "a=b"}, "--set: goes with a design, not with a program"},
  };
  for (const auto& slip : slips) {
    const Ended ended = hotblade(slip.words);
    EXPECT_EQ(ended.code, 2) << slip.answer;
    EXPECT_THAT(ended.err, HasSubstr(slip.answer));
    EXPECT_LT(ended.err.size(), 400u) << ended.err;
  }
  EXPECT_FALSE(std::filesystem::exists(files_ / "q.jpg"));
}

TEST_F(CommandLine, HelpOfACommandIsItsHelp) {
  EXPECT_EQ(hotblade({"help", "plan"}).out, hotblade({"plan", "--help"}).out);
  EXPECT_EQ(hotblade({"help", "curve", "fit"}).out, hotblade({"curve", "fit", "--help"}).out);
  EXPECT_EQ(hotblade({"help"}).out, hotblade({"--help"}).out);
}

TEST_F(CommandLine, CompletionKnowsSettingsInEveryShell) {
  for (const std::string shell : {"bash", "zsh", "fish"}) {
    const Ended ended = hotblade({"completion", shell});
    EXPECT_EQ(ended.code, 0);
    EXPECT_THAT(ended.out, HasSubstr("machine.clamp_error_mm=")) << shell;
    EXPECT_THAT(ended.out, HasSubstr("completion")) << shell;
  }
}

TEST_F(CommandLine, PlanAndVerifyPrintJson) {
  const auto directory = files_ / "cut";
  const Ended planned = hotblade(plan_hypar(directory, {"--json"}));
  ASSERT_EQ(planned.code, 0) << planned.err;
  EXPECT_EQ(planned.out, testing::read_bytes(directory / "report.json"));
  // The backend is told with -v alone.
  EXPECT_THAT(planned.err, Not(HasSubstr("distances to")));
  const Ended verified = hotblade({"verify", (directory / "program.json").string(), "--json", "--design",
                                   hotblade::testing::source_dir() + "/samples/hypar.obj"});
  EXPECT_EQ(verified.code, 0);
  const auto json = nlohmann::json::parse(verified.out);
  EXPECT_TRUE(json["within_tolerance"].get<bool>());
  EXPECT_EQ(json["deviation_mm"]["max"], nlohmann::json::parse(planned.out)["deviation_mm"]["max"]);
}

// Sets an environment variable for the programs started meanwhile.
class Environment {
 public:
  Environment(const char* name, const char* value) : name_(name) { ::setenv(name, value, 1); }
  ~Environment() { ::unsetenv(name_); }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  const char* name_;
};

TEST_F(CommandLine, AnInstructionSetThatThereIsNotIsWrongUsage) {
  const Environment pin("HOTBLADE_SIMD", "mmx");
  const Ended ended = hotblade({"check", kVault, "--units", "mm"});
  EXPECT_EQ(ended.code, 2);
  EXPECT_EQ(ended.err,
            "HOTBLADE_SIMD: no instruction set has this name (mmx): give baseline, avx2 or avx512\n");
}

TEST_F(CommandLine, ThePinnedInstructionSetStandsInRunJson) {
  const Environment pin("HOTBLADE_SIMD", "baseline");
  const std::string cut = (files_ / "cut").string();
  ASSERT_EQ(hotblade({"plan", kVault, "--config", kVaultJob, "--pictures", "thumb", "-o", cut}).code, 0);
  EXPECT_EQ(nlohmann::json::parse(std::ifstream(cut + "/run.json")).at("simd"), "baseline");
  // A thumbnail is 320 x 180 pixels, as the head of a PNG file says; there is no scene beside it.
  const std::string png = testing::read_bytes(cut + "/preview.png");
  ASSERT_GT(png.size(), 24U);
  EXPECT_EQ(png.substr(16, 8), std::string("\0\0\x01\x40\0\0\0\xb4", 8));
  EXPECT_LT(png.size(), 100'000U);
  EXPECT_FALSE(std::filesystem::exists(cut + "/scene.gltf"));
}

}  // namespace
}  // namespace hotblade::pipeline

// What a German page says of limits, warnings, what was not checked and why a job failed.
#include <fmt/args.h>
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "pipeline/cell/cell_file.hpp"
#include "pipeline/plan/arms/arms.hpp"
#include "pipeline/preview/drawing/draw.hpp"
#include "pipeline/preview/picture_texts.hpp"
#include "pipeline/preview/scene.hpp"
#include "pipeline/program/read_design.hpp"
#include "pipeline/report/german.hpp"
#include "pipeline/report/pictures.hpp"
#include "pipeline/report/refusal_text.hpp"
#include "pipeline/report/report_html.hpp"
#include "pipeline/report/report_plots.hpp"
#include "pipeline/report/sheets.hpp"
#include "pipeline/sayings/saying.hpp"
#include "pipeline/settings/assignments.hpp"
#include "surface/read/warning.hpp"
#include "tests/paths.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

using ::testing::HasSubstr;

const Words kGermanWords("de");

// All sentences that plans, cells and designs are told by.
std::vector<std::string> all_sentences() {
  std::vector<std::string> all;
  for (const SayingInfo& info : sayings()) all.emplace_back(info.english);
  for (const surface::WarningInfo& info : surface::warning_texts()) all.emplace_back(info.text);
  for (const preview::PictureTextInfo& info : preview::picture_texts()) all.emplace_back(info.english);
  return all;
}

// A sentence with values: names that no table has, and numbers.
std::string with_values(std::string_view sentence) {
  fmt::dynamic_format_arg_store<fmt::format_context> values;
  int i = 0;
  for (std::size_t place = sentence.find('{'); place != std::string_view::npos;
       place = sentence.find('{', place + 1)) {
    ++i;
    if (sentence[place + 1] == '}') {
      values.push_back(fmt::format("v{}w", i));
    } else {
      values.push_back(-0.25 + 1e-3 * i);
    }
  }
  return fmt::vformat(sentence, values);
}

// What stands between the places of a sentence, where it is more than a word.
void add_pieces(std::string_view sentence, std::set<std::string>& pieces) {
  const auto add = [&](std::string_view piece) {
    if (piece.size() >= 10 && piece.substr(1, piece.size() - 2).find(' ') != std::string_view::npos)
      pieces.emplace(piece);
  };
  for (std::size_t place = sentence.find('{'); place != std::string_view::npos; place = sentence.find('{')) {
    add(sentence.substr(0, place));
    sentence.remove_prefix(sentence.find('}') + 1);
  }
  add(sentence);
}

// Pieces of all English that a limit, a warning, a reason or what was not checked is told by.
const std::set<std::string>& english_pieces() {
  static const std::set<std::string> pieces = [] {
    std::set<std::string> all;
    for (const std::string& sentence : all_sentences()) add_pieces(sentence, all);
    for (const robot::LimitInfo& limit : robot::limits()) {
      add_pieces(limit.name, all);
      add_pieces(limit.meaning, all);
    }
    // A setting's name is no English.
    std::erase_if(all, [](const std::string& piece) {
      return std::any_of(german_sentences().begin(), german_sentences().end(),
                         [&](const auto& one) { return one.second.find(piece) != std::string_view::npos; });
    });
    return all;
  }();
  return pieces;
}

// Checks that neither the page nor the sheets of a plan have any of it.
void expect_german(const PlanResult& result, const std::string& name) {
  for (const std::string& page : {report_html(result, {}, "keine"), sheets_html(result, "")}) {
    for (const std::string& piece : english_pieces())
      EXPECT_EQ(page.find(escaped(piece)), std::string::npos) << name << ": " << piece;
  }
}

TEST(German, IsThereForEveryLimit) {
  const std::set<std::string> symbols{"",      "s",     "rad",    "mm",     "mm/s", "mm/s2",
                                      "mm/s3", "rad/s", "rad/s2", "rad/s3", "MPa",  "%"};
  for (const robot::LimitInfo& limit : robot::limits()) {
    EXPECT_NO_THROW((void)kGermanWords(limit.name)) << limit.name;
    if (*limit.meaning != 0) {
      EXPECT_NO_THROW((void)kGermanWords(limit.meaning));
    }
    if (!symbols.contains(limit.unit)) {
      EXPECT_NO_THROW((void)kGermanWords(limit.unit)) << limit.unit;
    }
  }
}

TEST(German, IsThereForEverySayingWhateverItsValues) {
  const auto table = german_sentences();
  for (const std::string& english : all_sentences()) {
    const auto pair =
        std::find_if(table.begin(), table.end(), [&](const auto& one) { return one.first == english; });
    ASSERT_NE(pair, table.end()) << "no German for: " << english;
    EXPECT_EQ(kGermanWords.said(with_values(english)), with_values(pair->second)) << english;
  }
  EXPECT_EQ(table.size(), all_sentences().size()) << "German for what nobody says";
}

TEST(German, GoesIntoWhatStandsInASentence) {
  const std::string inner = say(Saying::kTooNear, {"arm R1 link_5", 3.25, "the block", 40.0, 36.75});
  EXPECT_EQ(
      kGermanWords.said(say(Saying::kOtherJawOrPlace, {inner})),
      "Arm R1 link_5: 3.2 mm Abstand; gegenüber: der Block; mindestens 40 (36.8 mm zu nah): eine andere "
      "Backe, oder ein anderer Ort des Blocks");
  const std::string table = say(Saying::kTooNear, {"arm R1 link_5", 11.5, "the table", 20.0, 8.5});
  EXPECT_EQ(kGermanWords.said(say(Saying::kOfChoices, {say(Saying::kRaise, {table}),
                                                       say(Saying::kRaisedMoved, {300.0, 20.0, 40.0}), 10, 5,
                                                       0, 0, 5, 0, "two KR 50"})),
            "Arm R1 link_5: 11.5 mm Abstand; gegenüber: der Tisch; mindestens 20 (8.5 mm zu nah): den Block "
            "höher stellen (cell.raise_mm) (300 mm höher, um 20, 40 mm verschoben; von 10 Möglichkeiten für "
            "Ort und Arme sind 5 außer Reichweite, 0 an Gelenkgrenzen, 0 nahe an der Singularität, 5 nicht "
            "frei, 0 zu langsam für ein Gelenk; Zelle two KR 50)")
      << "each has brackets";
  EXPECT_EQ(kGermanWords.said(say(Saying::kFirstWarning, {say(Saying::kNoTable)})),
            "die erste: kein Tisch: [table] size_mm angeben");
  EXPECT_EQ(Words("en").said("no table: give [table] size_mm"), "no table: give [table] size_mm");
  EXPECT_EQ(kGermanWords.said(say(Saying::kUpright, {"below"})),
            "design.keep = \"below\" sagt nichts über eine aufrechte Fläche")
      << "a setting has its own word";
}

TEST(German, OfARefusalHasItsPlaceAmountAndReason) {
  Refusal refusal{"S001", "", Limit::kSlowestFeed,
                  0.5,    1,  say(Saying::kHeldBack, {"speed", "motion.travel_mm_s", "250", "mm/s"})};
  refusal.place = say(Saying::kAt, {1.0, 2.0, 3.0});
  refusal.when = say(Saying::kInPhase, {"cut", 12.0});
  EXPECT_EQ(
      describe(refusal, kGermanWords),
      "S001 bei (1.0, 2.0, 3.0): Vorschub des langsamsten Punkts der Klinge 0.5 mm/s (Grenze 1 mm/s) in "
      "der Phase Schnitt bei 12.00 s: dort hält die Klemmen ihre Geschwindigkeit zurück, und die Klinge "
      "würde zu breit schmelzen: der kleinste Vorschub braucht motion.travel_mm_s von 250 mm/s");
  EXPECT_EQ(describe(refusal, Words("en")), describe(refusal));
}

TEST(German, IsAllThatASamplesPageSays) {
  const std::string samples = hotblade::testing::source_dir() + "/samples/";
  const struct {
    const char* name;
    std::vector<std::string> settings;
    bool passes;
  } cases[] = {
      {"barrel_vault", {}, true},
      {"barrel_vault", {"machine.plinth_mm=5"}, false},
      {"barrel_vault", {"motion.min_feed_mm_s=6.99"}, false},
      {"barrel_vault", {"machine.clamp_error_mm=5", "design.over_budget=refuse"}, false},
      {"saddle", {"design.over_budget=warn"}, true},
      {"bump", {"slice.direction=[0, 0, 1]"}, false},
  };
  std::set<Limit> limits;
  for (const auto& one : cases) {
    std::vector<std::string> assignments = one.settings;
    assignments.insert(assignments.begin(), {"job.language=de", "design.units=mm"});
    const Settings settings = resolve({{samples + one.name + ".toml"}, assignments, {}});
    PlanResult result = plan(read_design(samples + one.name + ".obj", settings.design), settings, {});
    EXPECT_EQ(result.refusals.empty(), one.passes)
        << one.name << " " << ::testing::PrintToString(one.settings);
    for (const Refusal& refusal : result.refusals) {
      limits.insert(refusal.limit);
      result.program.overrides.push_back(describe(refusal));
    }
    result.remedies = {{{}, "slice.direction", say(Saying::kPlanesGiven), 1, 2, 1, "amber", {}},
                       {{"design.tolerance_mm=2"}, "", say(Saying::kOtherRibs), 1, 2, 1, "green", {}}};
    result.remedies.back().narrowed = TriedRemedy::Narrowed{2, 1.9, "mm"};
    expect_german(result, one.name);
  }
  EXPECT_GE(limits.size(), 4u) << "different limits are what this is about";
}

// Every limit that there is, as what a plan was refused for and as what stopped a try and a blade.
TEST(German, IsAllThatAPageSaysOfAnyLimit) {
  Settings settings = along_x();
  settings.job.language = "de";
  PlanResult result = plan(cylinder_design(), settings, {});
  ASSERT_TRUE(result.refusals.empty());
  result.program.verification.status = VerificationStatus::kRefused;
  const Decision taken = result.decisions.back();
  for (const robot::LimitInfo& limit : robot::limits()) {
    Refusal refusal{"design", "", limit.limit, 2, 1};
    refusal.when = say(Saying::kInPhase, {"lead_out", 3.0});
    refusal.place = say(Saying::kAbout, {1.0, 2.0, 3.0});
    result.refusals.push_back(refusal);
    Decision other = taken;
    other.taken = other.passed = false;
    other.stopped_by = refusal;
    result.decisions.push_back(other);
    result.strips.front().blades->chosen.refusal = refusal;
    expect_german(result, limit.name);
  }
  for (const std::string& sentence : all_sentences()) result.warnings.push_back(with_values(sentence));
  result.program.verification.not_checked = result.warnings;
  expect_german(result, "every saying");
}

// What a picture says is a name, a number or has German.
TEST(German, IsAllThatAPictureSays) {
  Settings settings = along_x();
  settings.stock.max_size_mm = {200, 120, 120};
  const surface::DesignSurface design = cylinder_design();
  std::set<std::string> asked;
  const auto speak = [&](const std::string& words) {
    asked.insert(words);
    return kGermanWords.said(words);
  };
  for (const double tolerance_mm : {1.0, 0.002}) {
    settings.design.tolerance_mm = tolerance_mm;
    const PlanResult result = plan(design, settings, {});
    preview::Scene scene = preview::scene_of(result.program, &design, {});
    if (!result.refusals.empty())
      preview::mark_refusal(scene, {{describe(result.refusals.front(), kGermanWords), std::nullopt}});
    const auto pngs = preview::pngs_of(
        scene, {}, std::array{preview::Shot{}, preview::Shot{preview::View::kBest, true, true}}, speak);
    EXPECT_EQ(pngs.size(), 2u);
  }
  preview::Scene bare = preview::scene_of(design);
  preview::mark_refusal(bare, {{"v1", std::nullopt}, {"v2", Eigen::Vector3d::Zero()}});
  (void)preview::pngs_of(bare, {}, std::array{preview::Shot{}}, speak);
  EXPECT_GT(asked.size(), 15u);
  for (const std::string& words : asked) EXPECT_NE(kGermanWords.said(words), words) << words;
}

TEST(German, IsWhyThereAreNoPictures) {
  Settings settings = along_x();
  settings.job.language = "de";
  const PlanResult result = plan(cylinder_design(), settings, {});
  const ReportPictures none =
      take_pictures(result, cylinder_design(), Pictures::kNone, Viewer::kNone, [](double) {});
  EXPECT_THAT(report_html(result, none.pictures, none.note),
              HasSubstr("Keine Bilder: nicht verlangt (--no-pictures)."));
}

TEST(German, IsAllThatAPageOfArmsSays) {
  Settings settings = along_x();
  settings.job.language = "de";
  PlanResult result = plan(cylinder_design(), settings, {});
  ASSERT_TRUE(result.refusals.empty());
  robot::Cell cell = read_cell("two_kr50");
  cell.table_mm.reset();
  for (robot::CellArm& arm : cell.arms) arm.tool.shapes.clear();
  ArmedProgram armed = with_arms(result.program, cell);
  result.warnings = armed.report.warnings;
  EXPECT_GE(result.warnings.size(), 3u);
  result.program.verification.not_checked = armed.program.verification.not_checked;
  expect_german(result, "arms");
  // Out of reach.
  robot::Cell far = read_cell("two_kr50");
  far.arms[0].base.p.y() += 3000;
  result.refusals = with_arms(result.program, far).report.refusals;
  ASSERT_FALSE(result.refusals.empty());
  EXPECT_THAT(result.refusals.front().note, HasSubstr("choices of place and arms"));
  result.program.verification.status = VerificationStatus::kRefused;
  expect_german(result, "arms out of reach");
}

}  // namespace
}  // namespace hotblade::pipeline

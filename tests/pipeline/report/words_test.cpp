#include "pipeline/report/words.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <stdexcept>

#include "pipeline/report/german.hpp"
#include "pipeline/report/page_texts.hpp"
#include "pipeline/report/pictures.hpp"
#include "pipeline/report/report_html.hpp"
#include "pipeline/report/sheets.hpp"
#include "pipeline/report/strip_table.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Settings in_german() {
  Settings settings = along_x();
  settings.stock.max_size_mm = {200, 120, 120};
  settings.job = {"K17", "23. November 2026", "A. Planer", "de"};
  return settings;
}

std::string page_of(const PlanResult& result) {
  const ReportPictures taken =
      take_pictures(result, cylinder_design(), Pictures::kNone, Viewer::kFull, [](double) {});
  return report_html(result, {}, "none", "0123", taken.view);
}

// What stands in a text where a value goes, in their order.
std::vector<std::string> places(std::string_view text) {
  std::vector<std::string> found;
  for (std::size_t i = text.find('{'); i != std::string_view::npos; i = text.find('{', i + 1))
    found.emplace_back(text.substr(i, text.find('}', i) - i + 1));
  return found;
}

TEST(Words, OfGermanAreThereForEveryPage) {
  PlanResult result = plan(cylinder_design(), in_german(), {});
  const std::string page = page_of(result);
  for (const char* words : {"Welcher Block wohin gehört", "Warum dieser Plan", "Freigegeben von",
                            "der Schnitt in drei Dimensionen", "Fehlerbudget", "<html lang=\"de\">"})
    EXPECT_THAT(page, HasSubstr(words));
  EXPECT_THAT(sheets_html(result, ""), HasSubstr("Einzubauende Klinge"));
  result.program.verification.status = VerificationStatus::kRefused;
  EXPECT_THAT(sheets_html(result, ""), HasSubstr("Nicht freigegeben"));
  result.program.settings.slice.direction.reset();
  EXPECT_NO_THROW((void)page_of(result));
}

TEST(Words, OfGermanAreThereForEveryWayThatATryCameAbout) {
  PlanResult result = plan(cylinder_design(), in_german(), {});
  for (const SweepWay way : {SweepWay::kEven, SweepWay::kRows, SweepWay::kSplit, SweepWay::kCalmer,
                             SweepWay::kTurned, SweepWay::kUnsteady}) {
    result.decisions.back().way = way;
    EXPECT_NO_THROW((void)report_html(result, {}, "none")) << name(way);
  }
}

TEST(Words, OfGermanAreThereForEveryReason) {
  PlanResult result = plan(cylinder_design(), in_german(), {});
  result.strips_lower_bound = 1;
  result.program.settings.slice.direction.reset();
  for (const std::optional<double> fit_mm : {std::optional<double>(), std::optional(1.5)}) {
    result.ranking = {{surface::PlaneFamily::parallel(Eigen::Vector3d::UnitZ()), 1, 1, 2.5, fit_mm},
                      {surface::PlaneFamily::parallel(Eigen::Vector3d::UnitX()), 2, 1, 2.5, fit_mm}};
    EXPECT_NO_THROW((void)report_html(result, {}, "none"));
  }
  Decision refused = result.decisions.back();
  refused.taken = refused.passed = false;
  refused.strips = 1;
  refused.normal = Eigen::Vector3d::UnitZ();
  result.decisions.insert(result.decisions.begin(), refused);
  Decision met = refused;
  met.way = SweepWay::kMet;
  met.alone = true;
  result.decisions.insert(result.decisions.begin(), met);
  const std::string page = report_html(result, {}, "none");
  EXPECT_THAT(page, HasSubstr("Streifen wurden versucht und abgelehnt"));
  EXPECT_THAT(page,
              HasSubstr("zusammen angepasst nach dem, was sich an dem davor fand, Streifen jeder für sich"));
}

TEST(Words, OfGermanAreThereForARefusedPlan) {
  Settings settings = in_german();
  settings.blade.min_margin = 1000;
  PlanResult result = plan(cylinder_design(), settings, {});
  EXPECT_THAT(page_of(result), HasSubstr("Keine anderen Einstellungen bestanden"));
  result.remedies = {{{"design.tolerance_mm=9"}, "", "measured", 8.1, 9, 2, "green", {}}};
  EXPECT_THAT(page_of(result), HasSubstr("Was ihn schneidbar macht"));
}

TEST(Words, HaveAllThatTheViewSays) {
  const std::string script(viewer_script());
  const Words german("de");
  const std::regex said("say\\((?:[^()']*\\? )?'([^']*)'(?: : '([^']*)')?\\)");
  std::size_t count = 0;
  for (std::sregex_iterator it(script.begin(), script.end(), said), end; it != end; ++it) {
    for (const std::size_t group : {1u, 2u}) {
      if (!(*it)[group].matched) continue;
      EXPECT_NO_THROW((void)german((*it)[group].str()));
      ++count;
    }
  }
  EXPECT_GT(count, 20u);
  // The marks of pipeline/preview/scene.cpp.
  for (const char* mark : {"largest deviation", "what stands in the way"})
    EXPECT_NO_THROW((void)german(mark));
}

TEST(Words, HaveEveryColumnOfTheStrips) {
  for (const StripColumn& column : strip_columns())
    EXPECT_NO_THROW((void)Words("de")(column.name)) << column.name;
  EXPECT_EQ(Words("de").said("2 over"), "2 über der Grenze");
  for (std::size_t i = 0; i < 6; ++i) {
    std::string name = clamp_coordinate_name(i);
    std::replace(name.begin(), name.end(), '_', ' ');
    EXPECT_NE(Words("de").said("0.13 (" + name + ")"), "0.13 (" + name + ")");
  }
}

TEST(Words, KeepTheValuesPlacesAndStandOnce) {
  std::set<std::string_view> seen;
  for (const auto table : {Words("de").table(), german_words_of_limits(), german_sentences()}) {
    for (const auto& [english, german] : table) {
      EXPECT_TRUE(seen.insert(english).second) << english;
      EXPECT_FALSE(german.empty());
      EXPECT_EQ(places(english), places(german));
    }
  }
}

TEST(Words, ThatTheTableLacksAreAnErrorUnlessTheyComeFromElsewhere) {
  EXPECT_THROW((void)Words("de")("no such words"), std::logic_error);
  EXPECT_EQ(Words("de").said("no such words"), "no such words");
  EXPECT_EQ(Words("de").said("droop"), "Durchhang");
  EXPECT_EQ(Words("en")("no such words"), "no such words");
  EXPECT_EQ(Words("de").format("{} ribs", 7), "7 Rippen");
  EXPECT_THROW(Words("fr"), std::logic_error);
}

TEST(Words, ReachTheViewAsJson) {
  PlanResult result = plan(cylinder_design(), in_german(), {});
  const auto words_in = [](const std::string& page) {
    const std::size_t from = page.find("id=\"view-words\">") + 16;
    return nlohmann::json::parse(page.substr(from, page.find("</script>", from) - from));
  };
  EXPECT_EQ(words_in(page_of(result))["triangles"], "Dreiecke");
  result.program.settings.job.language = "en";
  EXPECT_TRUE(words_in(page_of(result)).empty());
}

}  // namespace
}  // namespace hotblade::pipeline

#include "pipeline/report/reasons.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "pipeline/report/report_html.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const Words kEnglish("en");

// A cylinder in several blocks, its planes given.
const PlanResult& planned_with_list() {
  static const PlanResult result = [] {
    Settings settings = along_x();
    settings.stock.max_size_mm = {200, 120, 120};
    settings.blade.free_lengths_mm = {100, 200, 400, 600, 800};
    return plan(cylinder_design(), settings, {});
  }();
  return result;
}

PlanesTried ranked(const Eigen::Vector3d& normal, std::size_t parts, std::optional<double> fit_mm) {
  return {surface::PlaneFamily::parallel(normal.normalized()), parts, 1, 2.5, fit_mm};
}

// One whose planes were searched.
PlanResult searched() {
  PlanResult result = planned_with_list();
  result.program.settings.slice.direction.reset();
  result.ranking = {ranked({1, 0, 0}, 2, 0.125), ranked({0.99, 0.1, 0}, 2, 0.1), ranked({0, 1, 0}, 3, {}),
                    ranked({0, 0, 1}, 1, 7.5)};
  return result;
}

TEST(Reasons, SayThatPlanesWereGiven) {
  EXPECT_EQ(direction_reason(planned_with_list(), kEnglish), "The planes were given by slice.direction.");
}

TEST(Reasons, TellWhatTheNextDirectionWouldTake) {
  const std::string text = direction_reason(searched(), kEnglish);
  EXPECT_THAT(
      text,
      HasSubstr("4 ways to lay planes were ranked; of these: 2 parts, its cheap fit is off by 0.10 mm."));
  EXPECT_THAT(text, HasSubstr("(0, 0, 1): one part, its cheap fit is off by 7.50 mm."));
  EXPECT_THAT(text, Not(HasSubstr("(0, 1, 0)"))) << "it was not fitted";
}

// Of a design of many parts planes are weighed by their rows of blocks.
TEST(Reasons, TellWhatRowsInOtherDirectionsWouldTake) {
  PlanResult result = searched();
  const auto in_rows = [](const Eigen::Vector3d& normal, double blocks, std::size_t strips) {
    PlanesTried tried = ranked(normal, 2, {});
    tried.blocks = blocks;
    tried.strips_in_rows = strips;
    return tried;
  };
  result.ranking = {in_rows({1, 0, 0}, 5.5, 8), in_rows({0, 1, 0}, 6, 9), in_rows({0, 0, 1}, 8.25, 0)};
  EXPECT_EQ(
      direction_reason(result, kEnglish),
      "3 ways to lay planes were ranked by the strips that their rows of blocks take; of these: about 8 "
      "strips. The best of the other directions, planes with the normal (0, 1, 0): about 9 strips.");
  result.ranking.erase(result.ranking.begin() + 1);
  EXPECT_THAT(direction_reason(result, kEnglish),
              HasSubstr("(0, 0, 1): 8.2 blocks or more, if none were wasted at the border."));
  const Words german("de");
  EXPECT_THAT(direction_reason(result, german),
              AllOf(HasSubstr("mit diesen: etwa 8 Streifen."), HasSubstr("8.2 Blöcke oder mehr")));
  result.strips_lower_bound = 1;
  result.decisions.resize(1, result.decisions.back());
  EXPECT_THAT(split_reason(result, kEnglish), HasSubstr("rows of blocks come to about 8 strips"));
}

TEST(Reasons, TellByWhatAnotherDirectionFailedThatWasTriedInFull) {
  PlanResult result = searched();
  Decision other = result.decisions.back();
  other.taken = other.passed = false;
  other.normal = {0, 0, 1};
  other.stopped_by = Refusal{"S001", "", Limit::kRibLength, 550, 500};
  result.decisions.insert(result.decisions.begin(), other);
  EXPECT_THAT(direction_reason(result, kEnglish),
              HasSubstr("Tried in full and refused, normal (0, 0, 1): S001: rib length 550 mm (limit 500 "
                        "mm): no blade is as "
                        "long."));
}

TEST(Reasons, TellByWhatFewerStripsFailed) {
  PlanResult result = planned_with_list();
  const std::size_t count = result.strips.size();
  ASSERT_GT(count, 1u);
  result.strips_lower_bound = count;
  result.decisions.resize(1, result.decisions.back());
  EXPECT_THAT(split_reason(result, kEnglish), HasSubstr(fmt::format("it takes {} at least", count)));
  result.strips_lower_bound = 1;
  result.ranking = {ranked({1, 0, 0}, count, 0.1), ranked({1, 0, 0}, 1, {})};
  EXPECT_THAT(split_reason(result, kEnglish), AllOf(HasSubstr("By its area and size 1 would be the least."),
                                                    HasSubstr("parts no layout had a cheap fit")));
  result.ranking.back().fit_mm = 7.5;
  EXPECT_THAT(split_reason(result, kEnglish),
              HasSubstr("The best cheap fit of fewer parts: one part, its cheap fit is off by 7.50 mm."));
  Decision coarser = result.decisions.back();
  coarser.taken = coarser.passed = false;
  coarser.strips = 1;
  coarser.stopped_by = Refusal{"S001", "", Limit::kDeviation, 1.2, 1};
  result.decisions.insert(result.decisions.begin(), coarser);
  const std::string text = split_reason(result, kEnglish);
  EXPECT_THAT(text, HasSubstr(fmt::format(
                        "1 instead of {} strips were tried and refused: S001: deviation 1.2 mm (limit 1 mm).",
                        count)));
  EXPECT_THAT(text, HasSubstr("l of foam on average"));
}

TEST(Reasons, OfABladeAreTheLimitOfTheShorterAndTheWeightOfTheLonger) {
  const std::vector<double>& lengths = planned_with_list().program.settings.blade.free_lengths_mm;
  for (const StripFacts& f : planned_with_list().strips) {
    ASSERT_TRUE(f.blades && f.blades->shorter && f.blades->longer);
    const auto own = std::find(lengths.begin(), lengths.end(), f.blade_length_mm);
    EXPECT_EQ(f.blades->chosen.length_mm, *own);
    EXPECT_EQ(f.blades->shorter->length_mm, *(own - 1));
    EXPECT_EQ(f.blades->longer->length_mm, *(own + 1));
    EXPECT_EQ(f.blades->chosen.refusal.limit, Limit::kNone);
    EXPECT_NE(f.blades->shorter->refusal.limit, Limit::kNone) << "it would have been taken";
    EXPECT_THAT(blade_text(*f.blades->shorter, kEnglish), HasSubstr("(limit "));
    EXPECT_EQ(f.blades->longer->refusal.limit, Limit::kNone);
    EXPECT_GT(f.blades->longer->sag_mm, f.blades->chosen.sag_mm);
    EXPECT_THAT(blade_text(*f.blades->longer, kEnglish), HasSubstr("weight moves the cut by"));
  }
}

TEST(Reasons, OfASteadierBladeAreWhatTheClampsErrorsMovedTheShorterOne) {
  PlanResult result = planned_with_list();
  SweptFit& fit = result.decisions.back().fits.front();
  fit.clamps_mm = 0.45;
  fit.before = SweptFit::Before{400, 0.1, 6.5};
  EXPECT_THAT(reasons_section(result, kEnglish),
              HasSubstr("the clamps' errors move it by 0.45 mm instead of 6.50 mm with 400 mm"));
}

TEST(Reasons, HaveARowForEachStripThatTheViewFinds) {
  const std::string html = reasons_section(planned_with_list(), kEnglish);
  for (const Strip& strip : planned_with_list().program.strips)
    EXPECT_THAT(html, HasSubstr("<tr id=\"why-" + strip.id + "\" data-strip=\"" + strip.id + "\">"));
  PlanResult turned = planned_with_list();
  for (Rib& rib : turned.program.strips[1].ribs)
    rib.frame = {rib.frame.origin, Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX()};
  EXPECT_THAT(reasons_section(turned, kEnglish), HasSubstr("turned by 90 degrees from the plan's"));
}

// Two plates that rise from a fold.
const PlanResult& folded() {
  static const PlanResult result = [] {
    Settings settings;
    settings.design.units = "mm";
    settings.design.keep = Keep::kBack;
    const auto fold = grid_design("fold", 30, 10, [](double u, double v) {
      return Eigen::Vector3d(600 * u, 400 * v, 300 * std::abs(u - 0.4));
    });
    return plan(fold, settings, {});
  }();
  return result;
}

TEST(Reasons, OfADesignWithCreasesAreToldOfEachFace) {
  PlanResult result = folded();
  ASSERT_EQ(result.faces.size(), 2u);
  ASSERT_EQ(result.strips.size(), 2u);
  // The second face's planes are others than the first one's, and they are its own.
  const FacePlanned::Range& tries = result.faces[1].decisions;
  const Eigen::Vector3d own = Eigen::Vector3d(3, 4, 12).normalized();
  result.decisions[tries.first + tries.count - 1].normal = own;
  for (Rib& rib : result.program.strips[1].ribs)
    rib.frame = {rib.frame.origin, own.unitOrthogonal(), own.cross(own.unitOrthogonal())};
  const std::string html = reasons_section(result, kEnglish);
  EXPECT_THAT(
      html,
      AllOf(HasSubstr("<b>Faces.</b> The design has 2 smooth faces that lie apart or meet in creases"),
            HasSubstr("<td class=\"l\">1</td><td class=\"l\">S001</td>"),
            HasSubstr("<td class=\"l\">2</td><td class=\"l\">S002</td>"), HasSubstr("l of foam on average"),
            Not(HasSubstr("<b>Direction.</b>")), Not(HasSubstr("turned by"))));
  // Each face tells of its own ranking alone.
  for (const FacePlanned& face : result.faces)
    EXPECT_THAT(html, HasSubstr(fmt::format("{} ways to lay planes were ranked", face.ranking.count)));
  const std::string page = report_html(result, {}, "none");
  EXPECT_THAT(page, AllOf(HasSubstr("face 1: of the whole"), HasSubstr("face 2: of the whole"),
                          HasSubstr("all smooth faces together</td><td class=\"l\">each face's own</td>"),
                          HasSubstr("face 2: normal ("),
                          HasSubstr("samples of the cut lie beyond the border or a crease of their face")));
  result.program.settings.job.language = "de";
  EXPECT_THAT(report_html(result, {}, "keine"),
              AllOf(HasSubstr("Der Entwurf hat 2 glatte Fl\u00e4chen, die auseinanderliegen oder an Kanten "
                              "zusammensto\u00dfen"),
                    HasSubstr("Fl\u00e4che 2: Normale (")));
  // Its blades are straight, which no error of 0.1 mm moves by kilometres.
  EXPECT_THAT(page, HasSubstr("<td class=\"n\">straight</td>"));
  // One without creases has none of this.
  EXPECT_EQ(creases_reason(planned_with_list(), kEnglish), "");
  EXPECT_THAT(report_html(planned_with_list(), {}, "none"), Not(HasSubstr("face 1")));
}

TEST(Reasons, AreNotGivenOfWhatWasRefused) {
  Settings settings = along_x();
  settings.blade.min_margin = 1000;
  const PlanResult refused = plan(cylinder_design(), settings, {});
  EXPECT_EQ(reasons_section(refused, kEnglish), "");
  for (const StripFacts& f : refused.strips) EXPECT_FALSE(f.blades);
  EXPECT_THAT(report_html(refused, {}, "none"), HasSubstr("No other settings were found to pass"));
}

}  // namespace
}  // namespace hotblade::pipeline

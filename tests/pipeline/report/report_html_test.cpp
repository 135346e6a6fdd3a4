#include "pipeline/report/report_html.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>
#include <set>

#include "pipeline/report/pictures.hpp"
#include "pipeline/report/report_plots.hpp"
#include "pipeline/report/strip_table.hpp"
#include "pipeline/verify/budget.hpp"
#include "pipeline/verify/foam_share.hpp"
#include "tests/pipeline/plan_design.hpp"
#include "tests/pipeline/vault_program.hpp"

namespace hotblade::pipeline {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// Empty when every tag is closed in its order; else what is wrong.
std::string unbalanced(const std::string& html) {
  const std::set<std::string> empty_elements{"!doctype", "meta", "img", "br"};
  std::vector<std::string> open;
  for (std::size_t i = html.find('<'); i != std::string::npos; i = html.find('<', i + 1)) {
    const std::size_t end = html.find('>', i);
    if (end == std::string::npos) return "a tag without end";
    const bool closing = html[i + 1] == '/';
    const std::size_t start = i + (closing ? 2 : 1);
    const std::string name = html.substr(start, html.find_first_of(" >/", start) - start);
    if (empty_elements.count(name) > 0 || html[end - 1] == '/') continue;
    if (!closing) {
      open.push_back(name);
    } else if (open.empty() || open.back() != name) {
      return "</" + name + "> closes " + (open.empty() ? "nothing" : open.back());
    } else {
      open.pop_back();
    }
  }
  return open.empty() ? "" : open.back() + " stays open";
}

Settings too_tight() {
  Settings settings = along_x();
  settings.blade.min_margin = 1000;
  return settings;
}

TEST(ReportHtml, OfAPassedPlanSaysSoWithItsFigures) {
  const PlanResult result = plan(cylinder_design(), along_x(), {});
  const std::string html = report_html(result, {{"from above", "not really a picture"}}, "");
  EXPECT_EQ(unbalanced(html), "");
  EXPECT_THAT(html, HasSubstr("Can be cut as planned"));
  EXPECT_THAT(html, HasSubstr(fmt::format("{:.3f} mm", result.verification.deviation.max)));
  EXPECT_THAT(html, HasSubstr("S001"));
  EXPECT_THAT(html, HasSubstr("Which block goes where"));
  EXPECT_THAT(html, Not(HasSubstr("Released by"))) << "no job, no line to sign";
  EXPECT_THAT(html, HasSubstr(result.program.design.sha256));
  EXPECT_THAT(html, Not(HasSubstr("sheets.html"))) << "no program, no sheets";
  EXPECT_THAT(report_html(result, {}, "", "0123"), HasSubstr("href=\"sheets.html#sheet-S001\""));
  EXPECT_THAT(html, HasSubstr("data:image/png;base64,bm90IHJlYWxseSBhIHBpY3R1cmU="));
  for (const std::string& line : result.program.verification.not_checked) {
    EXPECT_THAT(html, HasSubstr(escaped(line)));
  }
}

TEST(ReportHtml, HasEveryColumnOfEveryStrip) {
  const PlanResult result = plan(cylinder_design(), along_x(), {});
  const std::string html = report_html(result, {}, "none");
  ASSERT_FALSE(strip_columns().empty());
  for (const StripColumn& c : strip_columns()) {
    EXPECT_THAT(html, HasSubstr(fmt::format("<th>{}<small>{}</small></th>", c.name, c.unit)));
    const StripRow row{result.strips.front(), result.program.strips.front(), result.program.blade, 0};
    EXPECT_THAT(html, HasSubstr(">" + escaped(c.cell(row)) + "</td>")) << c.name;
  }
}

TEST(FoamKeptShare, OfAVaultIsTheClosedFormOfItsSection) {
  const Program program = testing::vault_program({.poses = 200});
  const Strip& strip = program.strips.front();
  // The block is 360 mm wide, from z = -60 mm up; the blade a circle about (0, -drop).
  const double r = testing::kVaultRadius + 0.5, half = strip.block.size_mm.x() / 2;
  const double drop = testing::kVaultRadius * std::cos(testing::kVaultHalfAngle);
  const double under = half * std::sqrt(r * r - half * half) + r * r * std::asin(half / r);
  const double area = under + 2 * half * (60 - drop);
  EXPECT_NEAR(foam_kept_share(strip), area / (2 * half * strip.block.size_mm.z()), 1e-4);
}

TEST(FoamKeptShare, IsTheSameWhereThePlanesTurnAboutAnAxis) {
  // Straight blades 100 mm above the bottom of a block 400 mm high, fanned about a vertical line beside it.
  Strip strip = testing::vault_program({.poses = 60}).strips.front();
  strip.block.frame = {{-200, 0, -100}, {1, 0, 0}, {0, 0, 1}};
  strip.block.size_mm = {400, 400, 300};
  for (std::size_t i = 0; i < strip.poses.size(); ++i) {
    const double turn = 1.2 * (static_cast<double>(i) / 59 - 0.5);
    BladePose& pose = strip.poses[i];
    pose.phase = StripPhase::kCut;
    pose.frame = {{-700, -150, 0}, {std::cos(turn), std::sin(turn), 0}, {0, 0, 1}};
    pose.blade = {0, 0, 0, 0, 0, 0, 1200};
  }
  EXPECT_NEAR(foam_kept_share(strip), 0.25, 1e-9);
}

TEST(FoamKeptShare, IsNothingWhereNoPoseLiesInTheBlock) {
  Strip strip = testing::vault_program().strips.front();
  strip.block.frame.origin.y() += 1e4;
  EXPECT_EQ(foam_kept_share(strip), 0);
}

TEST(ReportHtml, OfARefusedPlanNamesPlaceLimitAndAmount) {
  const PlanResult result = plan(cylinder_design(), too_tight(), {});
  ASSERT_FALSE(result.refusals.empty());
  const std::string html = report_html(result, {}, "no EGL <here>");
  EXPECT_EQ(unbalanced(html), "");
  EXPECT_THAT(html, HasSubstr("Not cuttable as asked"));
  EXPECT_THAT(html, HasSubstr(escaped(limit_text(result.refusals.front()))));
  // What nobody has tried is not told.
  for (const char* advice : {"larger tolerance", "more splits", "another slice.direction", "closer ribs"})
    EXPECT_THAT(html, Not(HasSubstr(advice)));
  EXPECT_THAT(html, HasSubstr("no EGL &lt;here&gt;"));
  EXPECT_THAT(html, Not(HasSubstr("What makes it cuttable")));
  // No figure is given of a cut that there is not.
  EXPECT_THAT(html, HasSubstr("<b>nothing is cut</b><span>largest deviation"));
  EXPECT_THAT(html, Not(HasSubstr("0.000 mm")));
}

TEST(ReportHtml, JudgesEveryStripByTheBoundOfItsOwnDeviation) {
  PlanResult result = plan(cylinder_design(), along_x(), {});
  const std::string bad = "<tr class=\"bad\" id=\"strip-S001\"";
  EXPECT_THAT(report_html(result, {}, ""), Not(HasSubstr(bad)));
  // Another strip, farther off, is the one that the refusal names.
  result.strips.front().deviation_bound_mm = 2;
  result.refusals.push_back({"S002", "", Limit::kDeviation, 3, 1});
  const std::string html = report_html(result, {}, "");
  EXPECT_THAT(html, HasSubstr(bad));
  EXPECT_THAT(html, HasSubstr(">1 over</td>"));
  result.refusals.front().strip = "S001";
  EXPECT_THAT(report_html(result, {}, ""), HasSubstr(">1 over</td>")) << "one limit counts once";
}

TEST(ReportHtml, ListsEveryTryAndNoRankingThatWasNotMade) {
  const PlanResult result = plan(cylinder_design(), along_x(), {});
  ASSERT_FALSE(result.decisions.empty());
  const std::string html = report_html(result, {}, "none");
  EXPECT_EQ(unbalanced(html), "");
  EXPECT_THAT(html, HasSubstr("What was tried"));
  EXPECT_THAT(html, HasSubstr("passes, taken"));
  // Swept plans rank no directions by ribs of their own: a table of zeros said so.
  EXPECT_THAT(html, Not(HasSubstr("planned coarsely")));
  EXPECT_THAT(html, HasSubstr("facing = all faces"));
  EXPECT_THAT(html, HasSubstr("fan_axis = none"));
}

TEST(ReportHtml, SaysWhatWasTriedAndPassed) {
  PlanResult result = plan(cylinder_design(), along_x(), {});
  result.program.verification.status = VerificationStatus::kRefused;
  result.refusals = {{"S001", "", Limit::kDeviation, 2.997, 1}};
  result.refusals.front().capped = true;
  result.remedies = {{{"design.tolerance_mm=9"}, "", "measured", 8.1, 9, 2, "green"}};
  const std::string html = report_html(result, {}, "none");
  EXPECT_EQ(unbalanced(html), "");
  EXPECT_THAT(html, HasSubstr("&ge; 2.997 mm"));
  EXPECT_THAT(html, HasSubstr("<b>--tolerance 9</b></td><td class=\"n\">8.100 mm"));
}

TEST(ReportHtml, WarnsWhenTheBudgetIsOverTheTolerance) {
  PlanResult result = plan(cylinder_design(), along_x(), {});
  EXPECT_THAT(report_html(result, {}, "none"), Not(HasSubstr("more than the tolerance")));
  EXPECT_THAT(report_html(result, {}, "none"),
              HasSubstr("<div class=\"verdict green\"><b>Can be cut as planned"));
  result.program.verification.budget_mm.emplace_back("clamp_error", 1.0);
  const std::string html = report_html(result, {}, "none");
  EXPECT_THAT(html, HasSubstr("more than the tolerance"));
  EXPECT_THAT(html, HasSubstr("<div class=\"verdict amber\"><b>Can be cut within 1 mm if the clamps are"));
  EXPECT_THAT(html,
              HasSubstr(fmt::format("{:.4f} mm", budget_sum_mm(result.program.verification.budget_mm))));
}

TEST(ReportHtml, NeedsNothingButItself) {
  const PlanResult result = plan(cylinder_design(), along_x(), {});
  const std::string html = report_html(result, {}, "none");
  for (const char* outside : {"http://", "https://", "<script", "<link", "url(", "@import"}) {
    const std::string shown = outside;
    // The SVG name space is a name, not an address that anything asks.
    std::string text = html;
    for (std::size_t at; (at = text.find("http://www.w3.org/2000/svg")) != std::string::npos;)
      text.erase(at, 26);
    EXPECT_THAT(text, Not(HasSubstr(shown)));
  }
}

TEST(ReportHtml, EscapesNamesFromOutside) {
  PlanResult result;
  result.program.design.file = "<b>&\"name'.obj";
  result.program.verification.status = VerificationStatus::kRefused;
  const std::string html = report_html(result, {}, "none");
  EXPECT_EQ(unbalanced(html), "");
  EXPECT_THAT(html, HasSubstr("&lt;b&gt;&amp;&quot;name&#39;.obj"));
}

TEST(Pictures, AreTakenFromThreeSidesAlsoWhenNothingCanBeCut) {
  const surface::DesignSurface design = cylinder_design();
  for (const Settings& settings : {along_x(), too_tight()}) {
    const ReportPictures taken = take_pictures(plan(design, settings, {}), design);
    ASSERT_EQ(taken.pictures.size(), 3u) << taken.note;
    std::set<std::string> different;
    for (const ReportPicture& p : taken.pictures) {
      EXPECT_EQ(p.png.substr(1, 3), "PNG");
      different.insert(p.png);
    }
    EXPECT_EQ(taken.scene_gltf.substr(0, 1), "{");
    EXPECT_EQ(different.size(), 3u);
  }
}

TEST(DeviationHistogram, HoldsTheAreaOfBothSurfacesAndAgreesWithThePercentiles) {
  const PlanResult result = plan(cylinder_design(), along_x(), {});
  const VerifyReport& v = result.verification;
  const double held =
      std::accumulate(v.histogram.areas_mm2.begin(), v.histogram.areas_mm2.end(), v.histogram.beyond_mm2);
  // The cut goes on for a little past the design, where nothing is compared.
  EXPECT_NEAR(held, 2 * v.area_mm2, 0.03 * v.area_mm2);
  EXPECT_EQ(v.percentiles_mm.back().second, v.deviation.max);
  for (const auto& [percent, mm] : v.percentiles_mm) {
    double within = 0;
    const auto bins = static_cast<std::size_t>(mm / v.histogram.bin_mm) + 1;
    for (std::size_t i = 0; i < std::min(bins, v.histogram.areas_mm2.size()); ++i)
      within += v.histogram.areas_mm2[i];
    EXPECT_GE(100 * within, (percent - 1e-6) * held) << percent;
  }
}

}  // namespace
}  // namespace hotblade::pipeline

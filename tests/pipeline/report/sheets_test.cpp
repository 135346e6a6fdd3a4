#include "pipeline/report/sheets.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pipeline/export/robot_jobs.hpp"
#include "pipeline/report/block_stand.hpp"
#include "pipeline/report/places_table.hpp"
#include "pipeline/report/sheet_drawings.hpp"
#include "pipeline/report/strip_table.hpp"
#include "pipeline/settings/settings.hpp"
#include "pipeline/stock/foam_to_buy.hpp"
#include "pipeline/verify/swept_surface.hpp"
#include "tests/pipeline/plan_design.hpp"
#include "tests/pipeline/vault_program.hpp"

namespace hotblade::pipeline {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// A cylinder in two blocks.
const PlanResult& planned() {
  static const PlanResult result = [] {
    Settings settings = along_x();
    settings.stock.max_size_mm = {200, 120, 120};
    settings.job = {"K17 <3", "23 November 2026", "A. Planner", "en"};
    return plan(cylinder_design(), settings, {});
  }();
  return result;
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t i = text.find(part); i != std::string::npos; i = text.find(part, i + 1)) ++count;
  return count;
}

TEST(BlockStand, StandsWithItsEdgesAlongTheTableAndItsCutFromTheTopDown) {
  for (const Strip& strip : planned().program.strips) {
    const BlockStand stand = stand_of(strip);
    Eigen::Vector3d own = stand.box.sizes(), size = strip.block.size_mm;
    EXPECT_NEAR(own.x(), size.x(), 1e-6) << "the width runs along the blade";
    EXPECT_NEAR(own.z(), size.z(), 1e-6) << "the cut runs down";
    EXPECT_NEAR(own.y(), size.y(), 1e-6);
    EXPECT_NEAR(stand.box.min().z(), strip.block.height_above_table_mm(strip.design_to_cell), 1e-6);
    for (const std::size_t side : {0u, 1u}) {
      const auto& line = stand.sides[side];
      ASSERT_GT(line.size(), 5u);
      EXPECT_TRUE(std::is_sorted(line.begin(), line.end(),
                                 [](const auto& p, const auto& q) { return p.z() > q.z(); }));
      EXPECT_NEAR(line.front().z(), stand.box.max().z(), 1e-6);
      EXPECT_NEAR(line.back().z(), stand.box.min().z(), 1e-6);
    }
    for (const auto* line : {&stand.enters, &stand.leaves}) {
      ASSERT_GT(line->size(), 5u);
      EXPECT_LT(line->front().x(), line->back().x()) << "from the left";
    }
    EXPECT_FALSE(stand.base_cut);
  }
}

// Swept down, its foam's base at the front.
Strip standing_vault() {
  Strip strip = testing::vault_program({.poses = 200}).strips.front();
  Eigen::Matrix3d turn;
  turn << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  strip.design_to_cell = {{0, 0, 0}, Eigen::Quaterniond(turn)};
  // The same block, its axes as the planner has them: along the blade, to the waste, up the cut.
  strip.block.frame = {
      {-180, testing::kVaultStripWidth, -60}, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ()};
  strip.block.size_mm = {360, 120, testing::kVaultStripWidth};
  return strip;
}

// The vault's blade as a circle about (0, -drop) in the block's section, seen from its middle.
double vault_height(const Strip& strip, double x) {
  const double r = testing::kVaultRadius + 0.5;
  const double drop = testing::kVaultRadius * std::cos(testing::kVaultHalfAngle);
  return std::sqrt(r * r - x * x) - drop - strip.block.frame.origin.z();
}

TEST(BlockStand, TheBladeOfAVaultEntersWhereItsCircleMeetsTheBlocksFaces) {
  const Strip strip = standing_vault();
  const BlockStand stand = stand_of(strip);
  const double height = vault_height(strip, strip.block.size_mm.x() / 2);
  for (const auto* places : {&stand.enters_at, &stand.leaves_at}) {
    for (const std::size_t side : {0u, 1u}) {
      const auto& place = (*places)[side];
      ASSERT_TRUE(place.has_value());
      EXPECT_EQ(place->face, side == 0 ? Face::kLeft : Face::kRight);
      EXPECT_NEAR(place->mm, height, 0.1);
    }
  }
}

TEST(BlockStand, ABladeThatComesThroughTheBaseFaceIsSaidToDoSo) {
  Strip strip = standing_vault();
  // The base 40 mm above where the vault meets the sides.
  const double up = vault_height(strip, strip.block.size_mm.x() / 2) + 40;
  strip.block.frame.origin += up * strip.block.frame.y;
  strip.block.size_mm.y() -= up;
  const BlockStand stand = stand_of(strip);
  EXPECT_TRUE(stand.base_cut);
  const double r = testing::kVaultRadius + 0.5;
  const double drop = testing::kVaultRadius * std::cos(testing::kVaultHalfAngle);
  const double base = strip.block.frame.origin.z() + drop, half = std::sqrt(r * r - base * base);
  for (const std::size_t side : {0u, 1u}) {
    ASSERT_TRUE(stand.enters_at[side].has_value());
    EXPECT_EQ(stand.enters_at[side]->face, stand.base_at_back ? Face::kBack : Face::kFront);
    EXPECT_NEAR(stand.enters_at[side]->mm, strip.block.size_mm.x() / 2 + (side == 0 ? -half : half), 0.1);
  }
}

TEST(BlockStand, ABladeBesideTheBlockLeavesNoPlace) {
  Strip strip = standing_vault();
  strip.block.frame.origin.z() -= 2000;
  const BlockStand stand = stand_of(strip);
  EXPECT_TRUE(stand.enters.empty());
  EXPECT_FALSE(stand.enters_at[0] || stand.enters_at[1] || stand.leaves_at[0] || stand.leaves_at[1]);
}

TEST(BlockStand, TheBaseFaceIsOnThePartsSide) {
  const Program& program = planned().program;
  const SweptSurface swept = swept_surface(program, 5);
  for (std::size_t v = 0; v < swept.vertices.size(); ++v) {
    const Strip& strip = program.strips[static_cast<std::size_t>(swept.strip_of_vertex[v])];
    const Eigen::Vector3d waste = strip.design_to_cell.q * swept.normals[v];
    EXPECT_EQ(stand_of(program.strips.front()).base_at_back, stand_of(strip).base_at_back);
    ASSERT_GT((stand_of(strip).base_at_back ? -1 : 1) * waste.y(), 0);
    v += 200;  // some of them will do
  }
}

TEST(Sheets, HaveAPageForEachBlockWithAllThatSetsItUp) {
  const PlanResult& result = planned();
  ASSERT_GE(result.program.strips.size(), 2u);
  const std::string html = sheets_html(result, "0123456789abcdef");
  EXPECT_EQ(count_of(html, "<section"), result.program.strips.size() + 2);
  EXPECT_THAT(html, HasSubstr("K17 &lt;3"));
  EXPECT_THAT(html, HasSubstr("23 November 2026"));
  EXPECT_THAT(html, HasSubstr("A. Planner"));
  for (std::size_t k = 0; k < result.program.strips.size(); ++k) {
    const Strip& strip = result.program.strips[k];
    const std::size_t from = html.find("<section id=\"sheet-" + strip.id);
    ASSERT_NE(from, std::string::npos);
    const std::string sheet = html.substr(from, html.find("</section>", from) - from);
    const BlockStand stand = stand_of(strip);
    const Eigen::Vector3d size = stand.box.sizes();
    for (const std::string& words :
         {fmt::format("{:.0f} x {:.0f} x {:.0f} mm", size.x(), size.y(), size.z()),
          fmt::format("{:.0f} mm</b> free length", strip.blade_length_mm),
          fmt::format("number <b>{}</b> of {}", k + 1, result.program.strips.size()),
          fmt::format("{:.1f} minutes", result.strips[k].motion.duration_s / 60),
          std::string("on the left edge, from the base face"),
          "ribs/" + strip.id + ".dxf: " + strip.ribs.front().id, std::string(" / Program 0123456789ab"),
          std::string("Cut by"), std::string("Neighbours")})
      EXPECT_THAT(sheet, HasSubstr(words));
    EXPECT_THAT(sheet, HasSubstr(result.program.strips[k == 0 ? 1 : k - 1].id)) << "its neighbour";
  }
  EXPECT_THAT(html, Not(HasSubstr("<script")));
  EXPECT_THAT(html, Not(HasSubstr("http")));
}

// As of an S, whose blocks stand beside each other at heights that have little in common.
TEST(Sheets, NameANeighbourThatStandsMuchHigher) {
  PlanResult result = planned();
  const auto neighbours_of_first = [&] {
    const std::string html = sheets_html(result, "");
    const std::size_t row = html.find("Neighbours", html.find("<section id=\"sheet-S001"));
    return html.substr(row, html.find("</tr>", row) - row);
  };
  Block& block = result.program.strips[1].block;
  block.frame.origin += 0.6 * block.size_mm.y() * block.frame.y;
  EXPECT_THAT(neighbours_of_first(), HasSubstr("S002"));
  block.frame.origin += 0.6 * block.size_mm.y() * block.frame.y;
  EXPECT_THAT(neighbours_of_first(), Not(HasSubstr("S002"))) << "it stands above";
}

// How often each block is named in the pictures of the whole, from their definitions.
std::vector<std::size_t> named(const Program& program) {
  std::string pictures;
  for (const AssemblyPicture& picture : AssemblyPicture::all_of(program, 700, 820))
    pictures += picture.definition();
  std::vector<std::size_t> counts;
  for (const Strip& strip : program.strips) counts.push_back(count_of(pictures, ">" + strip.id + "</text>"));
  return counts;
}

TEST(AssemblyPicture, NamesEveryBlockOnceHoweverTheyLie) {
  Program program = planned().program;
  EXPECT_EQ(AssemblyPicture::all_of(program, 700, 820).size(), 1u);
  EXPECT_THAT(named(program), ::testing::Each(1u));
  // Back to back, as the pieces of what is cut all around.
  Strip& other = program.strips.back();
  other.block.frame.y *= -1;
  EXPECT_EQ(AssemblyPicture::all_of(program, 700, 820).size(), 2u);
  EXPECT_THAT(named(program), ::testing::Each(1u));
  // Askew to all axes alike.
  for (Strip& strip : program.strips) strip.block.frame.y = Eigen::Vector3d(1, -1, 1).normalized();
  EXPECT_EQ(AssemblyPicture::all_of(program, 700, 820).size(), 1u);
}

TEST(Sheets, OfWhatIsCutAllAroundShowEachBlockInThePictureOfItsSide) {
  PlanResult result = planned();
  result.program.strips.back().block.frame.y *= -1;
  const std::string html = sheets_html(result, "");
  EXPECT_EQ(count_of(html, "<section"), result.program.strips.size() + 3);
  EXPECT_THAT(html, HasSubstr("Assembly 2"));
  for (const Strip& strip : result.program.strips) {
    const std::size_t from = html.find("<section id=\"sheet-" + strip.id);
    const std::string sheet = html.substr(from, html.find("</section>", from) - from);
    const bool last = strip.id == result.program.strips.back().id;
    EXPECT_EQ(count_of(sheet, "#assembly2\""), last ? 1u : 0u);
    EXPECT_EQ(count_of(sheet, "#assembly1\""), last ? 0u : 1u);
  }
}

TEST(Sheets, TellTheTimeOnTheMachineFromThatOfTheCut) {
  double machine_s = 0, cut_s = 0;
  for (const StripFacts& f : planned().strips) {
    machine_s += f.motion.duration_s;
    cut_s += f.motion.cut_s;
  }
  ASSERT_GT(machine_s, cut_s + 60);
  EXPECT_THAT(sheets_html(planned(), ""),
              HasSubstr(fmt::format("<span>time on the machine <b>{}</b></span><span>cut <b>{}</b></span>",
                                    duration(machine_s), duration(cut_s))));
}

TEST(Sheets, SayWhichFoamToBuyAndWhereToSawIt) {
  EXPECT_THAT(sheets_html(planned(), ""), Not(HasSubstr("Foam to buy")));
  PlanResult result = planned();
  result.program.settings.stock.sizes_mm = {{420, 250, 125}};
  result.program.settings.stock.saw_mm = 5;
  result.foam = foam_to_buy(result.program);
  ASSERT_TRUE(result.foam);
  const std::string page = sheets_html(result, "");
  EXPECT_THAT(page,
              HasSubstr(fmt::format("To buy <b>{} x (420 x 250 x 125) mm</b>", result.foam->blocks.size())));
  std::size_t cuts = 0;
  for (const BoughtBlock& block : result.foam->blocks) cuts += block.cuts.size();
  EXPECT_EQ(count_of(page, "</td><td class=\"l\"><b>"), cuts + result.program.strips.size())
      << "a row for each cut, and for each block in the parts list";
  for (const Strip& strip : result.program.strips) EXPECT_THAT(page, HasSubstr(" = <b>" + strip.id + "</b>"));
  // A block as large as the stock but for rounding, and one that leaves next to nothing.
  const std::array<double, 3> stock{420, 250, 125};
  for (const double less : {-1e-7, 1e-7, 1e-6, 2e-6, 1e-3, 0.3, 5.2}) {
    result.program.strips[0].block.size_mm = {stock[0] - less, stock[1], stock[2] + less};
    result.program.strips[1].block.size_mm = {stock[0] - less, 100 - less, stock[2] - less};
    result.foam = foam_to_buy(result.program);
    if (!result.foam) continue;
    EXPECT_NO_THROW((void)sheets_html(result, "")) << less;
  }
  result.program.settings.job.language = "de";
  result.program.strips = planned().program.strips;
  result.foam = foam_to_buy(result.program);
  EXPECT_THAT(sheets_html(result, ""), HasSubstr("Schaum einkaufen und s\u00e4gen"));
}

TEST(Sheets, ARefusedPlansSheetsSayThatTheyAreNotReleased) {
  PlanResult result = planned();
  EXPECT_THAT(sheets_html(result, ""), Not(HasSubstr("Not released")));
  result.program.verification.status = VerificationStatus::kRefused;
  EXPECT_EQ(count_of(sheets_html(result, ""), "Not released"), result.program.strips.size() + 2);
}

TEST(Sheets, ChangeWithEachSettingOfTheJob) {
  const std::string before = sheets_html(planned(), "");
  for (const SettingInfo& info : describe_settings()) {
    if (!info.key.starts_with("job.")) continue;
    PlanResult result = planned();
    result.program.settings.job =
        resolve({{}, {info.key + (info.key == "job.language" ? "=de" : "=other")}, {}}).job;
    EXPECT_NE(sheets_html(result, ""), before) << info.key;
  }
}

// The block's corner that floor sheets, report and robot programs name is one.
TEST(Sheets, NameTheCornerThatRobotProgramsName) {
  PlanResult result = planned();
  for (const double degrees : {0.0, 15.0, -75.0, 180.0}) {
    result.program = planned().program;
    for (Strip& strip : result.program.strips) {
      const Eigen::Quaterniond turn(Eigen::AngleAxisd(degrees * M_PI / 180, Eigen::Vector3d::UnitZ()));
      strip.design_to_cell = {turn * strip.design_to_cell.p + Eigen::Vector3d(90, -40, 100),
                              turn * strip.design_to_cell.q};
    }
    const std::string sheets = sheets_html(result, ""), places = places_section(result, Words("en"), false);
    const auto tasks = robot_tasks(result.program, nullptr);
    for (std::size_t k = 0; k < result.program.strips.size(); ++k) {
      const Strip& strip = result.program.strips[k];
      const std::vector<std::string>& texts = tasks[0].jobs[k].texts;
      const BlockStand stand = stand_of(strip);
      const Eigen::Vector3d corner = stand.corner.array().round() + 0.0;
      EXPECT_THAT(texts[1], HasSubstr(fmt::format("{:.0f} mm above the table, left front lower corner at x "
                                                  "{:.0f}, y {:.0f}",
                                                  corner.z(), corner.x(), corner.y())));
      const std::string cell = fmt::format("{:.0f}, {:.0f}, {:.0f}", corner.x(), corner.y(), corner.z());
      EXPECT_THAT(sheets, HasSubstr(cell));
      EXPECT_THAT(places, HasSubstr(cell));
      // A corner of the block, its size that of the block.
      double nearest = 1e9;
      for (const Eigen::Vector3d& p : strip.block.corners())
        nearest =
            std::min(nearest, (strip.design_to_cell.q * p + strip.design_to_cell.p - stand.corner).norm());
      EXPECT_LT(nearest, 1e-6);
      const Eigen::Vector3d& size = strip.block.size_mm;
      EXPECT_THAT(sheets,
                  HasSubstr(fmt::format("<b>{:.0f} x {:.0f} x {:.0f} mm</b>", size.x(), size.y(), size.z())));
      EXPECT_THAT(texts[0],
                  HasSubstr(fmt::format("block {:.0f} x {:.0f} x {:.0f} mm", size.x(), size.y(), size.z())));
      const bool turned = degrees != 0 && degrees != 180;
      EXPECT_EQ(texts.size(), turned ? 3u : 2u);
      EXPECT_EQ(sheets.find("turned about it by") != std::string::npos, turned);
      // The blade enters where it does in a block that is not turned.
      const BlockStand straight = stand_of(planned().program.strips[k]);
      ASSERT_TRUE(stand.enters_at[0] && straight.enters_at[0]);
      if (degrees != 180) {
        EXPECT_NEAR(stand.enters_at[0]->mm, straight.enters_at[0]->mm, 1e-6);
      }
    }
  }
}

}  // namespace
}  // namespace hotblade::pipeline

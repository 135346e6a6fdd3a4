// The foam that a whole batch is sawn out of.
#include "pipeline/batch/foam_list.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "pipeline/batch/csv.hpp"
#include "pipeline/batch/gather.hpp"
#include "tests/pipeline/batch/stand_in.hpp"

namespace hotblade::pipeline::batch {
namespace {

using namespace testing;
using pipeline::testing::read_bytes;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

const SoldFoam kSold{{{2500, 1250, 600}, {1000, 500, 250}}, 4};

CutList blocks(const std::vector<BoxSize>& sizes, std::size_t of_panel = 1) {
  CutList list;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    CutBlock& block = list.blocks.emplace_back();
    block.job = 1 + i / of_panel;
    block.id = std::to_string(block.job) + "-" + std::to_string(1 + i % of_panel);
    block.panel = "panel " + std::to_string(block.job);
    block.strip = "S00" + std::to_string(1 + i % of_panel);
    block.size_mm = sizes[i];
  }
  return list;
}

FoamList foam_of(const CutList& list) {
  return foam_list(list, [](std::size_t) { return kSold; });
}

// Every block once, within its foam, no two nearer than the saw's cut.
void expect_sawn_apart(const FoamList& foam, const CutList& list) {
  std::set<std::size_t> seen;
  for (const BoughtFoam& bought : foam.bought) {
    const std::vector<NestedPiece>& pieces = bought.block.pieces;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      EXPECT_TRUE(seen.insert(pieces[i].piece).second) << pieces[i].piece;
      const StockBox& box = pieces[i].box;
      EXPECT_TRUE(holds(box.size, list.blocks[pieces[i].piece].size_mm));
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_LE(box.at[k] + box.size[k], bought.block.size[k] + 1e-6) << "beyond its foam";
      for (std::size_t j = 0; j < i; ++j) {
        const StockBox& other = pieces[j].box;
        bool apart = false;
        for (std::size_t k = 0; k < 3; ++k)
          apart |= box.at[k] >= other.at[k] + other.size[k] + bought.saw_mm - 1e-6 ||
                   other.at[k] >= box.at[k] + box.size[k] + bought.saw_mm - 1e-6;
        EXPECT_TRUE(apart) << pieces[i].piece << " and " << pieces[j].piece;
      }
    }
  }
  EXPECT_EQ(seen.size() + foam.too_large.size(), list.blocks.size());
}

TEST(FoamList, PanelsShareTheFoamThatEachAloneWouldWaste) {
  // Eight panels of one block each: alone each takes a large one, together they take two.
  const CutList list = blocks(std::vector<BoxSize>(8, BoxSize{1200, 600, 290}));
  const FoamList foam = foam_of(list);
  expect_sawn_apart(foam, list);
  const double large_m3 = 2.5 * 1.25 * 0.6;
  EXPECT_NEAR(foam.by_panel_m3, 8 * large_m3, 1e-9);
  EXPECT_NEAR(foam.each_m3, 8 * large_m3, 1e-9);
  EXPECT_NEAR(foam.bought_m3, large_m3, 1e-9);
  EXPECT_NEAR(foam.pieces_m3, 8 * 1.2 * 0.6 * 0.29, 1e-9);
  EXPECT_THAT(foam.sizes, ElementsAre(Pair(BlockSize{2500, 1250, 600}, 1U)));
}

TEST(FoamList, ThePageNamesThePartThatEachPieceIsAndEveryCut) {
  const CutList list = blocks({{900, 400, 200}, {900, 240, 200}});
  const FoamList foam = foam_of(list);
  const std::string page = foam_page("facade", foam, list);
  std::size_t cuts = 0;
  for (const BoughtFoam& bought : foam.bought) {
    for (const NestedPiece& piece : bought.block.pieces) {
      EXPECT_THAT(page, HasSubstr("<tr><td class=\"id\">" + part_name(piece.part) + "</td><td class=\"id\">" +
                                  list.blocks[piece.piece].id + "</td>"));
    }
    cuts += bought.block.cuts.size();
  }
  std::size_t boxes = 0;
  for (std::size_t at = page.find("☐"); at != std::string::npos; at = page.find("☐", at + 1)) ++boxes;
  EXPECT_GT(cuts, 0U);
  EXPECT_EQ(boxes, cuts);
}

TEST(FoamList, WhatNoSizeHoldsIsNamedAndJobsThatSayNothingAreLeftOut) {
  CutList list = blocks({{900, 400, 200}, {3000, 400, 200}, {900, 400, 200}});
  const FoamList foam = foam_list(list, [](std::size_t job) { return job == 3 ? SoldFoam{} : kSold; });
  ASSERT_EQ(foam.bought.size(), 1U);
  EXPECT_EQ(foam.bought[0].block.pieces.at(0).piece, 0U);
  EXPECT_THAT(foam.too_large, ElementsAre(1U));
  EXPECT_THAT(foam.unsaid, ElementsAre(2U));
  EXPECT_THAT(foam_page("facade", foam, list), HasSubstr("No size that is sold holds: 2-1"));
  EXPECT_TRUE(foam_list(list, [](std::size_t) { return SoldFoam{}; }).empty());
}

TEST(FoamList, JobsOfOtherFoamShareNone) {
  const CutList list = blocks({{900, 240, 240}, {900, 240, 240}});
  const SoldFoam wide_saw{kSold.sizes_mm, 10};
  const FoamList foam = foam_list(list, [&](std::size_t job) { return job == 1 ? kSold : wide_saw; });
  ASSERT_EQ(foam.bought.size(), 2U);
  EXPECT_EQ(foam.bought[0].saw_mm, 4);
  EXPECT_EQ(foam.bought[1].saw_mm, 10);
  EXPECT_EQ(foam_of(list).bought.size(), 1U);
}

TEST(FoamList, ManyBlocksAreNestedInLotsInTheOrderOfCutting) {
  std::vector<BoxSize> sizes;
  constexpr int kBlocks = 2 * static_cast<int>(kLotBlocks) + 10;
  for (int i = 0; i < kBlocks; ++i)
    sizes.push_back({400.0 + 7 * (i % 50), 300.0 + 11 * (i % 13), 150.0 + 3 * (i % 17)});
  const CutList list = blocks(sizes, 3);
  const FoamList foam = foam_of(list);
  expect_sawn_apart(foam, list);
  EXPECT_LT(foam.bought_m3, foam.by_panel_m3);
  EXPECT_LT(foam.by_panel_m3, foam.each_m3);
  for (const BoughtFoam& bought : foam.bought) {
    std::set<std::size_t> lots;
    for (const NestedPiece& piece : bought.block.pieces) lots.insert(piece.piece / kLotBlocks);
    EXPECT_EQ(lots.size(), 1U);
  }
  const CsvTable table = parse_csv(foam_table(foam, list), "foam.csv");
  EXPECT_EQ(table.rows.size(), list.blocks.size());
  EXPECT_EQ(foam_table(foam_of(list), list), foam_table(foam, list)) << "the same input, the same bytes";
}

TEST(FoamList, IsWrittenByGatherWhereTheSettingsSayWhatIsSold) {
  const StandInBatch batch({20, kRefused, 21}, 10, {},
                           {"stock.sizes_mm=[[2500, 1250, 600]]", "stock.saw_mm=4"});
  (void)batch.run();
  (void)gather(batch.directory(), false, {});
  const std::filesystem::path directory = batch.directory().path();
  const CsvTable table = parse_csv(read_bytes(directory / "foam.csv"), "foam.csv");
  ASSERT_EQ(table.rows.size(), 2U);  // the refused panel takes none
  EXPECT_EQ(table.rows[1].cells[table.column("foam")], "1");
  EXPECT_EQ(table.rows[1].cells[table.column("foam_x_mm")], "2500.0");
  const std::string page = read_bytes(directory / "foam.html");
  EXPECT_THAT(page, HasSubstr("<td>2500 × 1250 × 600</td><td class=\"n\">1</td>"));
  EXPECT_THAT(page, HasSubstr(table.rows[0].cells[table.column("id")]));
  const StockReport report = list_stock(batch.directory(), false, 1, {});
  EXPECT_NEAR(report.foam.bought_m3, 2.5 * 1.25 * 0.6, 1e-9);
  EXPECT_EQ(read_bytes(directory / "foam.html"), page);

  const StandInBatch plain({20});
  (void)plain.run();
  std::ofstream(plain.directory().path() / "foam.csv") << "of an earlier batch";
  (void)gather(plain.directory(), false, {});
  EXPECT_FALSE(std::filesystem::exists(plain.directory().path() / "foam.csv"));
}

TEST(FoamList, CanBeInterrupted) {
  const CutList list = blocks(std::vector<BoxSize>(20, BoxSize{1200, 600, 290}));
  EXPECT_THROW((void)foam_list(
                   list, [](std::size_t) { return kSold; }, [] { throw std::runtime_error("stop"); }),
               std::runtime_error);
}

}  // namespace
}  // namespace hotblade::pipeline::batch

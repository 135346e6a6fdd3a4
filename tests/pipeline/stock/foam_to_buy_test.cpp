#include "pipeline/stock/foam_to_buy.hpp"

#include <gmock/gmock.h>

#include "pipeline/settings/settings.hpp"

namespace hotblade::pipeline {
namespace {

using ::testing::HasSubstr;

Program two_blocks() {
  Program program;
  program.strips.resize(2);
  program.strips[0].block.size_mm = {300, 200, 100};
  program.strips[1].block.size_mm = {100, 250, 290};
  return program;
}

TEST(FoamToBuy, HoldsEveryStripsBlockInTheirOrder) {
  Program program = two_blocks();
  EXPECT_FALSE(foam_to_buy(program));  // nothing is said of what is sold
  program.settings.stock.sizes_mm = {{460, 310, 100}};
  program.settings.stock.saw_mm = 4;
  const auto foam = foam_to_buy(program);
  ASSERT_TRUE(foam);
  ASSERT_EQ(foam->blocks.size(), 1u);
  ASSERT_EQ(foam->blocks[0].pieces.size(), 2u);
  EXPECT_DOUBLE_EQ(foam->pieces_mm3, 300.0 * 200 * 100 + 100.0 * 250 * 290);
  EXPECT_DOUBLE_EQ(foam->apart_mm3, 2 * foam->bought_mm3);
  program.settings.stock.saw_mm = 40;
  EXPECT_EQ(foam_to_buy(program)->blocks.size(), 2u) << "the saw leaves too little for both";
}

TEST(FoamToBuy, SaysNothingOfABlockThatNoSizeHolds) {
  Program program = two_blocks();
  program.settings.stock.sizes_mm = {{620, 310, 99}};
  EXPECT_FALSE(foam_to_buy(program));
  program.settings.stock.sizes_mm = {{620, 310, 100}};
  program.strips[1].block.size_mm.z() = 0;
  EXPECT_FALSE(foam_to_buy(program));
}

std::string error_of(std::vector<std::string> set) {
  try {
    (void)resolve({{}, std::move(set), {}});
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST(FoamToBuy, IsOfSizesThatHoldTheLargestBlock) {
  EXPECT_EQ(error_of({"stock.sizes_mm=[[600, 1200, 1200], [500, 500, 500]]", "stock.saw_mm=3"}), "");
  EXPECT_THAT(error_of({"stock.sizes_mm=[[1200, 1200, 500]]"}),
              HasSubstr("stock.max_size_mm (1200 x 1200 x 600): a block of that size is within none"));
  EXPECT_EQ(error_of({"stock.sizes_mm=[[1200, 1200, 500]]", "stock.max_size_mm=[500, 1000, 1000]"}), "");
  EXPECT_THAT(error_of({"stock.saw_mm=3"}), HasSubstr("given without stock.sizes_mm"));
  EXPECT_THAT(error_of({"stock.sizes_mm=[[1200, 1200]]"}), HasSubstr("must be a list of triples of numbers"));
  EXPECT_THAT(error_of({"stock.sizes_mm=[]"}), HasSubstr("must be a list of triples of numbers"));
}

}  // namespace
}  // namespace hotblade::pipeline

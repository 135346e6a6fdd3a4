#include "pipeline/stock/nest.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

namespace hotblade::pipeline {
namespace {

double volume(const BoxSize& s) {
  return s[0] * s[1] * s[2];
}

BoxSize longest_first(BoxSize s) {
  std::sort(s.begin(), s.end(), std::greater<>());
  return s;
}

// Saws the stock up as the cuts say, by code of its own: what comes out must be the pieces, one each, where
// they are said to lie.
void expect_sawn(const Nesting& nesting, const std::vector<BoxSize>& pieces, double saw_mm) {
  std::vector<int> seen(pieces.size(), 0);
  double bought = 0;
  for (const BoughtBlock& block : nesting.blocks) {
    bought += volume(block.size);
    std::vector<StockBox> parts{{{0, 0, 0}, block.size}};
    const auto same = [](const StockBox& a, const StockBox& b) {
      for (std::size_t k = 0; k < 3; ++k) {
        if (std::abs(a.at[k] - b.at[k]) > 1e-6 || std::abs(a.size[k] - b.size[k]) > 1e-6) return false;
      }
      return true;
    };
    for (const SawCut& cut : block.cuts) {
      ASSERT_LT(cut.part, parts.size());
      ASSERT_TRUE(same(parts[cut.part], cut.of)) << "a cut through what is no longer in one part";
      StockBox off = cut.of;
      const auto axis = static_cast<std::size_t>(cut.axis);
      ASSERT_GT(cut.at, 0);
      ASSERT_LT(cut.at, cut.of.size[axis]);
      parts[cut.part].size[axis] = cut.at;
      off.at[axis] += cut.at + saw_mm;
      off.size[axis] -= cut.at + saw_mm;
      ASSERT_EQ(cut.leaves(), off.size[axis] > 1e-6);
      if (!cut.leaves()) continue;
      ASSERT_TRUE(same(off, cut.off));
      parts.push_back(off);
    }
    std::set<std::size_t> taken;
    for (const NestedPiece& p : block.pieces) {
      ++seen.at(p.piece);
      const BoxSize is = longest_first(p.box.size), should = longest_first(pieces[p.piece]);
      for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(is[k], should[k], 1e-9);
      ASSERT_LT(p.part, parts.size());
      EXPECT_TRUE(same(parts[p.part], p.box)) << "piece " << p.piece << " does not come free";
      EXPECT_TRUE(taken.insert(p.part).second) << "two pieces are one part";
    }
  }
  for (const int times : seen) EXPECT_EQ(times, 1);
  EXPECT_NEAR(nesting.bought_mm3, bought, 1e-9 * bought);
}

TEST(Nest, EightEighthsFillABlock) {
  const std::vector<BoxSize> pieces(8, {300, 200, 100}), sizes{{600, 400, 200}};
  const Nesting nesting = nest(pieces, sizes, 0);
  ASSERT_EQ(nesting.blocks.size(), 1u);
  EXPECT_NEAR(nesting.bought_mm3, nesting.pieces_mm3, 1);
  EXPECT_NEAR(nesting.apart_mm3, 8 * nesting.bought_mm3, 1);
  expect_sawn(nesting, pieces, 0);
}

TEST(Nest, CountsWhatTheSawTakes) {
  const std::vector<BoxSize> sizes{{604, 200, 100}};
  EXPECT_EQ(nest(std::vector<BoxSize>(2, {300, 200, 100}), sizes, 4).blocks.size(), 1u);
  EXPECT_EQ(nest(std::vector<BoxSize>(2, {300, 200, 100}), sizes, 4.1).blocks.size(), 2u);
}

TEST(Nest, TakesTheSizesThatAreLeastFoam) {
  const std::vector<BoxSize> sizes{{1200, 1200, 600}, {100, 250, 300}, {1000, 500, 300}};
  const Nesting small = nest(std::vector<BoxSize>{{240, 90, 290}}, sizes, 3);
  ASSERT_EQ(small.blocks.size(), 1u);
  EXPECT_EQ(longest_first(small.blocks[0].size), (BoxSize{300, 250, 100}));
  // Ten of them in one of the middle size are less than ten of the small ones, or one of the large.
  const std::vector<BoxSize> ten(10, {240, 90, 290});
  const Nesting many = nest(ten, sizes, 3);
  EXPECT_LE(many.bought_mm3, 10 * volume({300, 250, 100}));
  expect_sawn(many, ten, 3);
}

// What three blocks were sawn into without any waste: the hardest case, whose least is known.
TEST(Nest, RejoinsWhatWasSawnUpInOneBlockMoreAtMost) {
  std::mt19937_64 random(7);
  const auto share = [&] { return 0.3 + 0.4 * static_cast<double>(random() % 1000) / 1000; };
  for (int trial = 0; trial < 20; ++trial) {
    const BoxSize stock{1200, 1000, 600};
    std::vector<BoxSize> pieces;
    for (int block = 0; block < 3; ++block) {
      std::vector<BoxSize> parts{stock};
      for (int cut = 0; cut < 5; ++cut) {
        const auto largest = std::max_element(
            parts.begin(), parts.end(), [](const auto& a, const auto& b) { return volume(a) < volume(b); });
        BoxSize a = *largest, b = *largest;
        const auto axis = static_cast<std::size_t>(std::max_element(a.begin(), a.end()) - a.begin());
        a[axis] *= share();
        b[axis] -= a[axis];
        parts.erase(largest);
        parts.push_back(a);
        parts.push_back(b);
      }
      pieces.insert(pieces.end(), parts.begin(), parts.end());
    }
    const Nesting nesting = nest(pieces, std::vector<BoxSize>{stock}, 0);
    expect_sawn(nesting, pieces, 0);
    EXPECT_LE(nesting.blocks.size(), 4u);
  }
}

TEST(Nest, OfRandomPiecesIsSawnWithoutTouching) {
  std::mt19937_64 random(11);
  const auto edge = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() % 100000) / 100000;
  };
  const std::vector<BoxSize> sizes{{2400, 1200, 600}, {1200, 1200, 600}, {1000, 500, 200}};
  for (int trial = 0; trial < 30; ++trial) {
    std::vector<BoxSize> pieces;
    const std::size_t count = 1 + random() % 25;
    for (std::size_t i = 0; i < count; ++i) pieces.push_back({edge(50, 1100), edge(50, 1100), edge(50, 580)});
    const Nesting nesting = nest(pieces, sizes, 5);
    expect_sawn(nesting, pieces, 5);
    EXPECT_LE(nesting.bought_mm3, nesting.apart_mm3 * (1 + 1e-12));
    EXPECT_GE(nesting.bought_mm3, nesting.pieces_mm3);
    std::vector<BoxSize> other{{600, 2400, 1200}, {200, 500, 1000}, {1200, 600, 1200}, {1200, 1200, 600}};
    EXPECT_EQ(nest(pieces, other, 5).bought_mm3, nesting.bought_mm3);
  }
}

TEST(Nest, EndsWhereItsWatchThrows) {
  struct Ended {};
  EXPECT_THROW((void)nest(std::vector<BoxSize>(3, {100, 100, 100}), std::vector<BoxSize>{{600, 600, 600}}, 0,
                          [] { throw Ended(); }),
               Ended);
}

TEST(Nest, RefusesWhatNoStockHolds) {
  EXPECT_THROW((void)nest(std::vector<BoxSize>{{700, 10, 10}}, std::vector<BoxSize>{{600, 600, 600}}, 0),
               std::logic_error);
  EXPECT_THROW((void)nest(std::vector<BoxSize>{{0, 10, 10}}, std::vector<BoxSize>{{600, 600, 600}}, 0),
               std::logic_error);
  EXPECT_THROW((void)nest(std::vector<BoxSize>{{5, 10, 10}}, std::vector<BoxSize>{{NAN, 600, 600}}, 0),
               std::logic_error);
  EXPECT_TRUE(nest({}, std::vector<BoxSize>{{600, 600, 600}}, 0).blocks.empty());
}

TEST(Nest, PartsAreNamedByLetters) {
  EXPECT_EQ(part_name(0), "A");
  EXPECT_EQ(part_name(25), "Z");
  EXPECT_EQ(part_name(26), "AA");
  EXPECT_EQ(part_name(27), "AB");
  EXPECT_EQ(part_name(26 + 26 * 26), "AAA");
}

}  // namespace
}  // namespace hotblade::pipeline

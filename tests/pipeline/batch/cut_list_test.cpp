// What a batch takes of foam and blades, what is written on the foam, and the order of cutting.
#include "pipeline/batch/cut_list.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>
#include <set>
#include <stdexcept>

#include "pipeline/batch/csv.hpp"
#include "pipeline/batch/cut_page.hpp"
#include "pipeline/batch/gather.hpp"
#include "tests/pipeline/batch/stand_in.hpp"

namespace hotblade::pipeline::batch {
namespace {

using namespace testing;
using pipeline::testing::read_bytes;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Pair;

// Jobs with plans whose strips have blades and blocks as a test says.
class Plans {
 public:
  struct Block {
    double blade_mm;
    BlockSize size_mm;
    double machine_s;
    double thickness_mm = 0.5;
  };

  void add(const std::string& panel, const std::string& verdict, const std::vector<Block>& blocks) {
    Job& job = jobs_.emplace_back();
    job.number = jobs_.size();
    job.panel = panel;
    job.key = "key of " + panel + std::to_string(job.number);
    PlanFacts& facts = facts_.emplace_back();
    facts.cells.resize(plan_columns().size());
    double machine_s = 0;
    for (const Block& block : blocks) {
      Cells strip(strip_columns().size());
      const auto set = [&](const char* column, double value) {
        strip[strip_column(column)] = {std::to_string(value), true};
      };
      strip[0] = {"S00" + std::to_string(facts.strips.size() + 1), false};
      set("blade_length_mm", block.blade_mm);
      set("blade_width_mm", 8);
      set("blade_thickness_mm", block.thickness_mm);
      set("stock_x_mm", block.size_mm[0]);
      set("stock_y_mm", block.size_mm[1]);
      set("stock_z_mm", block.size_mm[2]);
      set("machine_s", block.machine_s);
      set("cut_s", block.machine_s / 2);
      machine_s += block.machine_s;
      facts.strips.push_back(std::move(strip));
    }
    facts.cells[plan_column("verdict")] = {verdict, false};
    facts.cells[plan_column("machine_s")] = {std::to_string(machine_s), true};
  }

  [[nodiscard]] CutList list(double step_mm = 1) const {
    std::vector<JobFacts> rows;
    for (std::size_t i = 0; i < jobs_.size(); ++i) rows.push_back({&jobs_[i], &facts_[i]});
    return cut_list(rows, step_mm);
  }

 private:
  std::deque<Job> jobs_;
  std::deque<PlanFacts> facts_;
};

std::vector<std::string> order(const CutList& list) {
  std::vector<std::string> blocks;
  for (const CutBlock& block : list.blocks) blocks.push_back(block.panel + " " + block.strip);
  return blocks;
}

TEST(CutList, MountsEachBladeOnceAndKeepsThePanelsTogether) {
  Plans plans;
  plans.add("b", "passed", {{600, {10, 10, 10}, 1}, {400, {10, 10, 10}, 1}, {600, {10, 10, 10}, 1}});
  plans.add("a", "passed", {{400, {10, 10, 10}, 1}, {600, {10, 10, 10}, 1}, {400, {10, 10, 10}, 1, 0.7}});
  const CutList list = plans.list();
  EXPECT_THAT(order(list), ElementsAre("b S002", "a S001", "b S001", "b S003", "a S002", "a S003"));
  // The table mounts a blade as often as there are blades: no order changes it less often.
  const CsvTable table = parse_csv(cut_list_table(list), "cut_list.csv");
  int mounted = 0;
  for (const CsvRow& row : table.rows) mounted += row.cells[table.column("mount_blade")] == "1" ? 1 : 0;
  EXPECT_EQ(mounted, 3);
  EXPECT_EQ(list.blades.size(), 3U);
}

TEST(CutList, TakesOfEachPanelTheCaseThatPassedInTheLeastMachineTime) {
  Plans plans;
  plans.add("a", "refused", {{400, {10, 10, 10}, 1}});
  plans.add("a", "passed", {{600, {10, 10, 10}, 9}});
  plans.add("a", "passed", {{800, {10, 10, 10}, 3}, {800, {10, 10, 10}, 4}});
  plans.add("b", "over tolerance", {{400, {10, 10, 10}, 1}});
  const CutList list = plans.list();
  EXPECT_THAT(order(list), ElementsAre("a S001", "a S002"));
  EXPECT_EQ(list.blocks[0].job, 3U);
  EXPECT_EQ(list.panels, 2U);
  EXPECT_EQ(list.not_cut, 1U);
  EXPECT_DOUBLE_EQ(list.all.machine_s, 7);
  EXPECT_THAT(cut_page("facade", list), HasSubstr("1 panels are not among them"));
}

TEST(CutList, CountsBlocksByTheSizeThatIsBoughtAndFoamByTheSizeThatIsCut) {
  Plans plans;
  plans.add("a", "passed", {{400, {1000, 499.2, 400}, 3600}, {400, {400, 1000, 500}, 3600}});
  plans.add("b", "passed", {{400, {400, 500.5, 1000}, 3600}});
  const CutList list = plans.list();
  EXPECT_NEAR(list.all.foam_m3, 0.4 * (0.4992 + 0.5 + 0.5005), 1e-12);
  const auto counts = [](const CutList& of) {
    std::vector<std::pair<std::string, std::size_t>> sizes;
    for (const auto& [size, sum] : of.sizes) sizes.emplace_back(size_text(size), sum.blocks);
    return sizes;
  };
  EXPECT_THAT(counts(list), ElementsAre(Pair("1000 × 500 × 400", 2U), Pair("1000 × 501 × 400", 1U)));
  EXPECT_THAT(counts(plans.list(50)),
              ElementsAre(Pair("1000 × 500 × 400", 2U), Pair("1000 × 550 × 400", 1U)));
  EXPECT_THROW((void)plans.list(0), std::logic_error);
}

TEST(CutList, AnIdTellsANumberMisreadAndAPanelThatMoved) {
  Job job;
  job.number = 12;
  job.key = "c0ffee";
  const std::string id = block_id(job, "S003");
  EXPECT_THAT(id, ::testing::MatchesRegex("12-3-[ACEFHJKLMNPRTWXY][ACEFHJKLMNPRTWXY]"));
  EXPECT_EQ(block_id(job, "S003"), id);
  // Of other numbers and other plans, letters that are the same by chance: 1 of 256.
  const std::string letters = id.substr(5);
  int same = 0;
  std::set<std::string> all;
  for (std::size_t other = 1; other <= 2560; ++other) {
    Job one = job;
    one.number = other;
    all.insert(block_id(one, "S003"));
    same += block_id(one, "S003").ends_with(letters) ? 1 : 0;
    one = job;
    one.key += std::to_string(other);
    same += block_id(one, "S003").ends_with(letters) ? 1 : 0;
  }
  EXPECT_EQ(all.size(), 2560U);
  EXPECT_LT(same, 40);  // 20 are expected
}

TEST(CutList, IsWrittenByGatherAndByItself) {
  const StandInBatch batch({20, kRefused, 21});
  (void)batch.run();
  (void)gather(batch.directory(), false, {});
  const std::filesystem::path directory = batch.directory().path();
  const std::string table = read_bytes(directory / "cut_list.csv"),
                    page = read_bytes(directory / "cut_list.html");
  const CsvTable rows = parse_csv(table, "cut_list.csv");
  ASSERT_EQ(rows.rows.size(), 2U);
  const auto cell = [&](const char* column) { return rows.rows[1].cells[rows.column(column)]; };
  EXPECT_EQ(cell("panel"), "p21");
  EXPECT_EQ(cell("job"), "3");
  EXPECT_EQ(cell("blade_length_mm"), "400");
  EXPECT_EQ(cell("blade_thickness_mm"), "0.5");
  EXPECT_EQ(cell("stock_m3"), "0.2");
  EXPECT_EQ(cell("mount_blade"), "0");
  EXPECT_THAT(page, HasSubstr(cell("id")));
  EXPECT_THAT(page, HasSubstr("2 blocks of 2 panels, 0.40 m³ of foam"));
  EXPECT_THAT(page, Not(HasSubstr("http")));
  EXPECT_THAT(page, Not(HasSubstr("<script")));
  EXPECT_THAT(read_bytes(directory / "index.html"), HasSubstr("href=\"cut_list.html\""));
  std::filesystem::remove(directory / "cut_list.csv");
  const StockReport report = list_stock(batch.directory(), false, 1, {});
  EXPECT_EQ(report.list.all.blocks, 2U);
  EXPECT_EQ(read_bytes(directory / "cut_list.csv"), table);
  EXPECT_EQ(read_bytes(directory / "cut_list.html"), page);
}

}  // namespace
}  // namespace hotblade::pipeline::batch

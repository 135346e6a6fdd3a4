// What the tables and the page of a batch say.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <nlohmann/json.hpp>

#include "pipeline/batch/csv.hpp"
#include "pipeline/batch/gather.hpp"
#include "pipeline/batch/status.hpp"
#include "pipeline/settings/error.hpp"
#include "tests/pipeline/batch/stand_in.hpp"

namespace hotblade::pipeline::batch {
namespace {

namespace fs = std::filesystem;
using namespace testing;
using pipeline::testing::read_bytes;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Pair;

// The first column of a query's rows.
std::vector<std::string> query(const fs::path& file, const std::string& sql) {
  sqlite3* database = nullptr;
  EXPECT_EQ(::sqlite3_open_v2(file.c_str(), &database, SQLITE_OPEN_READONLY, nullptr), SQLITE_OK);
  std::vector<std::string> values;
  const auto take = [](void* list, int, char** cells, char**) {
    static_cast<std::vector<std::string>*>(list)->emplace_back(cells[0] != nullptr ? cells[0] : "NULL");
    return 0;
  };
  EXPECT_EQ(::sqlite3_exec(database, sql.c_str(), take, &values, nullptr), SQLITE_OK)
      << ::sqlite3_errmsg(database);
  ::sqlite3_close(database);
  return values;
}

TEST(Batch, TablesHaveEveryJobAndWhatItCameTo) {
  const StandInBatch batch({20, kRefused, kBadInput});
  (void)batch.run();
  EXPECT_EQ(gather(batch.directory(), false, {}).missing, 0U);
  const fs::path directory = batch.directory().path();
  const CsvTable table = read_csv(directory / "results.csv");
  ASSERT_EQ(table.rows.size(), 3U);
  const auto cell = [&](std::size_t row, const char* column) {
    return table.rows[row].cells.at(table.column(column));
  };
  EXPECT_EQ(cell(0, "panel"), "p20");
  EXPECT_EQ(cell(0, "verdict"), "passed");
  EXPECT_EQ(cell(0, "deviation_max_mm"), "0.25");
  EXPECT_EQ(cell(0, "waypoints"), "100");
  EXPECT_EQ(cell(0, "machine_s"), "20.5");
  EXPECT_EQ(cell(0, "stock_m3"), "0.2");
  EXPECT_EQ(cell(0, "foam_kept_share"), "0.5");
  EXPECT_EQ(cell(1, "worst_refusal"), "deviation");
  EXPECT_EQ(cell(2, "deviation_max_mm"), "");
  EXPECT_TRUE(fs::exists(directory / cell(0, "report")));
  const fs::path database = directory / "results.sqlite";
  EXPECT_THAT(query(database, "SELECT verdict FROM jobs ORDER BY job"),
              ElementsAre("passed", "refused", "bad input"));
  EXPECT_THAT(query(database, "SELECT typeof(deviation_max_mm) FROM jobs ORDER BY job"),
              ElementsAre("real", "real", "null"));
  EXPECT_THAT(query(database, "SELECT panel FROM strips JOIN jobs USING (job) WHERE stock_x_mm = 1000"),
              ElementsAre("p20", "p904"));
  EXPECT_THAT(query(database, "SELECT message FROM refusals"), ElementsAre("S001: deviation 2 mm (limit 1)"));
  EXPECT_THAT(query(database, "SELECT DISTINCT text FROM warnings"), ElementsAre("a warning"));
  EXPECT_THAT(query(database, "SELECT value FROM settings WHERE key = 'design.tolerance_mm' AND job = 2"),
              ElementsAre("1.0"));
}

// A plan whose error budget is over its tolerance is told from one that is within it, wherever it is listed.
TEST(Batch, AmberIsSaidWhereverAPlanIs) {
  const StandInBatch batch({20, kPassesAmber, kRefused, 21});
  (void)batch.run();
  const BatchStatus status = status_of(batch.directory());
  EXPECT_THAT(status.colors, ElementsAre(Pair("amber", 1U), Pair("green", 2U)));
  EXPECT_EQ(to_json(status)["colors"]["amber"], 1);
  (void)gather(batch.directory(), false, {});
  const fs::path directory = batch.directory().path();
  const CsvTable table = read_csv(directory / "results.csv");
  std::vector<std::string> colors;
  for (const auto& row : table.rows)
    colors.push_back(row.cells.at(table.column("verdict")) + " " + row.cells.at(table.column("color")));
  EXPECT_THAT(colors, ElementsAre("passed green", "passed amber", "refused green", "passed green"));
  EXPECT_THAT(query(directory / "results.sqlite", "SELECT panel FROM jobs WHERE color = 'amber'"),
              ElementsAre("p921"));
  const std::string page = read_bytes(directory / "index.html");
  EXPECT_THAT(page, AllOf(HasSubstr("<dt>of them amber</dt><dd class=\"amber\">1<"),
                          HasSubstr("<span class=\"amber\">passed, amber</span>"),
                          HasSubstr("<option>amber</option>")));
  EXPECT_LT(page.find("data-c=\"amber\""), page.find("<span class=\"passed\">"));  // before green ones
  const CsvTable cut = read_csv(directory / "cut_list.csv");
  for (const auto& row : cut.rows) {
    EXPECT_EQ(row.cells.at(cut.column("amber")), row.cells.at(cut.column("panel")) == "p921" ? "1" : "0");
  }
  const std::string list = read_bytes(directory / "cut_list.html");
  EXPECT_THAT(list, AllOf(HasSubstr("p921 <b class=\"amber\">amber</b>"), HasSubstr("1 panels are amber"),
                          HasSubstr("as no plan passed: p904.")));
  const CutList blocks = list_stock(batch.directory(), false, 1, {}).list;
  EXPECT_THAT(blocks.not_cut_panels, ElementsAre("p904"));
  EXPECT_THAT(blocks.amber_panels, ElementsAre("p921"));
}

TEST(Batch, TheBestCaseOfAPanelIsTheOneOfLeastMachineTimeThatPassed) {
  const StandInBatch batch({20, kRefused});
  Asked asked = batch.asked();
  asked.sweeps = {"design.tolerance_mm=1,2"};
  (void)init_batch(batch.directory(), asked, true, {});
  (void)batch.run();
  (void)gather(batch.directory(), false, {});
  const fs::path database = batch.directory().path() / "results.sqlite";
  EXPECT_THAT(query(database, "SELECT panel FROM best"), ElementsAre("p20"));
  EXPECT_THAT(query(database, "SELECT \"design.tolerance_mm\" FROM jobs WHERE panel = 'p20'"),
              ElementsAre("1", "2"));
}

TEST(Batch, AJobWithoutAResultIsGatheredOnlyWhenAsked) {
  const StandInBatch batch({20, kExits});
  (void)batch.run();
  try {
    (void)gather(batch.directory(), false, {});
    ADD_FAILURE() << "gathered";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind, ErrorKind::kFile);
    EXPECT_THAT(error.what(), HasSubstr("job 2 (panel p901) has no result"));
  }
  EXPECT_FALSE(fs::exists(batch.directory().path() / "results.csv"));
  EXPECT_EQ(gather(batch.directory(), true, {}).missing, 1U);
  const CsvTable table = read_csv(batch.directory().path() / "results.csv");
  EXPECT_EQ(table.rows[1].cells[table.column("verdict")], "failed");
  EXPECT_EQ(table.rows[1].cells[table.column("message")], "exit code 1: internal error: broken");
  const std::string page = read_bytes(batch.directory().path() / "index.html");
  EXPECT_LT(page.find("data-v=\"failed\""), page.find("data-v=\"passed\""));  // failures first
}

TEST(Batch, AReportThatWasChangedIsNoneOfItsResult) {
  const StandInBatch batch({20});
  (void)batch.run();
  const fs::path report =
      batch.directory().result(read_chunk(batch.directory(), 0).front().key) / "report.json";
  std::string text = read_bytes(report);
  std::ofstream(report) << text.replace(text.find("0.25"), 4, "0.15");
  EXPECT_THAT(thrown([&] { (void)gather(batch.directory(), false, {}); }),
              AllOf(HasSubstr("report.json: was changed"), HasSubstr("remove its directory")));
}

TEST(Batch, ThePageNeedsNoNetworkAndEscapesNames) {
  const StandInBatch batch({20});
  std::string text = read_bytes(batch.asked().design);
  std::ofstream(batch.asked().design) << text.replace(text.find("g p20"), 5, "g <b>&\"x\"");
  (void)init_batch(batch.directory(), std::nullopt, true, {});
  (void)batch.run();
  (void)gather(batch.directory(), false, {});
  const std::string page = read_bytes(batch.directory().path() / "index.html");
  EXPECT_THAT(page, AllOf(HasSubstr("&lt;b&gt;&amp;&quot;x&quot;</a>"), Not(HasSubstr("<b>")),
                          Not(HasSubstr("http")), Not(HasSubstr("@import"))));
  const auto script = page.find("<script>");
  EXPECT_LT(page.find("</script>") - script, 10'000U);
}

TEST(Batch, GatheringTwiceGivesTheSameBytes) {
  const StandInBatch batch({20, 21, kRefused});
  (void)batch.run();
  const auto bytes = [&] {
    (void)gather(batch.directory(), false, {});
    return read_bytes(batch.directory().path() / "results.csv") +
           read_bytes(batch.directory().path() / "index.html");
  };
  EXPECT_EQ(bytes(), bytes());
}

// The messages and warnings of a gathered batch.
struct Said {
  std::vector<std::string> messages, warnings;
};
Said said_by(const StandInBatch& batch) {
  (void)gather(batch.directory(), false, {});
  const fs::path database = batch.directory().path() / "results.sqlite";
  return {query(database, "SELECT message FROM jobs WHERE verdict = 'bad input' ORDER BY job"),
          query(database, "SELECT text FROM warnings WHERE text LIKE '%cross%' ORDER BY job")};
}

TEST(Batch, TablesNameTheLinesOfTheFacade) {
  const StandInBatch batch({20, kBadInput, 21, kCrosses});
  (void)batch.run();
  const std::string facade = batch.asked().design;
  const std::size_t second = 2 * kSquarePanelLines, fourth = 4 * kSquarePanelLines;
  const Said said = said_by(batch);
  EXPECT_THAT(said.messages, ElementsAre(facade + ":" + std::to_string(second) + ": no face has an area"));
  const std::string line = std::to_string(fourth);
  EXPECT_THAT(said.warnings, ElementsAre("2 pairs of faces cross, the first those of lines " + line +
                                         " and " + line + " near (1, 2, 3)"));
  // Another panel before them moves the lines, though nothing is planned again.
  const std::string text = read_bytes(facade);
  std::ofstream(facade) << square_panel("first", 5) + text;
  (void)init_batch(batch.directory(), std::nullopt, true, {});
  EXPECT_EQ(batch.run().planned, 1U);
  EXPECT_THAT(said_by(batch).messages, ElementsAre(facade + ":" + std::to_string(second + kSquarePanelLines) +
                                                   ": no face has an area"));
}

TEST(Batch, LinesOfAFacadeThatHasChangedSinceAreNotNamed) {
  const StandInBatch batch({20, kBadInput});
  (void)batch.run();
  const std::string facade = batch.asked().design, text = read_bytes(facade);
  std::ofstream(facade) << std::string(text).replace(text.find(" 903.5"), 6, " 903.6");
  EXPECT_THAT(said_by(batch).messages,
              ElementsAre(AllOf(HasSubstr("designs/"), HasSubstr(".obj:5: no face"))));
  fs::remove(facade);
  EXPECT_THAT(said_by(batch).messages, ElementsAre(HasSubstr("designs/")));
}

TEST(Batch, TablesNameTheFilesOfAListAndTheirLines) {
  const pipeline::testing::TemporaryDirectory files;
  const StandInBatch batch({20});
  const std::string odd = "# a comment\n" + square_panel("a", 1) + square_panel("b", kBadInput + 0.5);
  std::ofstream(files / "odd.obj") << odd;
  std::ofstream(files / "list.csv") << "path,units,group\nodd.obj,mm,b\nodd.obj,mm,a\n";
  Asked asked;
  asked.list = (files / "list.csv").string();
  (void)init_batch(batch.directory(), asked, true, {});
  (void)batch.run();
  const std::string line = std::to_string(1 + 2 * kSquarePanelLines);
  EXPECT_THAT(said_by(batch).messages,
              ElementsAre((files / "odd.obj").string() + ":" + line + ": no face has an area"));
}

}  // namespace
}  // namespace hotblade::pipeline::batch

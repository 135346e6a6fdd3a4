// What `place` leaves in a directory, and how a program's cell is named.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "pipeline/program/program.hpp"
#include "pipeline/program/sha256.hpp"
#include "tests/paths.hpp"
#include "tests/pipeline/run_program.hpp"
#include "tests/pipeline/temporary_directory.hpp"

namespace hotblade::pipeline {
namespace {

namespace fs = std::filesystem;
using testing::Ended;
using ::testing::HasSubstr;
using testing::hotblade;
using testing::read_bytes;

class PlacedProgram : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    planned_ = std::make_unique<testing::TemporaryDirectory>();
    const std::string samples = hotblade::testing::source_dir() + "/samples/";
    const Ended ended = hotblade({"plan", samples + "hypar.obj", "--config", samples + "hypar.toml", "-o",
                                  planned_->path().string(), "--force", "--no-pictures"});
    ASSERT_EQ(ended.code, 0) << ended.err;
  }
  static void TearDownTestSuite() { planned_.reset(); }
  void SetUp() override { fs::copy(planned_->path(), cut_, fs::copy_options::recursive); }

  // Places the plan's program with its block raised by 200 mm at least.
  [[nodiscard]] Ended place(const fs::path& to, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{
        "place", (cut_ / "program.json").string(), "--cell", cell_.string(), "-o", to.string()};
    words.insert(words.end(), more.begin(), more.end());
    return hotblade(words);
  }

  // The shipped cell, in which blocks stand higher.
  void write_cell() const {
    std::string text = hotblade({"cell", "show"}).out;
    const std::string key = "raise_mm = [";
    const std::size_t at = text.find(key);
    ASSERT_NE(at, std::string::npos);
    text.replace(at, text.find(']', at) + 1 - at, "raise_mm = [200, 400]");
    std::ofstream(cell_) << text;
  }

  // What the sheets say of each block is where the program has it.
  static void expect_sheets_of(const fs::path& directory) {
    const std::string text = read_bytes(directory / "program.json"),
                      sheets = read_bytes(directory / "sheets.html");
    const Program program = read_program(directory / "program.json");
    for (const Strip& strip : program.strips) {
      const double mm = strip.block.height_above_table_mm(strip.design_to_cell);
      EXPECT_THAT(sheets, HasSubstr(", " + std::to_string(std::lround(mm)) + " mm above the table"));
    }
    EXPECT_THAT(sheets, HasSubstr(sha256_hex(text).substr(0, 12)));
  }

  inline static std::unique_ptr<testing::TemporaryDirectory> planned_;
  testing::TemporaryDirectory files_;
  fs::path cut_ = files_ / "cut", cell_ = files_ / "my cell.toml";
};

TEST_F(PlacedProgram, InThePlansOwnDirectoryLeavesNothingOfThePlanThatIsNotTrue) {
  write_cell();
  std::ofstream(cut_ / "mine.txt") << "mine";
  const std::string before = read_bytes(cut_ / "sheets.html");
  const Ended ended = place(cut_, {"--force"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("of the program before, and gone: report.json, report.html"));
  EXPECT_NE(read_bytes(cut_ / "sheets.html"), before);
  expect_sheets_of(cut_);
  for (const char* name : {"report.json", "report.html", "preview.png", "scene.gltf"})
    EXPECT_FALSE(fs::exists(cut_ / name)) << name;
  EXPECT_TRUE(fs::exists(cut_ / "ribs" / "S001.dxf"));
  EXPECT_EQ(read_bytes(cut_ / "mine.txt"), "mine");
}

TEST_F(PlacedProgram, FindsItsDesignFromANewDirectory) {
  write_cell();
  const fs::path armed = files_ / "armed";
  ASSERT_EQ(place(armed).code, 0);
  expect_sheets_of(armed);
  const std::string program = (armed / "program.json").string();
  const Ended verified = hotblade({"verify", program});
  EXPECT_EQ(verified.code, 0) << verified.err;
  const Ended run = hotblade({"dryrun", program});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("as cut: deviation max"));
}

TEST_F(PlacedProgram, LeavesEverythingAsItWasWhereItIsNotWritten) {
  write_cell();
  const std::string sheets = read_bytes(cut_ / "sheets.html"), program = read_bytes(cut_ / "program.json");
  const Ended there = place(cut_);
  EXPECT_EQ(there.code, 7);
  EXPECT_THAT(there.err, HasSubstr("--force"));
  fs::create_directory(cut_ / "preview.png");
  const Ended blocked = place(cut_, {"--force"});
  EXPECT_EQ(blocked.code, 7);
  EXPECT_THAT(blocked.err, HasSubstr("preview.png"));
  EXPECT_EQ(read_bytes(cut_ / "sheets.html"), sheets);
  EXPECT_EQ(read_bytes(cut_ / "program.json"), program);
  EXPECT_TRUE(fs::exists(cut_ / "report.json"));
}

TEST_F(PlacedProgram, IsWrittenPackedInThePlaceOfThePlainOne) {
  write_cell();
  ASSERT_EQ(place(cut_, {"--force", "--gzip"}).code, 0);
  EXPECT_FALSE(fs::exists(cut_ / "program.json"));
  EXPECT_EQ(hotblade({"verify", (cut_ / "program.json.gz").string()}).code, 0);
}

// The words after "give --cell " of a dry run work as they stand.
TEST_F(PlacedProgram, NamesACellAsTheOptionTakesIt) {
  write_cell();
  const std::string own = (files_ / "own").string(), shipped = (files_ / "shipped").string();
  ASSERT_EQ(place(own).code, 0);
  EXPECT_THAT(hotblade({"dryrun", own + "/program.json"}).out,
              HasSubstr("give --cell two_irb4600\n"));  // raise_mm is no part of what joints belong to
  ASSERT_EQ(
      hotblade({"place", (cut_ / "program.json").string(), "--cell", "two_irb4600", "-o", shipped}).code, 0);
  const Ended exported =
      hotblade({"export", shipped + "/program.json", "--format", "rapid", "-o", (files_ / "r").string()});
  EXPECT_EQ(exported.code, 2);
  EXPECT_THAT(exported.err, HasSubstr("give --cell two_irb4600\n"));
  EXPECT_EQ(hotblade({"dryrun", shipped + "/program.json", "--cell", "two_irb4600"}).code, 0);

  std::string text = read_bytes(cell_);
  const std::string key = "joint_margin_deg = 3";
  const std::size_t at = text.find(key);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, key.size(), "joint_margin_deg = 4");
  std::ofstream(cell_) << text;
  ASSERT_EQ(place(own, {"--force"}).code, 0);
  EXPECT_THAT(hotblade({"dryrun", own + "/program.json"}).out,
              HasSubstr("give --cell '" + cell_.string() + "'\n"));
  fs::remove(cell_);
  EXPECT_THAT(hotblade({"dryrun", own + "/program.json"}).out,
              HasSubstr("give --cell with the file of the cell \"two IRB 4600\"\n"));
}

// A blade that melts more where it is slower, in a cell whose arms make it so.
class PlacedMelt : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    planned_ = std::make_unique<testing::TemporaryDirectory>();
    const std::string samples = hotblade::testing::source_dir() + "/samples/";
    const Ended ended = hotblade({"plan", samples + "hypar.obj", "--config", samples + "hypar.toml", "--set",
                                  "foam.melt_mm2_s=10", "--set", "foam.loss_mm_s=1", "-o",
                                  planned_->path().string(), "--force", "--no-pictures"});
    ASSERT_EQ(ended.code, 0) << ended.err;
  }
  static void TearDownTestSuite() { planned_.reset(); }

  // The shipped cell, with arms that are hundreds of times slower.
  [[nodiscard]] std::string slow_cell() const {
    std::string text = read_bytes(hotblade::testing::source_dir() + "/samples/cells/two_irb4600.toml");
    const std::string share = "speed_share = 0.8";
    for (std::size_t at = text.find(share); at != std::string::npos; at = text.find(share, at + 1))
      text.replace(at, share.size(),
                   "speed_share = 0.01\nacceleration_rad_s2 = [0.01, 0.01, 0.01, 0.01, 0.01, 0.01]");
    const fs::path file = files_ / "slow.toml";
    std::ofstream(file) << text;
    return file.string();
  }

  [[nodiscard]] Ended place(const fs::path& program, const std::string& cell,
                            const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"place", program.string(), "--cell", cell, "-o", armed_.string()};
    words.insert(words.end(), more.begin(), more.end());
    return hotblade(words);
  }

  inline static std::unique_ptr<testing::TemporaryDirectory> planned_;
  testing::TemporaryDirectory files_;
  fs::path armed_ = files_ / "armed";
};

TEST_F(PlacedMelt, IsRefusedWhereSlowArmsMakeItCutBeyondTheTolerance) {
  const Ended refused = place(*planned_ / "program.json", slow_cell());
  EXPECT_EQ(refused.code, 4);
  EXPECT_THAT(refused.err, HasSubstr("refused: S001"));
  EXPECT_THAT(refused.err, HasSubstr("deviation 1."));
  EXPECT_FALSE(fs::exists(armed_));
}

TEST_F(PlacedMelt, HasTheFiguresOfItsOwnCut) {
  const Ended placed = place(*planned_ / "program.json", "two_irb4600");
  ASSERT_EQ(placed.code, 0) << placed.err;
  const Program before = read_program(*planned_ / "program.json"),
                program = read_program(armed_ / "program.json");
  const Ended verified = hotblade({"verify", (armed_ / "program.json").string(), "--json"});
  EXPECT_EQ(verified.code, 0) << verified.err;
  const auto measured = nlohmann::json::parse(verified.out);
  const double most = measured.at("deviation_mm").at("max").get<double>();
  EXPECT_NE(most, before.verification.deviation_mm.max);
  EXPECT_NEAR(program.verification.deviation_mm.max, most, 1e-9);
  // What no measurement tells is as it was planned.
  ASSERT_EQ(program.verification.budget_mm.size(), before.verification.budget_mm.size());
  for (std::size_t i = 0; i < before.verification.budget_mm.size(); ++i) {
    const auto& [line, mm] = before.verification.budget_mm[i];
    EXPECT_EQ(program.verification.budget_mm[i].first, line);
    if (line == "between_ribs") continue;
    EXPECT_NEAR(program.verification.budget_mm[i].second, mm, 1e-12) << line;
  }
  EXPECT_THAT(program.verification.not_checked,
              ::testing::Not(::testing::Contains("arm reach and arm collision")));
}

TEST_F(PlacedMelt, AsksForTheDesignThatItCannotBeMeasuredWithout) {
  const fs::path alone = files_ / "program.json";
  fs::copy_file(*planned_ / "program.json", alone);
  const Ended without = place(alone, slow_cell());
  EXPECT_EQ(without.code, 7);
  EXPECT_THAT(without.err, HasSubstr("say --design FILE"));
  EXPECT_FALSE(fs::exists(armed_));
  const std::string design = hotblade::testing::source_dir() + "/samples/hypar.obj";
  const Ended placed = place(alone, "two_irb4600", {"--design", design});
  EXPECT_EQ(placed.code, 0) << placed.err;
  EXPECT_EQ(hotblade({"verify", (armed_ / "program.json").string()}).code, 0);
}

TEST_F(PlacedMelt, IsNotCalledGreenByVerifyWhereItDoesNotHold) {
  const fs::path alone = files_ / "program.json";
  std::string text = read_bytes(*planned_ / "program.json");
  const std::string key = "\"tolerance_mm\":";
  const std::size_t at = text.find(key, text.rfind("\"verification\""));
  ASSERT_NE(at, std::string::npos);
  text.replace(at, text.find(',', at) - at, key + "0.01");
  std::ofstream(alone) << text;
  const Ended verified = hotblade(
      {"verify", alone.string(), "--design", hotblade::testing::source_dir() + "/samples/hypar.obj"});
  EXPECT_EQ(verified.code, 5);
  EXPECT_THAT(verified.out,
              ::testing::EndsWith("verdict red: measured now, the program does not hold: it says passed\n"));
  EXPECT_THAT(verified.out, ::testing::Not(HasSubstr("can be cut")));
}

}  // namespace
}  // namespace hotblade::pipeline

// A design of any name: names of files are bytes, and what is written of them is UTF-8.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "pipeline/settings/json_text.hpp"
#include "tests/paths.hpp"
#include "tests/pipeline/run_program.hpp"

namespace hotblade::pipeline {
namespace {

namespace fs = std::filesystem;
using testing::Ended;
using ::testing::HasSubstr;
using testing::hotblade;
using Words = std::vector<std::string>;

const std::string kSamples = hotblade::testing::source_dir() + "/samples/";

// A sample under a name, in a folder, that no UTF-8 has; and where its plan goes.
class AnyName : public ::testing::Test {
 protected:
  AnyName() {
    fs::create_directory(folder_);
    fs::copy_file(kSamples + "barrel_vault.obj", file_);
  }
  [[nodiscard]] std::string cut() const { return (files_ / "cut").string(); }
  [[nodiscard]] std::string program() const { return cut() + "/program.json"; }

  // Plans it there.
  [[nodiscard]] Ended plan(const Words& more = {}) const {
    Words words{"plan", file_, "--units", "mm", "--config", kSamples + "barrel_vault.toml", "-o", cut()};
    words.insert(words.end(), more.begin(), more.end());
    return hotblade(words);
  }

  // Checks that every text of a plan is UTF-8, and that the JSON and pages have the name.
  void expect_texts() const {
    std::size_t texts = 0;
    for (const auto& entry : fs::recursive_directory_iterator(cut())) {
      const std::string kind = entry.path().extension();
      const bool names = kind == ".json" || kind == ".html";
      if (!names && kind != ".dxf" && kind != ".gltf") continue;
      const std::string text = testing::read_bytes(entry.path());
      EXPECT_TRUE(is_utf8(text)) << entry.path();
      if (names && entry.path().filename() != "beziers.json") {
        EXPECT_THAT(text, HasSubstr("v\ufffd.obj")) << entry.path();
      }
      ++texts;
    }
    EXPECT_GE(texts, 4u);
  }

  testing::TemporaryDirectory files_;
  std::string folder_ = (files_ / "d\xfe").string();
  std::string file_ = folder_ + "/v\xff.obj";
};

TEST_F(AnyName, IsPlannedMeasuredDrawnAndRun) {
  const Ended checked = hotblade({"check", file_, "--units", "mm", "--json"});
  EXPECT_EQ(checked.code, 0) << checked.err;
  EXPECT_EQ(nlohmann::json::parse(checked.out).at("file"), "v\ufffd.obj");
  const Ended planned = plan({"--json"});
  ASSERT_EQ(planned.code, 0) << planned.err;
  EXPECT_EQ(nlohmann::json::parse(planned.out).at("design").at("file"), "v\ufffd.obj");
  expect_texts();
  // The design is found again where run.json says.
  const Ended verified = hotblade({"verify", program(), "--json"});
  EXPECT_EQ(verified.code, 0) << verified.err;
  EXPECT_TRUE(nlohmann::json::parse(verified.out).at("within_tolerance"));
  const std::string shot = (files_ / "shot.png").string();
  const Ended seen = hotblade({"preview", program(), "--shot", shot});
  EXPECT_EQ(seen.code, 0) << seen.err;
  EXPECT_EQ(hotblade({"preview", file_, "--units", "mm", "--shot", shot, "--force"}).code, 0);
  const Ended dry = hotblade({"dryrun", program(), "--json"});
  EXPECT_EQ(dry.code, 0) << dry.err;
  EXPECT_EQ(nlohmann::json::parse(dry.out).at("not_checked"), nlohmann::json::array())
      << "as cut needs the design";
}

TEST_F(AnyName, IsRefusedWithItsReasons) {
  const Ended refused = plan({"--set", "machine.plinth_mm=20", "--no-pictures"});
  ASSERT_EQ(refused.code, 4) << refused.err;
  expect_texts();
  EXPECT_EQ(hotblade({"preview", cut() + "/refused.json", "--shot", (files_ / "a.png").string()}).code, 0);
}

TEST_F(AnyName, IsToldToABatchThatCannotKeepIt) {
  const Ended ended =
      hotblade({"batch", "init", (files_ / "batch").string(), "--design", file_, "--units", "mm"});
  EXPECT_EQ(ended.code, 3);
  EXPECT_THAT(ended.err, HasSubstr("v\ufffd.obj: its name is no UTF-8, as batch.json is: give it another"));
}

}  // namespace
}  // namespace hotblade::pipeline

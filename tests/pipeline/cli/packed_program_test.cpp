// program.json.gz through the commands that take a program.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "pipeline/program/gzip.hpp"
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

class PackedProgramCommands : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    files_ = std::make_unique<testing::TemporaryDirectory>();
    const std::string samples = hotblade::testing::source_dir() + "/samples/";
    design_ = samples + "hypar.obj";
    for (const char* name : {"plain", "packed"}) {
      std::vector<std::string> words{"plan", design_,   "--config",     samples + "hypar.toml",
                                     "-o",   out(name), "--no-pictures"};
      if (std::string(name) == "packed") words.emplace_back("--gzip");
      planned_.push_back(hotblade(words));
    }
  }
  static void TearDownTestSuite() {
    files_.reset();
    planned_.clear();
  }
  static std::string out(const std::string& name) { return (*files_ / name).string(); }
  // What a command says of the plain and of the packed program, the file's name the same.
  static void expect_same(const std::vector<std::string>& before, const std::vector<std::string>& after) {
    std::vector<std::string> said;
    for (const std::string& program : {out("plain/program.json"), out("packed/program.json.gz")}) {
      std::vector<std::string> words = before;
      words.push_back(program);
      words.insert(words.end(), after.begin(), after.end());
      const Ended ended = hotblade(words);
      EXPECT_EQ(ended.code, 0) << program << ended.err;
      said.push_back(ended.out);
    }
    EXPECT_EQ(said[0], said[1]);
  }

  inline static std::unique_ptr<testing::TemporaryDirectory> files_;
  inline static std::string design_;
  inline static std::vector<Ended> planned_;
};

TEST_F(PackedProgramCommands, APlanWritesTheSameTextPackedAndTheHashOfThePlainBytes) {
  for (const Ended& ended : planned_) ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_THAT(planned_[1].out, HasSubstr(out("packed/program.json.gz")));
  EXPECT_FALSE(fs::exists(out("packed/program.json")));
  const std::string text = read_bytes(out("plain/program.json")),
                    bytes = read_bytes(out("packed/program.json.gz"));
  EXPECT_TRUE(unpacked(bytes, "program.json.gz") == text);
  EXPECT_LT(bytes.size(), text.size() / 3);
  EXPECT_EQ(nlohmann::json::parse(read_bytes(out("packed/report.json")))["program_sha256"], sha256_hex(text));
}

TEST_F(PackedProgramCommands, EveryCommandTakesIt) {
  expect_same({"verify"}, {"--design", design_, "--json", "--backend", "cpu"});
  expect_same({"dryrun"}, {"--json"});
  expect_same({"export"}, {"--format", "csv", "-o", out("csv"), "--force"});
  expect_same({"ribs"}, {"--format", "dxf", "-o", out("dxf"), "--force"});
  expect_same({"preview"}, {"--design", design_, "--export", out("scene.gltf"), "--force"});
}

TEST_F(PackedProgramCommands, APlanInTheOtherFormReplacesTheProgram) {
  const std::string samples = hotblade::testing::source_dir() + "/samples/";
  for (const bool gzip : {true, false}) {
    std::vector<std::string> words{"plan", design_,      "--config",      samples + "hypar.toml",
                                   "-o",   out("turns"), "--no-pictures", "--force"};
    if (gzip) words.emplace_back("--gzip");
    ASSERT_EQ(hotblade(words).code, 0);
    EXPECT_EQ(fs::exists(out("turns/program.json.gz")), gzip);
    EXPECT_EQ(fs::exists(out("turns/program.json")), !gzip);
  }
}

TEST_F(PackedProgramCommands, ADamagedOneIsBadInputToEachOfThem) {
  const std::string bytes = read_bytes(out("packed/program.json.gz")), half = out("half.json.gz");
  std::ofstream(half, std::ios::binary) << bytes.substr(0, bytes.size() / 2);
  for (const std::vector<std::string>& words : {std::vector<std::string>{"verify", half, "--design", design_},
                                                {"dryrun", half},
                                                {"export", half, "--format", "csv", "-o", out("no")},
                                                {"ribs", half, "--format", "dxf", "-o", out("no")},
                                                {"preview", half, "--export", out("no.gltf")},
                                                {"place", half, "--cell", "two_kr50", "-o", out("no")},
                                                {"run", half, "--connect", "127.0.0.1:1", "--yes"}}) {
    const Ended ended = hotblade(words);
    EXPECT_EQ(ended.code, 3) << words[0] << ended.err;
    EXPECT_THAT(ended.err, HasSubstr("half.json.gz: is cut off (gzip): copy or write it again")) << words[0];
  }
}

}  // namespace
}  // namespace hotblade::pipeline

// Progress and notes, as they arrive on stderr.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "pipeline/cli/command.hpp"
#include "tests/pipeline/temporary_directory.hpp"

namespace hotblade::pipeline {
namespace {

using ::testing::ElementsAre;
using ::testing::internal::CaptureStderr;
using ::testing::internal::GetCapturedStderr;

std::vector<nlohmann::json> json_lines(const std::string& text) {
  std::vector<nlohmann::json> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(nlohmann::json::parse(line));
  return lines;
}

TEST(Console, JsonProgressIsOneObjectALineAndNeverGoesBack) {
  Console console;
  console.progress = "json";
  CaptureStderr();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double fraction : {-1.0, 0.1, 0.05, nan, 0.3, 7.0}) console.report_progress("slice", fraction);
  console.report_progress("fit \"1\"", 0.5);
  const auto lines = json_lines(GetCapturedStderr());
  std::vector<double> shown;
  for (const auto& line : lines) shown.push_back(line.at("progress"));
  EXPECT_THAT(shown, ElementsAre(0.0, 0.1, 0.3, 1.0, 1.0));
  EXPECT_EQ(lines.front().at("stage"), "slice");
  EXPECT_EQ(lines.back().at("stage"), "fit \"1\"");
}

TEST(Console, ManySmallStepsGiveFewLines) {
  Console console;
  console.progress = "json";
  CaptureStderr();
  for (int i = 0; i <= 100000; ++i) console.report_progress("verify", i / 100000.0);
  const auto lines = json_lines(GetCapturedStderr());
  EXPECT_LE(lines.size(), 201u);
  EXPECT_GE(lines.size(), 100u);
  EXPECT_EQ(lines.back().at("progress"), 1.0);
}

TEST(Console, NoBarWhenStderrIsNoTerminal) {
  Console console;
  CaptureStderr();
  console.report_progress("slice", 0.5);
  EXPECT_EQ(GetCapturedStderr(), "");
}

TEST(Console, NotesEndAHalfDrawnBar) {
  Console console;
  console.progress = "bar";
  CaptureStderr();
  console.report_progress("slice", 0.5);
  console.note("a note");
  const std::string text = GetCapturedStderr();
  EXPECT_THAT(text, ::testing::HasSubstr("[###############...............]  50%  slice\na note\n"));
}

TEST(Console, QuietKeepsWarningsAndLogsTheRest) {
  const testing::TemporaryDirectory files;
  Console console;
  console.quiet = true;
  console.verbose = 1;
  console.progress = "json";
  console.log_file = (files / "log").string();
  CaptureStderr();
  console.report_progress("slice", 0.5);
  console.detail("a detail");
  console.note("a note");
  console.warn("a warning");
  EXPECT_EQ(GetCapturedStderr(), "a warning\n");
  EXPECT_EQ(testing::read_bytes(files / "log"), "a detail\na note\na warning\n");
}

TEST(Console, DetailsNeedVerbose) {
  Console console;
  CaptureStderr();
  console.detail("a detail");
  EXPECT_EQ(GetCapturedStderr(), "");
}

}  // namespace
}  // namespace hotblade::pipeline

// Progress and notes, as they arrive on stderr.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pty.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "pipeline/cli/command.hpp"
#include "tests/paths.hpp"
#include "tests/pipeline/run_program.hpp"
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

// What a command prints to a terminal of its own.
std::string on_terminal(const std::string& arguments, const std::string& environment) {
  int side = -1;
  const pid_t child = forkpty(&side, nullptr, nullptr, nullptr);
  if (child == 0) {
    const std::string command =
        "TERM=xterm " + environment + " exec " + hotblade::testing::binary_dir() + "/hotblade " + arguments;
    execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    _exit(127);
  }
  std::string text;
  char part[4096];
  // The last read fails when the program has closed its end.
  for (ssize_t n; (n = ::read(side, part, sizeof part)) > 0;) text.append(part, static_cast<std::size_t>(n));
  ::close(side);
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_NE(WEXITSTATUS(status), 127) << text;
  return text;
}

TEST(Console, ColoursAreForTerminalsAndForWhoWantsThem) {
  const testing::TemporaryDirectory directory;
  const std::string speck = (directory / "speck.obj").string(),
                    plan = "plan " + speck + " --units mm --no-pictures --force -o " +
                           (directory / "cut").string();
  std::ofstream(speck) << "v 0 0 0\nv 15 0 0\nv 15 15 0\nv 0 15 0\nf 1 2 3 4\n";
  EXPECT_THAT(on_terminal(plan + " --log-file " + (directory / "log").string(), ""),
              ::testing::HasSubstr("\033[33mwarning:\033[0m "));
  const std::string log = testing::read_bytes(directory / "log");
  EXPECT_THAT(log, ::testing::HasSubstr("warning: "));
  EXPECT_EQ(log.find('\033'), std::string::npos) << "a log is no terminal";
  // The bar goes on with one of its own: it clears its line.
  for (const char* plain : {"NO_COLOR=1", "TERM=dumb"}) {
    EXPECT_THAT(on_terminal(plan, plain), ::testing::AllOf(::testing::HasSubstr("warning: "),
                                                           ::testing::Not(::testing::HasSubstr("\033[3"))))
        << plain;
  }
  const testing::Ended piped = testing::hotblade(
      {"plan", speck, "--units", "mm", "--no-pictures", "--force", "-o", (directory / "cut").string()});
  EXPECT_THAT(piped.err, ::testing::HasSubstr("warning: "));
  EXPECT_EQ((piped.out + piped.err).find('\033'), std::string::npos);
}

}  // namespace
}  // namespace hotblade::pipeline

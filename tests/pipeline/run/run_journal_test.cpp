#include "pipeline/run/run_journal.hpp"

#include <gmock/gmock.h>

#include <fstream>

#include "pipeline/settings/error.hpp"
#include "tests/pipeline/temporary_directory.hpp"

namespace hotblade::pipeline {
namespace {

class RunJournalTest : public ::testing::Test {
 protected:
  testing::TemporaryDirectory directory_;
  RunJournalFile file_{directory_ / "program.json", {"::1", 1502}};
};

TEST_F(RunJournalTest, LiesBesideTheProgramAndIsNamedByTheController) {
  EXPECT_EQ(file_.path(), directory_ / "program.json.__1-1502.resume");
  const RunJournalFile other(directory_ / "program.json", {"cell.local", 502});
  EXPECT_EQ(other.path(), directory_ / "program.json.cell.local-502.resume");
}

TEST_F(RunJournalTest, KeepsTheLastThatWasWritten) {
  EXPECT_FALSE(file_.read()) << "none yet";
  file_.write({0xFEDCBA9876543210, 7, 4000000000});
  file_.write({0x00000000000000A1, 8, 4000000001});
  const auto read = file_.read();
  ASSERT_TRUE(read);
  EXPECT_EQ(read->job, 0xA1u);
  EXPECT_EQ(read->run, 8u);
  EXPECT_EQ(read->token, 4000000001u);
  file_.remove();
  EXPECT_FALSE(file_.read());
  file_.remove();
}

TEST_F(RunJournalTest, WhatIsNoJournalIsNamedAndNotGuessedAt) {
  const std::string whole = R"({"format":"hotblade-resume","job":"00a1","run":1,"token":1})";
  for (const std::string& text :
       {std::string(), std::string("{}"), std::string("[1]"), std::string("hello"),
        whole + std::string("\0x", 2), std::string(R"({"format":"hotblade-resume","run":1,"token":1})"),
        std::string(R"({"format":"hotblade-resume","job":"xyz","run":1,"token":1})"),
        std::string(R"({"format":3,"job":"00a1","run":1,"token":1})"),
        std::string(R"({"format":"hotblade-resume","job":"00a1","run":-1,"token":1})"),
        std::string(R"({"format":"hotblade-resume","job":"00a1","run":1,"token":4294967296})"),
        std::string(R"({"format":"hotblade-resume","job":"00a1","run":"one","token":1})")}) {
    std::ofstream(file_.path()) << text;
    try {
      (void)file_.read();
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind, ErrorKind::kBadInput) << text;
      EXPECT_THAT(error.what(), ::testing::HasSubstr(file_.path().string()));
    }
  }
}

}  // namespace
}  // namespace hotblade::pipeline

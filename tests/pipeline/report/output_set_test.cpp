#include "pipeline/report/output_set.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <string>
#include <thread>

#include "pipeline/settings/error.hpp"
#include "tests/pipeline/temporary_directory.hpp"

namespace hotblade::pipeline {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

class OutputSetTest : public ::testing::Test {
 protected:
  testing::TemporaryDirectory files_;
  fs::path cut_ = files_ / "cut";
};

TEST_F(OutputSetTest, GivenUpLeavesNoDirectoryThatWasNotThere) {
  {
    OutputSet set(cut_, false);
    write(set.draft() / "program.json", "new");
    EXPECT_TRUE(set.abandon());
    EXPECT_TRUE(fs::is_empty(files_.path()));
    EXPECT_THROW(set.commit(), Error);
  }
  EXPECT_TRUE(fs::is_empty(files_.path()));
}

TEST_F(OutputSetTest, GivenUpBeforeItsDraftMakesNone) {
  OutputSet set(cut_, false);
  EXPECT_TRUE(set.abandon());
  EXPECT_THROW((void)set.draft(), Error);
  EXPECT_TRUE(fs::is_empty(files_.path()));
}

TEST_F(OutputSetTest, GivenUpIsGoneThoughOthersStillWrite) {
  for (int round = 0; round < 20; ++round) {
    OutputSet set(cut_, false);
    const fs::path draft = set.draft();
    std::atomic<bool> over = false;
    std::thread writer([&] {
      for (int i = 0; !over; ++i) write(draft / std::to_string(i), "new");
    });
    while (testing::files_in(draft) < 50) std::this_thread::yield();
    EXPECT_TRUE(set.abandon());
    EXPECT_TRUE(fs::is_empty(files_.path())) << "round " << round;
    over = true;
    writer.join();
  }
}

TEST_F(OutputSetTest, GivenUpLeavesTheOlderSetAsItIs) {
  fs::create_directory(cut_);
  write(cut_ / "program.json", "old");
  OutputSet set(cut_, true);
  write(set.draft() / "program.json", "new");
  EXPECT_TRUE(set.abandon());
  EXPECT_EQ(testing::read_bytes(cut_ / "program.json"), "old");
  EXPECT_EQ(testing::files_in(files_.path()), 1u);
}

TEST_F(OutputSetTest, IsNotGivenUpOnceItIsInItsPlace) {
  OutputSet set(cut_, false);
  write(set.draft() / "program.json", "new");
  set.commit();
  EXPECT_FALSE(set.abandon());
  EXPECT_EQ(testing::read_bytes(cut_ / "program.json"), "new");
}

// A kill between the exchange and what follows it leaves both directories as they are then.
TEST_F(OutputSetTest, HasTheUsersDirectoriesBeforeItIsInItsPlace) {
  fs::create_directories(cut_ / "mine" / "deep");
  write(cut_ / "mine" / "deep" / "notes", "notes");
  {
    OutputSet set(cut_, true);
    const fs::path draft = set.draft();
    write(draft / "program.json", "new");
    set.commit();
    EXPECT_FALSE(fs::exists(draft)) << "the older set is gone";
  }
  EXPECT_EQ(testing::read_bytes(cut_ / "mine" / "deep" / "notes"), "notes");
  // As it is after such a kill: the older set beside the new one, with files of the user that came since.
  const fs::path older = files_ / ".cut.hotblade-1";
  fs::create_directories(older / "mine" / "deep");
  write(older / "mine" / "deep" / "more", "more");
  { const OutputSet set(cut_, true); }
  EXPECT_EQ(testing::read_bytes(cut_ / "mine" / "deep" / "more"), "more");
  EXPECT_EQ(testing::read_bytes(cut_ / "mine" / "deep" / "notes"), "notes");
  EXPECT_FALSE(fs::exists(older));
}

TEST_F(OutputSetTest, ThatIsNeverCommittedLeavesNoDirectory) {
  { const OutputSet set(cut_, false); }
  EXPECT_FALSE(fs::exists(cut_));
}

}  // namespace
}  // namespace hotblade::pipeline

#include "pipeline/export/exported_file.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "pipeline/settings/error.hpp"
#include "tests/pipeline/temporary_directory.hpp"

namespace hotblade::pipeline {
namespace {

// Two files, the second in several pieces.
std::vector<ExportedFile> two_files() {
  return {{"a.txt", "new"}, {"b.txt", std::string(10'000'000, 'b')}};
}

TEST(ExportedFiles, AnEndAtAnyMomentLeavesEverythingAsItWas) {
  const testing::TemporaryDirectory files;
  const std::filesystem::path there = files / "there", fresh = files / "fresh";
  std::filesystem::create_directory(there);
  std::ofstream(there / "a.txt") << "old";
  int calls = 0;
  write_exported(two_files(), files / "counted", false, [&] { ++calls; });
  ASSERT_GT(calls, 4);
  for (int last = 1; last <= calls; ++last) {
    for (const auto& directory : {there, fresh}) {
      int call = 0;
      const auto watch = [&] {
        if (++call == last) throw Error(ErrorKind::kInterrupted, "interrupted");
      };
      EXPECT_THROW(write_exported(two_files(), directory, true, watch), Error);
    }
    EXPECT_EQ(testing::read_bytes(there / "a.txt"), "old");
    EXPECT_EQ(testing::files_in(there), 1u) << "after " << last;
    EXPECT_FALSE(std::filesystem::exists(fresh)) << "after " << last;
  }
  write_exported(two_files(), there, true);
  EXPECT_EQ(testing::read_bytes(there / "a.txt"), "new");
  EXPECT_EQ(testing::read_bytes(there / "b.txt").size(), 10'000'000u);
}

}  // namespace
}  // namespace hotblade::pipeline

#include "pipeline/program/atomic_file.hpp"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <string>

#include "pipeline/settings/error.hpp"
#include "tests/pipeline/temporary_directory.hpp"

namespace hotblade::pipeline {
namespace {

namespace fs = std::filesystem;
using testing::files_in;
using ::testing::HasSubstr;
using testing::read_bytes;
using testing::TemporaryDirectory;

template <typename Call>
std::string file_error(Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind, ErrorKind::kFile);
    return error.what();
  }
  ADD_FAILURE() << "no error";
  return "";
}

TEST(WriteFileAtomically, WritesTheBytesAndNothingElse) {
  const TemporaryDirectory directory;
  const std::string bytes("a\0b\n", 4);
  write_file_atomically(directory / "f.bin", bytes, false);
  EXPECT_EQ(read_bytes(directory / "f.bin"), bytes);
  EXPECT_EQ(files_in(directory.path()), 1u);
}

TEST(WriteFileAtomically, JoinsPiecesAndLeavesNothingWhenTheirMakerThrows) {
  const TemporaryDirectory directory;
  write_file_atomically(
      directory / "f", [](const WritePiece& write) { write("one "), write(""), write("two"); }, false);
  EXPECT_EQ(read_bytes(directory / "f"), "one two");
  const auto fails = [](const WritePiece& write) {
    write("half");
    throw std::runtime_error("no more");
  };
  EXPECT_THROW(write_file_atomically(directory / "g", fails, false), std::runtime_error);
  EXPECT_THROW(write_file_atomically(directory / "f", fails, true), std::runtime_error);
  EXPECT_EQ(read_bytes(directory / "f"), "one two");
  EXPECT_EQ(files_in(directory.path()), 1u);
}

TEST(WriteFileAtomically, KeepsAnExistingFileWithoutForce) {
  const TemporaryDirectory directory;
  write_file_atomically(directory / "f", "old", false);
  const std::string message = file_error([&] { write_file_atomically(directory / "f", "new", false); });
  EXPECT_EQ(message, (directory / "f").string() + ": already exists: use --force to overwrite");
  EXPECT_EQ(read_bytes(directory / "f"), "old");
  EXPECT_EQ(files_in(directory.path()), 1u);
}

TEST(WriteFileAtomically, ReplacesAnExistingFileWithForce) {
  const TemporaryDirectory directory;
  write_file_atomically(directory / "f", "something longer", false);
  write_file_atomically(directory / "f", "new", true);
  EXPECT_EQ(read_bytes(directory / "f"), "new");
}

TEST(WriteFileAtomically, NamesTheSystemsReasonForAMissingDirectory) {
  const TemporaryDirectory directory;
  const std::string message = file_error([&] { write_file_atomically(directory / "no" / "f", "x", false); });
  EXPECT_THAT(message, HasSubstr("No such file or directory"));
}

TEST(WriteFileAtomically, LeavesNoTemporaryFileWhenTheDiskIsFull) {
  const TemporaryDirectory directory;
  // A limit on file size fails the write as a full disk does; the child keeps the limit to itself.
  constexpr int kRefused = 7;
  const pid_t child = ::fork();
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{1000, 1000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    int code = 0;
    try {
      write_file_atomically(directory / "f", std::string(5000, 'x'), false);
    } catch (const Error& error) {
      code = error.kind == ErrorKind::kFile ? kRefused : 1;
    }
    ::_exit(code);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(WEXITSTATUS(status), kRefused);
  EXPECT_EQ(files_in(directory.path()), 0u);
}

TEST(WriteFileAtomically, RefusesADirectoryAndADevice) {
  const TemporaryDirectory directory;
  EXPECT_THAT(file_error([&] { write_file_atomically(directory.path(), "x", true); }),
              HasSubstr("is a directory"));
  EXPECT_THAT(file_error([] { write_file_atomically("/dev/null", "x", true); }),
              HasSubstr("not a regular file"));
}

TEST(WriteFileAtomically, FollowsALinkAndKeepsIt) {
  const TemporaryDirectory directory;
  write_file_atomically(directory / "real", "old", false);
  fs::create_symlink("real", directory / "link");
  write_file_atomically(directory / "link", "new", true);
  EXPECT_TRUE(fs::is_symlink(directory / "link"));
  EXPECT_EQ(read_bytes(directory / "real"), "new");
}

TEST(StagedFile, ComesToItsPlaceOnlyWhenItIsPutThere) {
  const TemporaryDirectory directory;
  write_file_atomically(directory / "f", "old", false);
  const auto produce = [](const WritePiece& write) {
    write("ne");
    write("w");
  };
  StagedFile staged(directory / "f", produce, true);
  EXPECT_EQ(read_bytes(directory / "f"), "old");
  staged.place();
  EXPECT_EQ(read_bytes(directory / "f"), "new");
}

TEST(StagedFile, LeavesNothingBehindWhenItIsNotPlaced) {
  const TemporaryDirectory directory;
  {
    const StagedFile staged(
        directory / "f", [](const WritePiece& write) { write("x"); }, false);
  }
  EXPECT_TRUE(fs::is_empty(directory / "."));
}

TEST(FilesSyncedTogether, AreWholeBeforeTheyAreSyncedAndReplaceWhatIsThere) {
  const TemporaryDirectory directory;
  write_file_atomically(directory / "f", "old", false);
  FilesSyncedTogether files(directory.path());
  files.write(directory / "f", "new");
  files.write(directory / "g", std::string(100000, 'x'));
  EXPECT_EQ(read_bytes(directory / "f"), "new");
  EXPECT_EQ(read_bytes(directory / "g"), std::string(100000, 'x'));
  files.sync();
  EXPECT_EQ(files_in(directory.path()), 2u);
}

TEST(FilesSyncedTogether, SayWhatCannotBeWritten) {
  const TemporaryDirectory directory;
  EXPECT_THAT(file_error([&] { const FilesSyncedTogether files(directory / "none"); }),
              HasSubstr("none: cannot be written (No such file or directory)"));
  FilesSyncedTogether files(directory.path());
  EXPECT_THAT(file_error([&] { files.write(directory / "none" / "f", "x"); }),
              HasSubstr("cannot be written"));
  ensure_directory(directory / "d");
  EXPECT_THAT(file_error([&] { files.write(directory / "d", "x"); }), HasSubstr("is a directory"));
}

TEST(EnsureDirectory, MakesParentsAndAcceptsAnExistingOne) {
  const TemporaryDirectory directory;
  ensure_directory(directory / "a" / "b");
  ensure_directory(directory / "a" / "b");
  EXPECT_TRUE(fs::is_directory(directory / "a" / "b"));
}

TEST(EnsureDirectory, RefusesAFileInTheWay) {
  const TemporaryDirectory directory;
  write_file_atomically(directory / "f", "x", false);
  EXPECT_THAT(file_error([&] { ensure_directory(directory / "f"); }), HasSubstr("directory"));
  EXPECT_THAT(file_error([&] { ensure_directory(directory / "f" / "g"); }), HasSubstr("directory"));
}

}  // namespace
}  // namespace hotblade::pipeline

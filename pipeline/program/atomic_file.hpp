// Files that are whole or not there: written beside, synced to disk, renamed into place.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string_view>

namespace hotblade::pipeline {

// Writes `bytes` to `path`. A reader sees the old file or the new one, never a part, and nothing is left
// beside it after a failure. A symbolic link is followed. Throws Error (kFile): the path
// exists and `force` is false, it is not a regular file, or it cannot be written (with the system's reason).
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes, bool force);

// Writes a text made piece by piece in the same way, without holding it whole: `produce` hands each piece to
// its argument. What `produce` throws passes through, and no file is written.
using WritePiece = std::function<void(std::string_view)>;
void write_file_atomically(const std::filesystem::path& path,
                           const std::function<void(const WritePiece&)>& produce, bool force);

// Writes a file in two steps, for others that have to wait for it: the constructor writes it, and place()
// syncs it and puts it in its place. What is written goes to the disk from then on, so that place() waits for
// little of it. One that was not placed leaves nothing. Both throw as above.
class StagedFile {
 public:
  StagedFile(const std::filesystem::path& path, const std::function<void(const WritePiece&)>& produce,
             bool force);
  ~StagedFile();
  StagedFile(StagedFile&&) noexcept;
  StagedFile& operator=(StagedFile&&) noexcept;

  void place();
  // Syncs and closes it before its turn, so that place() has no more to wait for and no file is open.
  void finish();

 private:
  class Draft;
  std::unique_ptr<Draft> draft_;
  bool force_;
};

// Many files of one file system that are waited for once instead of twice each. Every reader finds each whole
// or the one before it; through a power cut they last from sync() on, and what needs them is to be written
// after that. Both throw Error (kFile).
class FilesSyncedTogether {
 public:
  explicit FilesSyncedTogether(const std::filesystem::path& directory);
  ~FilesSyncedTogether();
  FilesSyncedTogether(const FilesSyncedTogether&) = delete;
  FilesSyncedTogether& operator=(const FilesSyncedTogether&) = delete;

  // Writes a file, in the place of one that is there.
  void write(const std::filesystem::path& path, std::string_view bytes);
  void sync();

 private:
  std::filesystem::path directory_;
  int descriptor_ = -1;
};

// A file that a library writes by a name: `path()`, beside its target until `place()` puts it there. One that
// was not placed leaves nothing. Throws Error (kFile) where it cannot be put there.
class DraftFile {
 public:
  explicit DraftFile(const std::filesystem::path& target);
  ~DraftFile();
  DraftFile(const DraftFile&) = delete;
  DraftFile& operator=(const DraftFile&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  void place() const;

 private:
  std::filesystem::path target_, path_;
};

// Throws as write_file_atomically would when a file of this name is in the way: asked before long work, so
// that its result is not lost.
void expect_writable(const std::filesystem::path& path, bool force);

// Makes the directory and its parents where they are missing. Throws Error (kFile) when that is not possible
// or the path is something else than a directory.
void ensure_directory(const std::filesystem::path& path);

}  // namespace hotblade::pipeline

#include "pipeline/program/atomic_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <string>
#include <system_error>
#include <utility>

#include "pipeline/settings/error.hpp"

namespace hotblade::pipeline {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, const std::string& what) {
  throw Error(ErrorKind::kFile, path.string() + ": " + what);
}

[[noreturn]] void fail_with_errno(const fs::path& path, const char* what, int error) {
  fail(path, std::string(what) + " (" + std::generic_category().message(error) + ")");
}

[[noreturn]] void fail_existing(const fs::path& path) {
  fail(path, "already exists: use --force to overwrite");
}

// Makes the rename last through a power cut. Some file systems cannot sync a directory; the file is whole
// either way.
void sync_directory(const fs::path& directory) {
  const int descriptor = ::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

// The path to write: links followed, so that a link stays one. Checks what is there.
fs::path resolve_target(const fs::path& path, bool force) {
  std::error_code error;
  if (!path.has_filename()) fail(path, "is not a file name");
  const fs::file_status link = fs::symlink_status(path, error);
  if (link.type() == fs::file_type::not_found) return fs::absolute(path);
  if (error) fail_with_errno(path, "cannot be written", error.value());
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::directory) fail(path, "is a directory: give a file name");
  if (fs::exists(status) && status.type() != fs::file_type::regular) fail(path, "is not a regular file");
  if (!force) fail_existing(path);
  return fs::exists(status) ? fs::canonical(path) : fs::absolute(path);
}

// The file beside the target while it is being written; removed unless it was renamed into place.
class FileDraft {
 public:
  explicit FileDraft(fs::path target) : target_(std::move(target)) {
    static std::atomic<unsigned> counter{0};
    const std::string name =
        fmt::format(".{}.{}.{}.tmp", target_.filename().string(), ::getpid(), counter.fetch_add(1));
    path_ = target_.parent_path() / name;
    descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0) fail_with_errno(target_, "cannot be written", errno);
  }
  FileDraft(const FileDraft&) = delete;
  FileDraft& operator=(const FileDraft&) = delete;
  ~FileDraft() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!placed_) ::unlink(path_.c_str());
  }

  void write(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) fail_with_errno(target_, "cannot be written", errno);
      bytes.remove_prefix(static_cast<std::size_t>(count));
      written_ += count;
    }
    // Otherwise all of a large file waits for the end. Only a hint: what fails here fails in fsync.
    constexpr off_t kLarge = 8 << 20;
    if (written_ - sent_ < kLarge) return;
    ::sync_file_range(descriptor_, sent_, written_ - sent_, SYNC_FILE_RANGE_WRITE);
    sent_ = written_;
  }

  void finish(bool sync = true) {
    if (descriptor_ < 0) return;
    if (sync && ::fsync(descriptor_) != 0) fail_with_errno(target_, "cannot be synced to disk", errno);
    if (::close(std::exchange(descriptor_, -1)) != 0) fail_with_errno(target_, "cannot be written", errno);
  }

  void place(bool force, bool sync = true) {
    if (!force) {
      // Two writers at once: only one of them may find the name free.
      if (::renameat2(AT_FDCWD, path_.c_str(), AT_FDCWD, target_.c_str(), RENAME_NOREPLACE) == 0) {
        placed_ = true;
        sync_directory(target_.parent_path());
        return;
      }
      if (errno == EEXIST) fail_existing(target_);
      // File systems without that promise answer EINVAL; the check made before writing has to do there.
      if (errno != EINVAL && errno != ENOSYS) fail_with_errno(target_, "cannot be written", errno);
    }
    if (::rename(path_.c_str(), target_.c_str()) != 0) fail_with_errno(target_, "cannot be written", errno);
    placed_ = true;
    if (sync) sync_directory(target_.parent_path());
  }

 private:
  fs::path target_, path_;
  int descriptor_ = -1;
  off_t written_ = 0, sent_ = 0;  // bytes; sent: on their way to the disk
  bool placed_ = false;
};

}  // namespace

class StagedFile::Draft : public FileDraft {
  using FileDraft::FileDraft;
};

StagedFile::StagedFile(const fs::path& path, const std::function<void(const WritePiece&)>& produce,
                       bool force)
    : draft_(std::make_unique<Draft>(resolve_target(path, force))), force_(force) {
  produce([this](std::string_view piece) { draft_->write(piece); });
}
StagedFile::~StagedFile() = default;
StagedFile::StagedFile(StagedFile&&) noexcept = default;
StagedFile& StagedFile::operator=(StagedFile&&) noexcept = default;

void StagedFile::finish() {
  draft_->finish();
}

void StagedFile::place() {
  draft_->finish();
  draft_->place(force_);
}

FilesSyncedTogether::FilesSyncedTogether(const fs::path& directory)
    : directory_(directory), descriptor_(::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (descriptor_ < 0) fail_with_errno(directory, "cannot be written", errno);
}

FilesSyncedTogether::~FilesSyncedTogether() {
  ::close(descriptor_);
}

void FilesSyncedTogether::write(const fs::path& path, std::string_view bytes) {
  FileDraft draft(resolve_target(path, true));
  draft.write(bytes);
  draft.finish(false);
  draft.place(true, false);
}

void FilesSyncedTogether::sync() {
  if (::syncfs(descriptor_) != 0) fail_with_errno(directory_, "cannot be synced to disk", errno);
}

DraftFile::DraftFile(const fs::path& target)
    : target_(target),
      path_(target.parent_path() / fmt::format(".{}.{}.tmp", target.filename().string(), ::getpid())) {}

DraftFile::~DraftFile() {
  std::error_code ignored;
  fs::remove(path_, ignored);
}

void DraftFile::place() const {
  if (::rename(path_.c_str(), target_.c_str()) != 0) fail_with_errno(target_, "cannot be written", errno);
}

void write_file_atomically(const fs::path& path, std::string_view bytes, bool force) {
  write_file_atomically(
      path, [bytes](const WritePiece& write) { write(bytes); }, force);
}

void write_file_atomically(const fs::path& path, const std::function<void(const WritePiece&)>& produce,
                           bool force) {
  StagedFile(path, produce, force).place();
}

void expect_writable(const fs::path& path, bool force) {
  const fs::path directory = resolve_target(path, force).parent_path();
  if (::access(directory.c_str(), W_OK) != 0) fail_with_errno(path, "cannot be written", errno);
}

void ensure_directory(const fs::path& path) {
  std::error_code error;
  if (fs::exists(path, error) && !fs::is_directory(path, error))
    fail(path, "is a file, and a directory goes there: choose another one");
  fs::create_directories(path, error);
  if (error) fail_with_errno(path, "cannot be made a directory", error.value());
}

}  // namespace hotblade::pipeline

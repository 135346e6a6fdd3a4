#include "pipeline/report/output_set.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/program/atomic_file.hpp"
#include "pipeline/settings/error.hpp"

namespace hotblade::pipeline {

namespace {

namespace fs = std::filesystem;

constexpr std::array kFiles{"program.json", "program.json.gz", "report.json", "report.html", "sheets.html",
                            "preview.png",  "scene.gltf",      "run.json",    "refused.json"};
constexpr const char* kRibs = "ribs";

[[noreturn]] void fail(const fs::path& path, const std::string& what) {
  throw Error(ErrorKind::kFile, path.string() + ": " + what);
}

[[noreturn]] void fail_with_errno(const fs::path& path, const char* what, int error) {
  fail(path, fmt::format("{} ({})", what, std::strerror(error)));
}

// The file that a name is of: its own, or, of a torn one that a killed plan has left, the one it was to be
// (pipeline/program/atomic_file.cpp).
std::string meant_by(const std::string& name) {
  static const std::regex torn(R"(\.(.+)\.[0-9]+\.[0-9]+\.tmp)");
  std::smatch match;
  return std::regex_match(name, match, torn) ? match[1].str() : name;
}

bool is_output(const std::string& name) {
  return name == kRibs || std::find(kFiles.begin(), kFiles.end(), meant_by(name)) != kFiles.end();
}

bool is_rib_output(const std::string& name) {
  static const std::regex ours("S[0-9]{3,}\\.dxf|beziers\\.csv");
  return std::regex_match(meant_by(name), ours);
}

std::vector<fs::path> entries(const fs::path& directory) {
  std::vector<fs::path> list;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory, error))
    list.push_back(entry.path());
  return list;
}

// The entries of a plan's directory and of its ribs that no plan wrote, from the directory on.
std::vector<fs::path> others(const fs::path& directory) {
  std::vector<fs::path> list;
  for (const fs::path& entry : entries(directory)) {
    if (!is_output(entry.filename().string())) list.push_back(entry.filename());
  }
  for (const fs::path& entry : entries(directory / kRibs)) {
    if (!is_rib_output(entry.filename().string())) list.push_back(kRibs / entry.filename());
  }
  return list;
}

bool is_there(const fs::path& path) {
  std::error_code error;
  return fs::exists(fs::symlink_status(path, error));
}

bool is_directory_itself(const fs::path& path) {
  std::error_code error;
  return fs::symlink_status(path, error).type() == fs::file_type::directory;
}

// Gives a directory the files of another one, linked, and those of its directories.
void link_tree(const fs::path& from, const fs::path& to) {
  std::error_code ignored;
  fs::create_directory(to, from, ignored);
  for (const fs::path& entry : entries(from)) {
    const fs::path place = to / entry.filename();
    if (is_directory_itself(entry)) {
      link_tree(entry, place);
    } else {
      (void)::linkat(AT_FDCWD, entry.c_str(), AT_FDCWD, place.c_str(), 0);
    }
  }
}

// Moves what is missing at a place there, and returns whether all of it is there now.
bool move_missing(const fs::path& from, const fs::path& to) {
  std::error_code error;
  if (!is_there(to)) {
    fs::rename(from, to, error);
    return !error;
  }
  bool all = true;  // a file is the same one, linked
  if (is_directory_itself(from)) {
    for (const fs::path& entry : entries(from)) all = move_missing(entry, to / entry.filename()) && all;
  }
  return all;
}

// Moves what no plan wrote from one directory to another where it is missing there, and returns whether all
// of it is there now.
bool move_others(const fs::path& from, const fs::path& to) {
  bool all = true;
  for (const fs::path& name : others(from)) {
    std::error_code ignored;
    if (name.has_parent_path()) fs::create_directory(to / name.parent_path(), ignored);
    all = move_missing(from / name, to / name) && all;
  }
  return all;
}

// Removes a draft, or a set that was swapped out, unless it still holds something that no plan wrote.
void discard(const fs::path& set, const fs::path& directory) {
  std::error_code ignored;
  if (move_others(set, directory)) fs::remove_all(set, ignored);
}

void sync_directory(const fs::path& directory) {
  const int descriptor = ::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

bool is_mount_point(const fs::path& directory) {
  struct statx facts {};
  if (::statx(AT_FDCWD, directory.c_str(), 0, STATX_BASIC_STATS, &facts) != 0) return true;
  return (facts.stx_attributes & STATX_ATTR_MOUNT_ROOT) != 0;
}

// Whoever works inside a directory would be left in the older one.
bool is_worked_in(const fs::path& directory) {
  std::error_code error;
  const fs::path here = fs::current_path(error);
  const auto [end, unused] = std::mismatch(directory.begin(), directory.end(), here.begin(), here.end());
  return end == directory.end();
}

void expect_free(const fs::path& path, bool force) {
  if (is_there(path) && !force) fail(path, "already there: use --force to overwrite");
}

void expect_places(const fs::path& directory, bool force) {
  std::error_code error;
  for (const char* name : kFiles) {
    expect_free(directory / name, force);
    if (fs::is_directory(directory / name, error))
      fail(directory / name, "is a directory, and a file of this name goes there: move it away");
  }
  expect_free(directory / kRibs, force);
  if (fs::exists(directory / kRibs, error) && !fs::is_directory(directory / kRibs, error))
    fail(directory / kRibs, "is not a directory, and the rib curves go there: move it away");
}

// The names of drafts beside a directory: .NAME.hotblade-PID.
std::string draft_prefix(const fs::path& place) {
  return "." + place.filename().string() + ".hotblade-";
}

}  // namespace

OutputSet::OutputSet(const fs::path& directory, bool force) : directory_(directory) {
  made_ = !is_there(directory);
  ensure_directory(directory);
  place_ = fs::canonical(directory);
  if (::access(place_.c_str(), W_OK | X_OK) != 0) {
    fail(directory,
         std::string("cannot write there (") + std::strerror(errno) + "): choose another directory with -o");
  }
  expect_places(directory, force);
  lock();
  whole_ = ::access(place_.parent_path().c_str(), W_OK | X_OK) == 0 && !is_mount_point(place_) &&
           !is_worked_in(place_);
  recover();
}

OutputSet::~OutputSet() {
  std::error_code ignored;
  if (!draft_.empty()) fs::remove_all(draft_, ignored);
  if (made_ && !begun_) (void)::rmdir(place_.c_str());  // not where something is in it
  if (descriptor_ >= 0) ::close(descriptor_);
}

// A plan that swaps the directory leaves its lock on the one that is no longer there.
void OutputSet::lock() {
  for (;;) {
    descriptor_ = ::open(place_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor_ < 0) fail_with_errno(directory_, "cannot be opened", errno);
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      ::close(std::exchange(descriptor_, -1));
      fail(directory_, "another plan is writing there: wait for it, or choose another directory with -o");
    }
    struct stat locked {
    }, there{};
    if (::fstat(descriptor_, &locked) == 0 && ::stat(place_.c_str(), &there) == 0 &&
        locked.st_ino == there.st_ino && locked.st_dev == there.st_dev)
      return;
    ::close(std::exchange(descriptor_, -1));
  }
}

// Ends what a plan that was killed has left: nobody else writes while we hold the lock.
void OutputSet::recover() {
  const std::string prefix = draft_prefix(place_);
  for (const fs::path& parent : {place_.parent_path(), place_}) {
    for (const fs::path& entry : entries(parent)) {
      if (entry.filename().string().starts_with(prefix) && is_directory_itself(entry)) discard(entry, place_);
    }
  }
}

const fs::path& OutputSet::draft() {
  const std::scoped_lock lock(mutex_);
  if (given_up_) fail(directory_, "given up");
  if (!draft_.empty()) return draft_;
  const fs::path draft =
      (whole_ ? place_.parent_path() : place_) / fmt::format("{}{}", draft_prefix(place_), ::getpid());
  struct stat there {};
  if (::stat(place_.c_str(), &there) != 0) fail_with_errno(directory_, "cannot be read", errno);
  if (::mkdir(draft.c_str(), 0700) != 0) fail_with_errno(directory_, "cannot be written", errno);
  draft_ = draft;
  if (!whole_) return draft_;
  // As the directory that it will be; its group is kept where that is allowed.
  if (::chown(draft.c_str(), static_cast<uid_t>(-1), there.st_gid) != 0) errno = 0;
  if (::chmod(draft.c_str(), there.st_mode & 07777) != 0)
    fail_with_errno(directory_, "cannot be written", errno);
  return draft_;
}

// What no plan wrote stands in both directories when they are swapped: whatever stops the writer, it is
// there. What cannot be linked is moved after that.
void OutputSet::link_others() const {
  for (const fs::path& name : others(place_)) {
    std::error_code ignored;
    if (name.has_parent_path()) fs::create_directory(draft_ / name.parent_path(), ignored);
    if (is_directory_itself(place_ / name)) {
      link_tree(place_ / name, draft_ / name);
    } else {
      (void)::linkat(AT_FDCWD, (place_ / name).c_str(), AT_FDCWD, (draft_ / name).c_str(), 0);
    }
  }
}

std::vector<std::string> OutputSet::left_out() const {
  std::vector<std::string> names;
  for (const char* name : kFiles)
    if (is_there(place_ / name) && !is_there(draft_ / name)) names.emplace_back(name);
  return names;
}

bool OutputSet::abandon() {
  const std::scoped_lock lock(mutex_);
  if (begun_) return false;
  given_up_ = true;
  // Others may be writing, as fast as files can be removed: nothing more comes to a directory of another
  // name, but for what is being opened as it is moved, which goes with the next try.
  constexpr int kMostTries = 1000;
  std::error_code ignored;
  fs::path moved = draft_;
  moved += "-given-up";
  if (draft_.empty() || ::rename(draft_.c_str(), moved.c_str()) != 0) moved = draft_;
  for (int i = 0; i < kMostTries && !moved.empty() && is_there(moved); ++i) fs::remove_all(moved, ignored);
  // Not where something is in it.
  if (made_) (void)::rmdir(place_.c_str());
  return true;
}

void OutputSet::commit() {
  (void)draft();
  {
    const std::scoped_lock lock(mutex_);
    if (given_up_) fail(directory_, "given up");
    begun_ = true;
  }
  if (!whole_) return commit_one_by_one();
  link_others();
  sync_directory(draft_ / kRibs);
  sync_directory(draft_);
  if (::renameat2(AT_FDCWD, draft_.c_str(), AT_FDCWD, place_.c_str(), RENAME_EXCHANGE) != 0) {
    // File systems without that promise.
    if (errno != EINVAL && errno != ENOSYS) fail_with_errno(directory_, "cannot be replaced", errno);
    return commit_one_by_one();
  }
  sync_directory(place_.parent_path());
  const fs::path older = std::exchange(draft_, {});
  discard(older, place_);
}

void OutputSet::commit_one_by_one() {
  const auto remove = [](const fs::path& file) {
    std::error_code error;
    fs::remove(file, error);
    if (error) fail(file, "cannot be removed (" + error.message() + ")");
  };
  const auto place = [&](const fs::path& name) {
    if (!is_there(draft_ / name)) return;
    if (::rename((draft_ / name).c_str(), (place_ / name).c_str()) != 0)
      fail_with_errno(directory_ / name, "cannot be written", errno);
  };
  // The older program goes first and the new one comes last: none stands beside a report that judges another.
  for (const char* name : kFiles) remove(place_ / name);
  for (const fs::path& entry : entries(place_ / kRibs)) {
    if (is_rib_output(entry.filename().string())) remove(entry);
  }
  std::error_code ignored;
  if (is_there(draft_ / kRibs)) ensure_directory(place_ / kRibs);
  for (const fs::path& entry : entries(draft_ / kRibs)) place(kRibs / entry.filename());
  if (fs::is_empty(place_ / kRibs, ignored)) fs::remove(place_ / kRibs, ignored);
  for (auto name = kFiles.rbegin(); name != kFiles.rend(); ++name) place(*name);
  sync_directory(place_);
}

}  // namespace hotblade::pipeline

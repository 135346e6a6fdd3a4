#include "pipeline/batch/work.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <limits.h>
#include <signal.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <sstream>
#include <system_error>
#include <utility>

#include "pipeline/batch/mapped_file.hpp"
#include "pipeline/program/atomic_file.hpp"
#include "pipeline/program/sha256.hpp"
#include "pipeline/settings/error.hpp"

namespace hotblade::pipeline::batch {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kWork = ".tmp-", kLock = ".lock-";

[[noreturn]] void fail_work(const fs::path& path, const std::error_code& error) {
  throw Error(ErrorKind::kFile, path.string() + ": cannot be written (" + error.message() + ")");
}

void move_file(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::rename(from, to, error);
  if (error) fail_work(to, error);
}

bool is_kept(const std::string& name, const std::string& keep) {
  constexpr std::array kReport{"report.json", "report.html", "sheets.html", "preview.png"};
  constexpr std::array kProgram{"program.json", "program.json.gz", "refused.json"};
  const auto among = [&](const auto& names) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  if (keep == kKeepAll || among(kReport)) return true;
  return keep == kKeepProgram && among(kProgram);
}

void drop_others(const fs::path& output, const std::string& keep) {
  std::vector<fs::path> dropped;
  for (const fs::directory_entry& entry : fs::directory_iterator(output)) {
    if (!is_kept(entry.path().filename().string(), keep)) dropped.push_back(entry.path());
  }
  for (const fs::path& path : dropped) fs::remove_all(path);
}

std::vector<ResultFile> files_in(const fs::path& output) {
  std::vector<ResultFile> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(output)) {
    if (!entry.is_regular_file()) continue;
    const MappedFile mapped(entry.path());
    files.push_back(
        {entry.path().lexically_relative(output).string(), mapped.text().size(), sha256_hex(mapped.text())});
  }
  std::sort(files.begin(), files.end(),
            [](const ResultFile& a, const ResultFile& b) { return a.name < b.name; });
  return files;
}

// Whether a work place was made by a process of this machine that has ended.
bool is_left(const std::string& name) {
  const auto dash = name.rfind('-');
  if (!name.starts_with(kWork) || name.find("-" + node_name() + "-") == std::string::npos) return false;
  pid_t pid = 0;
  const char* end = name.data() + name.size();
  const auto [rest, error] = std::from_chars(name.data() + dash + 1, end, pid);
  return error == std::errc() && rest == end && pid > 0 && ::kill(pid, 0) != 0 && errno == ESRCH;
}

}  // namespace

std::string node_name() {
  std::array<char, HOST_NAME_MAX + 1> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

std::vector<std::string> last_lines(const fs::path& file, std::size_t most) {
  std::vector<std::string> lines;
  try {
    const MappedFile mapped(file);
    constexpr std::size_t kTail = 64 << 10;
    const std::string_view text = mapped.text();
    std::istringstream stream(std::string(text.substr(text.size() - std::min(kTail, text.size()))));
    for (std::string line; std::getline(stream, line);) {
      if (!line.empty()) lines.push_back(line);
    }
  } catch (const Error&) {
    return {};
  }
  if (lines.size() > most) lines.erase(lines.begin(), lines.end() - static_cast<std::ptrdiff_t>(most));
  return lines;
}

std::optional<KeyLock> KeyLock::take(const BatchDirectory& directory, const std::string& key) {
  fs::path file = directory.results() / (std::string(kLock) + key);
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor < 0) fail_work(file, {errno, std::generic_category()});
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    ::close(descriptor);
    return std::nullopt;
  }
  return KeyLock(std::move(file), descriptor);
}

KeyLock::KeyLock(KeyLock&& other) noexcept
    : file_(std::move(other.file_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

KeyLock::~KeyLock() {
  if (descriptor_ < 0) return;
  ::unlink(file_.c_str());
  ::close(descriptor_);
}

WorkPlace::WorkPlace(const BatchDirectory& directory, const std::string& key)
    : place_(directory.results() / fmt::format("{}{}-{}-{}", kWork, key, node_name(), ::getpid())) {
  std::error_code ignored;
  fs::remove_all(place_, ignored);  // of an earlier try
  ensure_directory(place_);
}

WorkPlace::WorkPlace(WorkPlace&& other) noexcept : place_(std::exchange(other.place_, fs::path())) {}

WorkPlace::~WorkPlace() {
  std::error_code ignored;
  if (!place_.empty()) fs::remove_all(place_, ignored);
}

void WorkPlace::publish(const BatchDirectory& directory, Result result, const std::string& keep) {
  try {
    ensure_directory(output());
    drop_others(output(), keep);
    move_file(stderr_file(), output() / "stderr.txt");
    result.files = files_in(output());
    write_file_atomically(output() / "result.json", result_text(result), true);
    const fs::path target = directory.result(result.key);
    ensure_directory(target.parent_path());
    std::error_code error;
    if (!has_result(directory, result.key)) fs::remove_all(target, error);  // what is left of another
    fs::rename(output(), target, error);
    if (error && !has_result(directory, result.key)) fail_work(target, error);
  } catch (const fs::filesystem_error& error) {
    throw Error(ErrorKind::kFile, error.what());
  }
}

void clear_left_work(const BatchDirectory& directory) {
  std::error_code ignored;
  std::vector<fs::path> left;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory.results(), ignored)) {
    const std::string name = entry.path().filename().string();
    if (is_left(name)) left.push_back(entry.path());
    if (name.starts_with(kLock)) (void)KeyLock::take(directory, name.substr(kLock.size()));  // and given back
  }
  for (const fs::path& path : left) fs::remove_all(path, ignored);
}

}  // namespace hotblade::pipeline::batch

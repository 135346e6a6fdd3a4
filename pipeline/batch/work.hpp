// The place where one plan is made, and how what it made becomes the key's result.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/batch/batch.hpp"
#include "pipeline/batch/result.hpp"

namespace hotblade::pipeline::batch {

// Keeps other runners off a key while it is planned. Nothing but time depends on it: on a file system without
// locks two runners plan the same, and one result is dropped.
class KeyLock {
 public:
  // Returns the lock; absent while another runner has it.
  [[nodiscard]] static std::optional<KeyLock> take(const BatchDirectory& directory, const std::string& key);
  ~KeyLock();
  KeyLock(KeyLock&& other) noexcept;
  KeyLock& operator=(KeyLock&&) = delete;

 private:
  KeyLock(std::filesystem::path file, int descriptor) : file_(std::move(file)), descriptor_(descriptor) {}
  std::filesystem::path file_;
  int descriptor_;
};

// A directory beside the results, gone with this object.
class WorkPlace {
 public:
  // Throws Error (kFile) when it cannot be made.
  WorkPlace(const BatchDirectory& directory, const std::string& key);
  ~WorkPlace();
  WorkPlace(WorkPlace&& other) noexcept;
  WorkPlace& operator=(WorkPlace&&) = delete;

  [[nodiscard]] std::filesystem::path output() const { return place_ / "plan"; }
  [[nodiscard]] std::filesystem::path stderr_file() const { return place_ / "stderr.txt"; }

  // Drops what `keep` does not name, adds stderr.txt, the hashes of all files and, last of all, result.json,
  // and moves the whole to where the key's result goes; dropped where one is there already. Throws Error
  // (kFile).
  void publish(const BatchDirectory& directory, Result result, const std::string& keep);

 private:
  std::filesystem::path place_;
};

// Removes what killed runners of this machine have left beside the results.
void clear_left_work(const BatchDirectory& directory);

// Returns the last lines of a text file that are not empty, at most `most`; none where it cannot be read.
[[nodiscard]] std::vector<std::string> last_lines(const std::filesystem::path& file, std::size_t most);

// Returns this machine's name.
[[nodiscard]] std::string node_name();

}  // namespace hotblade::pipeline::batch

// The files of one plan as one set: written beside the directory they are for and swapped with it whole, so
// that a reader finds all of an older plan or all of the new one, whatever stops the writer.
//
// The directory itself is exchanged (renameat2, RENAME_EXCHANGE); files of other names that stand in it are
// carried over. Where a directory cannot be exchanged - it is a mount point, the working directory, or its
// parent cannot be written - the set is written whole inside it and its files are renamed one by one, the
// program last; between the first and the last of these renames no program is there.
#pragma once

#include <filesystem>
#include <mutex>
#include <string>
#include <vector>

namespace hotblade::pipeline {

// Returns the name of a plan's program, packed or not.
[[nodiscard]] inline const char* program_name(bool gzip) {
  return gzip ? "program.json.gz" : "program.json";
}

class OutputSet {
 public:
  // Makes the directory where it is missing, and holds a lock on it until the end. Throws Error (kFile): an
  // output is there and `force` is false, something that is no file has the name of one, the directory cannot
  // be written to, or another plan holds the lock.
  OutputSet(const std::filesystem::path& directory, bool force);
  ~OutputSet();
  OutputSet(const OutputSet&) = delete;
  OutputSet& operator=(const OutputSet&) = delete;

  // The directory that the set was asked for, and the empty one that its files are written to meanwhile, made
  // when it is first asked for.
  [[nodiscard]] const std::filesystem::path& directory() const { return directory_; }
  [[nodiscard]] const std::filesystem::path& draft();

  // Returns the names of the files of an older set that the draft does not have: `commit` removes them.
  [[nodiscard]] std::vector<std::string> left_out() const;

  // Puts the draft in the directory's place. Outputs of an older plan that the draft does not have go.
  // Without it, nothing of the directory has changed. Throws Error (kFile), and the older set stays.
  void commit();

  // Takes back what was begun, from any thread: the draft, and the directory where it was made for the set
  // and is empty. What is written to the draft after that fails. False, and nothing is done, once `commit`
  // has begun.
  [[nodiscard]] bool abandon();

 private:
  void lock();
  void recover();
  void link_others() const;
  void commit_one_by_one();

  std::filesystem::path directory_, place_, draft_;  // as asked for; with links followed; beside or inside
  int descriptor_ = -1;
  bool whole_ = true;   // the directory can be exchanged
  bool made_ = false;   // the directory, by us
  std::mutex mutex_;    // of what follows, and of the draft's making
  bool begun_ = false;  // the exchange
  bool given_up_ = false;
};

}  // namespace hotblade::pipeline

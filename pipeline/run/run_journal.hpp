// What `hotblade run` remembers beside the program while a strip is under way, so that --resume finds the run
// again after the client, the controller or both were killed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "pipeline/program/strip_jobs.hpp"

namespace hotblade::pipeline {

// The run under way, as the controller knows it.
struct RunJournal {
  std::uint64_t job = 0;
  std::uint32_t run = 0, token = 0;
};

class RunJournalFile {
 public:
  // Names the file PROGRAM.HOST-PORT.resume.
  RunJournalFile(const std::filesystem::path& program, const HostPort& controller);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  // Returns the run that the file tells of; nothing when there is no file. Throws Error (kBadInput) for a
  // file that is none.
  [[nodiscard]] std::optional<RunJournal> read() const;
  // Writes the file whole; it is on disk before this returns. Throws Error (kFile).
  void write(const RunJournal& journal) const;
  void remove() const;
  // Throws Error (kFile) when a journal could not be written, as on a full disk: asked before a job is
  // opened.
  void expect_writable() const;

 private:
  std::filesystem::path path_;
};

}  // namespace hotblade::pipeline

// Studies: re-runs of the experiments of the papers that the curve tools come from, with our figures beside
// the papers' (docs/studies.md). A study is a pure function of its options: same options, same bytes,
// whatever the number of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

namespace hotblade::pipeline::study {

struct StudyOptions {
  std::size_t samples = 0;  // 0: the study's own number
  std::size_t checked = 0;  // how many of them a slower, independent method checks; 0: the study's own number
  std::uint64_t seed = 1;
  // Is called from the calling thread with the share of the work that is done, 0 to 1; throws to end the
  // study early.
  std::function<void(double)> progress;

  void report(double share) const {
    if (progress) progress(share);
  }
};

// A plot or table to be written beside the results.
struct StudyFile {
  std::string name, bytes;
};

struct StudyReport {
  std::string text;                // tables for people
  nlohmann::ordered_json figures;  // the same for programs
  std::vector<StudyFile> files;
  std::vector<std::string> remarks = {};  // what depends on the machine, as speeds do: said, never written
};

struct Study {
  const char* name;
  const char* about;  // one line of help
  StudyReport (*run)(const StudyOptions& options);
};

// Every study, in the order of the help. A new one is one line in studies.cpp.
[[nodiscard]] std::span<const Study> studies();

[[nodiscard]] StudyReport study_projection(const StudyOptions& options);
[[nodiscard]] StudyReport study_zone(const StudyOptions& options);
[[nodiscard]] StudyReport study_arcs(const StudyOptions& options);
[[nodiscard]] StudyReport study_quadratic(const StudyOptions& options);

}  // namespace hotblade::pipeline::study

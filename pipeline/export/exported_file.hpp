// A file made for another program: its name below the directory asked for, and its text.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace hotblade::pipeline {

struct ExportedFile {
  std::string name;
  std::string text;
};

// Writes the files below `directory`, each whole or not there, and prints their paths. A file in the way
// without `force` is found before the first one is written. `watch` is called until all are written and take
// their places; what it throws leaves everything as it was. Throws Error (kFile).
void write_exported(
    const std::vector<ExportedFile>& files, const std::filesystem::path& directory, bool force,
    const std::function<void()>& watch = [] {});

}  // namespace hotblade::pipeline

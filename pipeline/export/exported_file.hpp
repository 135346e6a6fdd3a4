// A file made for another program: its name below the directory asked for, and its text.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace hotblade::pipeline {

struct ExportedFile {
  std::string name;
  std::string text;
};

// Writes the files below `directory`, each whole or not there, and prints their paths. A file in the way
// without `force` is found before the first one is written. Throws Error (kFile).
void write_exported(const std::vector<ExportedFile>& files, const std::filesystem::path& directory,
                    bool force);

}  // namespace hotblade::pipeline

#include "pipeline/export/exported_file.hpp"

#include <iostream>

#include "pipeline/program/atomic_file.hpp"

namespace hotblade::pipeline {

void write_exported(const std::vector<ExportedFile>& files, const std::filesystem::path& directory,
                    bool force) {
  ensure_directory(directory);
  for (const ExportedFile& file : files) expect_writable(directory / file.name, force);
  for (const ExportedFile& file : files) {
    write_file_atomically(directory / file.name, file.text, force);
    std::cout << (directory / file.name).string() << '\n';
  }
}

}  // namespace hotblade::pipeline

// Files that describe an arm or a cell, and what is wrong with them.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace hotblade::robot {

// what() reads `file:line: what (value, limit): hint`, without the line for files of bytes.
struct ModelError : std::runtime_error {
  explicit ModelError(const std::string& message, bool file_missing = false)
      : std::runtime_error(message), missing(file_missing) {}
  bool missing;  // the file is not there or cannot be read; else it is wrong
};

// Returns the bytes of a file. Throws ModelError, `missing`, where it cannot be read.
[[nodiscard]] std::string read_model_file(const std::filesystem::path& file);

}  // namespace hotblade::robot

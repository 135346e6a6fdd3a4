// Files that describe an arm or a cell, and what is wrong with them.
#pragma once

#include <cstddef>
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

// Bytes of the longest text. Expanded arms have some 10 kB; beyond, it describes no arm and no cell.
inline constexpr std::size_t kMostTextBytes = 4'000'000;

// Returns the bytes of a file. Throws ModelError: `missing` where it cannot be read, and where it has more
// than `most` bytes, of which no more are read: a device may have no end.
[[nodiscard]] std::string read_model_file(const std::filesystem::path& file,
                                          std::size_t most = kMostTextBytes);

}  // namespace hotblade::robot

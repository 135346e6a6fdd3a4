// Which format a design's file is written in.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

namespace hotblade::surface {

enum class FileFormat { kObj, kStl, kPly, kGltf };

// Returns the word for a format: obj, stl, ply or gltf.
[[nodiscard]] std::string_view name(FileFormat format);
// Absent for another word, `auto` among them.
[[nodiscard]] std::optional<FileFormat> format_named(std::string_view word);

// How much of a file format_of() looks at.
inline constexpr std::size_t kFormatHead = 4096;

// Returns the format of a file of `size` bytes that begins with `head` (all of it, or kFormatHead bytes):
// what its bytes say, else what its name ends with, else OBJ, which no bytes tell. Throws MeshError where a
// name that ends with a format's contradicts the bytes, and with the line that converts it where name or
// bytes are those of a format of other programs.
[[nodiscard]] FileFormat format_of(std::string_view head, std::uintmax_t size,
                                   const std::filesystem::path& file);

// The same of a file on the disk; absent where it cannot be opened, which its reader will tell.
[[nodiscard]] std::optional<FileFormat> format_of_file(const std::filesystem::path& file);

}  // namespace hotblade::surface

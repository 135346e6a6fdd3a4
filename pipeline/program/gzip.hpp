// Texts packed as gzip (RFC 1952), for programs of megabytes: a name that ends in .gz says that a file is.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace hotblade::pipeline {

// Returns whether a file of this name is packed.
[[nodiscard]] bool is_gzip_name(const std::filesystem::path& file);

// Returns the plain text of a packed one, of all its members. Throws Error (kBadInput) with the file's name:
// for what is no gzip, is cut off, damaged or followed by something else, and for a text of over 64 MiB that
// is over 200 times as long as its file: programs pack to a quarter, and no memory should go to a file made
// to fill it.
[[nodiscard]] std::string unpacked(std::string_view bytes, const std::string& file_name);

// Returns a text as a member of a file: the same text gives the same bytes, with nothing of time or place in
// them. Members one after the other unpack to their texts one after the other.
[[nodiscard]] std::string packed(std::string_view text);

}  // namespace hotblade::pipeline

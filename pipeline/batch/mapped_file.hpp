// A file's bytes without a copy in memory: a facade's OBJ has gigabytes.
#pragma once

#include <filesystem>
#include <string_view>

namespace hotblade::pipeline::batch {

class MappedFile {
 public:
  // Throws Error (kFile): no such file, no regular one, or it cannot be read.
  explicit MappedFile(const std::filesystem::path& file);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  [[nodiscard]] std::string_view text() const { return text_; }

  // Gives back the memory of what was read so far; it is read again when it is asked for.
  void forget() const;

 private:
  std::string_view text_;
};

}  // namespace hotblade::pipeline::batch

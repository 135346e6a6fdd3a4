#include "pipeline/export/exported_file.hpp"

#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <string_view>

#include "pipeline/program/atomic_file.hpp"

namespace hotblade::pipeline {

namespace {

// A directory that goes again where it was made for nothing.
class MadeDirectory {
 public:
  explicit MadeDirectory(const std::filesystem::path& directory) : directory_(directory) {
    std::error_code error;
    made_ = !std::filesystem::exists(directory, error);
    ensure_directory(directory);
  }
  MadeDirectory(const MadeDirectory&) = delete;
  MadeDirectory& operator=(const MadeDirectory&) = delete;
  ~MadeDirectory() {
    if (made_) (void)::rmdir(directory_.c_str());  // not where something is in it
  }

 private:
  std::filesystem::path directory_;
  bool made_ = false;
};

}  // namespace

void write_exported(const std::vector<ExportedFile>& files, const std::filesystem::path& directory,
                    bool force, const std::function<void()>& watch) {
  constexpr std::size_t kPiece = 4 << 20;
  const MadeDirectory made(directory);
  for (const ExportedFile& file : files) expect_writable(directory / file.name, force);
  std::vector<StagedFile> staged;
  for (const ExportedFile& file : files) {
    const auto produce = [&](const WritePiece& write) {
      for (std::string_view rest = file.text; !rest.empty();
           rest.remove_prefix(std::min(kPiece, rest.size()))) {
        watch();
        write(rest.substr(0, kPiece));
      }
    };
    staged.emplace_back(directory / file.name, produce, force).finish();
  }
  watch();
  for (std::size_t i = 0; i < files.size(); ++i) {
    staged[i].place();
    std::cout << (directory / files[i].name).string() << '\n';
  }
}

}  // namespace hotblade::pipeline

#include "pipeline/batch/mapped_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "pipeline/settings/error.hpp"

namespace hotblade::pipeline::batch {
namespace {

[[noreturn]] void fail_file(const std::filesystem::path& file, int error) {
  throw Error(ErrorKind::kFile,
              file.string() + ": cannot be read (" + std::generic_category().message(error) + ")");
}

}  // namespace

MappedFile::MappedFile(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) fail_file(file, errno);
  struct stat facts {};
  const bool known = ::fstat(descriptor, &facts) == 0;
  const bool regular = known && S_ISREG(facts.st_mode);
  void* bytes = nullptr;
  int error = known ? 0 : errno;
  if (regular && facts.st_size > 0) {
    bytes = ::mmap(nullptr, static_cast<std::size_t>(facts.st_size), PROT_READ, MAP_PRIVATE, descriptor, 0);
    if (bytes == MAP_FAILED) error = errno;
  }
  ::close(descriptor);
  if (error != 0) fail_file(file, error);
  if (!regular) throw Error(ErrorKind::kFile, file.string() + ": is not a file: name one");
  if (bytes == nullptr) return;
  text_ = {static_cast<const char*>(bytes), static_cast<std::size_t>(facts.st_size)};
}

MappedFile::~MappedFile() {
  if (!text_.empty()) ::munmap(const_cast<char*>(text_.data()), text_.size());
}

void MappedFile::forget() const {
  if (!text_.empty()) ::madvise(const_cast<char*>(text_.data()), text_.size(), MADV_DONTNEED);
}

}  // namespace hotblade::pipeline::batch

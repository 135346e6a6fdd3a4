#include "tests/paths.hpp"

namespace hotblade::testing {

const std::string& source_dir() {
  static const std::string directory = HOTBLADE_SOURCE_DIR;
  return directory;
}

const std::string& binary_dir() {
  static const std::string directory = HOTBLADE_BINARY_DIR;
  return directory;
}

}  // namespace hotblade::testing

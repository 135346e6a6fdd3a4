// Where the tests find the source tree and the build tree.
#pragma once

#include <string>

namespace hotblade::testing {

[[nodiscard]] const std::string& source_dir();
[[nodiscard]] const std::string& binary_dir();

}  // namespace hotblade::testing

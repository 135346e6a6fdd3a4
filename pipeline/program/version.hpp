// The version of this build, as programs and reports name it.
#pragma once

#include <string>

namespace hotblade::pipeline {

// Returns "X.Y.Z", from the project's CMakeLists.txt.
[[nodiscard]] std::string version();

}  // namespace hotblade::pipeline

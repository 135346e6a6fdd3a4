#include "gpu/backend/backend_choice.hpp"

#include <cstdio>

namespace hotblade::gpu {

std::string rounded_seconds(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g s", seconds);
  return text;
}

}  // namespace hotblade::gpu

// Writes places in messages.
#pragma once

#include <Eigen/Core>
#include <cstdio>
#include <string>

namespace hotblade::surface {

// Returns "(x, y, z) mm" to a micrometre, enough to find the place in a CAD program.
[[nodiscard]] inline std::string place_text(const Eigen::Vector3d& p) {
  char text[96];
  std::snprintf(text, sizeof text, "(%.3f, %.3f, %.3f) mm", p.x(), p.y(), p.z());
  return text;
}

}  // namespace hotblade::surface

// Panels that tests of batches split and plan: level squares, told apart by their heights.
#pragma once

#include <string>

namespace hotblade::pipeline::batch::testing {

// Returns a group of one face in six lines: its name, four corners, the face.
inline std::string square_panel(const std::string& name, double height_mm) {
  std::string text = "g " + name + "\n";
  for (const char* xy : {"0 0", "100 0", "100 100", "0 100"})
    text += "v " + std::string(xy) + " " + std::to_string(height_mm) + "\n";
  return text + "f -4 -3 -2 -1\n";
}
inline constexpr std::size_t kSquarePanelLines = 6;

}  // namespace hotblade::pipeline::batch::testing

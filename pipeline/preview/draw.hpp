// Drawing a scene with VTK without a display.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pipeline/preview/scene.hpp"

namespace hotblade::pipeline::preview {

struct PictureSize {
  int width = 1280, height = 720;
};

// The side that a picture is taken from: obliquely on the cut side, or along an axis of the design frame.
enum class View { kBest, kTop, kFront, kRight };

// The view of a name on the command line (best, top, front, right); absent for an unknown name.
[[nodiscard]] std::optional<View> view_named(const std::string& name);

// The scene as the bytes of a PNG file. Drawing it needs EGL but no display. Throws Error
//  () when the machine has no EGL that can draw off screen.
[[nodiscard]] std::string png_of(const Scene& scene, PictureSize size, View view = View::kBest);

// A picture of several; the caption's lines can be left out to leave their room to the geometry.
struct Shot {
  View view = View::kBest;
  bool caption = true;
  bool by_strip = false;  // the cut coloured by strip, whatever the scene's scale
};

// Says English words in another language.
using Speak = std::function<std::string(const std::string&)>;

// The pictures of one scene from several sides, drawn in one window, their words as they are or as `speak`
// says them; throws as png_of does.
[[nodiscard]] std::vector<std::string> pngs_of(const Scene& scene, PictureSize size,
                                               std::span<const Shot> shots, const Speak& speak = {});

// Throws Error (kBadSettings) when there is no display for a window.
void expect_display();

}  // namespace hotblade::pipeline::preview

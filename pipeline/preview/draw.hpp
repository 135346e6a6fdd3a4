// Drawing a scene with VTK: into memory without a display, or in a window.
#pragma once

#include <string>

#include "pipeline/preview/scene.hpp"

namespace hotblade::pipeline::preview {

struct PictureSize {
  int width = 1280, height = 720;
};

// The scene as the bytes of a PNG file. Needs EGL but no display. Throws CommandError with exit code 1 when
// the machine has no EGL that can draw off screen.
[[nodiscard]] std::string png_of(const Scene& scene, PictureSize size);

// Throws CommandError with exit code 2 when there is no display for a window.
void expect_display();

// Opens a window and returns when it is closed: drag turns, middle button moves, wheel or right button zooms,
// q ends. Throws CommandError with exit code 2 when there is no display.
void show(const Scene& scene, PictureSize size);

}  // namespace hotblade::pipeline::preview

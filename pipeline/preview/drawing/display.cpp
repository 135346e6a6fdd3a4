// Is there an X display? Kept apart because of Xlib's macros.
#include <fmt/format.h>

#include <cstdlib>

#include "pipeline/preview/drawing/draw.hpp"
#include "pipeline/settings/error.hpp"

// After all others: its macros take names that they use.
#include <X11/Xlib.h>

namespace hotblade::pipeline::preview {

// VTK ends the program on a display that it cannot reach or that has no GLX, so both are tried first.
void expect_display() {
  const char* name = std::getenv("DISPLAY");
  if (!name || !*name) throw Error(ErrorKind::kBadSettings, "no display: use --shot FILE.png");
  Display* display = XOpenDisplay(nullptr);
  if (!display) {
    throw Error(ErrorKind::kBadSettings,
                fmt::format("no display (DISPLAY {} cannot be reached): use --shot FILE.png", name));
  }
  int opcode = 0, event = 0, error = 0;
  const bool draws = XQueryExtension(display, "GLX", &opcode, &event, &error);
  XCloseDisplay(display);
  if (!draws) {
    throw Error(ErrorKind::kBadSettings,
                fmt::format("no OpenGL on the display (DISPLAY {} lacks GLX): use --shot FILE.png", name));
  }
}

}  // namespace hotblade::pipeline::preview

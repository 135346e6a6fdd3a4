#include "pipeline/preview/drawing/offscreen.hpp"

// No X11 types: this program draws where no X11 is.
#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <fmt/format.h>

#include <array>
#include <string>

#include "pipeline/settings/error.hpp"

namespace hotblade::pipeline::preview {
namespace {

[[noreturn]] void fail(const std::string& what) {
  throw Error(ErrorKind::kDrawing, fmt::format("picture: {} (EGL error {:#x}): install Mesa's EGL (libegl1, "
                                               "libegl-mesa0, libgl1-mesa-dri) or a driver with EGL",
                                               what, eglGetError()));
}

// Surfaceless needs neither display nor device file; the default display serves drivers that lack it.
EGLDisplay open_display() {
  const auto get_platform_display =
      reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
  EGLint major = 0, minor = 0;
  if (get_platform_display) {
    const EGLDisplay display =
        get_platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display != EGL_NO_DISPLAY && eglInitialize(display, &major, &minor)) return display;
  }
  const EGLDisplay display = eglGetDisplay(EGL_DEFAULT_DISPLAY);
  if (display == EGL_NO_DISPLAY || !eglInitialize(display, &major, &minor)) fail("no EGL display");
  return display;
}

EGLContext open_context(EGLDisplay display) {
  if (!eglBindAPI(EGL_OPENGL_API)) fail("EGL has no OpenGL");
  // The scene is drawn into VTK's own framebuffer, so the configuration's buffers do not matter.
  constexpr std::array<EGLint, 5> kConfig{EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, 0, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (!eglChooseConfig(display, kConfig.data(), &config, 1, &count) || count < 1)
    fail("no OpenGL configuration");
  // VTK 9.1 needs OpenGL 3.2 core.
  constexpr std::array<EGLint, 7> kVersion{EGL_CONTEXT_MAJOR_VERSION,
                                           3,
                                           EGL_CONTEXT_MINOR_VERSION,
                                           2,
                                           EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                           EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                           EGL_NONE};
  const EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, kVersion.data());
  if (context == EGL_NO_CONTEXT) fail("no OpenGL 3.2 context");
  return context;
}

}  // namespace

OffscreenContext::OffscreenContext() {
  display_ = open_display();
  context_ = open_context(display_);
  if (!eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) {
    eglDestroyContext(display_, context_);
    fail("a context without a surface cannot be used");
  }
}

OffscreenContext::~OffscreenContext() {
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(display_, context_);
  // The display is shared by the process: terminating it would break other contexts on it.
}

}  // namespace hotblade::pipeline::preview

// An OpenGL context without display or window.
#pragma once

namespace hotblade::pipeline::preview {

// Current on the thread that made it, until destroyed. Throws CommandError with exit code 1 and what EGL
// lacks.
class OffscreenContext {
 public:
  OffscreenContext();
  ~OffscreenContext();
  OffscreenContext(const OffscreenContext&) = delete;
  OffscreenContext& operator=(const OffscreenContext&) = delete;

 private:
  void* display_ = nullptr;
  void* context_ = nullptr;
};

}  // namespace hotblade::pipeline::preview

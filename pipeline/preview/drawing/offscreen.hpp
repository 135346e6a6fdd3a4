// An OpenGL context without display or window.
#pragma once

namespace hotblade::pipeline::preview {

// A context that is current on the thread that made it, until it is destroyed. Its constructor throws
// Error (kDrawing) and what EGL lacks.
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

// Drawing a scene with VTK without a display.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pipeline/preview/scene.hpp"
#include "pipeline/preview/shot.hpp"

namespace hotblade::pipeline::preview {

// The surfaces of a scene with their normals and borders: made once for all that is drawn or written of it.
class SceneMeshes {
 public:
  explicit SceneMeshes(const Scene& scene);
  ~SceneMeshes();
  SceneMeshes(const SceneMeshes&) = delete;
  SceneMeshes& operator=(const SceneMeshes&) = delete;

  struct Parts;
  [[nodiscard]] const Parts& parts() const { return *parts_; }

 private:
  std::unique_ptr<const Parts> parts_;
};

// Has EGL loaded (drawing.hpp, load_driver).
void load_egl();

// The scene as the bytes of a PNG file. Drawing it needs EGL but no display. Throws Error (kDrawing) when the
// machine has no EGL that can draw off screen.
[[nodiscard]] std::string png_of(const Scene& scene, PictureSize size, View view = View::kBest);

// The pictures of one scene from several sides, drawn in one window, their words as they are or as `speak`
// says them; throws as png_of does.
[[nodiscard]] std::vector<std::string> pngs_of(const Scene& scene, PictureSize size,
                                               std::span<const Shot> shots, const Speak& speak = {});
// The same with the scene's meshes at hand.
[[nodiscard]] std::vector<std::string> pngs_of(const Scene& scene, const SceneMeshes& meshes,
                                               PictureSize size, std::span<const Shot> shots,
                                               const Speak& speak = {});

// Throws Error (kBadSettings) when there is no display for a window.
void expect_display();

}  // namespace hotblade::pipeline::preview

// Drawing a scene with VTK without a display.
#pragma once

#include <functional>
#include <memory>
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

// Has the machine's driver loaded, which takes a while the first time in a process; where there is none, the
// first picture says so. Any thread.
void load_driver();

// The scene as the bytes of a PNG file. Drawing it needs EGL but no display. Throws Error (kDrawing) when the
// machine has no EGL that can draw off screen.
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
// The same with the scene's meshes at hand.
[[nodiscard]] std::vector<std::string> pngs_of(const Scene& scene, const SceneMeshes& meshes,
                                               PictureSize size, std::span<const Shot> shots,
                                               const Speak& speak = {});

// Throws Error (kBadSettings) when there is no display for a window.
void expect_display();

}  // namespace hotblade::pipeline::preview

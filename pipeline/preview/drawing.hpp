// What draws: a library of its own, opened when something is drawn. VTK and what it needs take 25 ms and 30
// MB, which a command that draws nothing would pay for.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pipeline/preview/scene.hpp"
#include "pipeline/preview/shot.hpp"
#include "pipeline/preview/view_model.hpp"

namespace hotblade::pipeline::preview {

// A scene whose surfaces are at hand with their normals and borders, made once for all that is drawn of it.
class DrawnScene {
 public:
  virtual ~DrawnScene() = default;

  // As gltf_of does (drawing/exchange.hpp).
  [[nodiscard]] virtual std::string gltf() const = 0;
  // As pngs_of does (drawing/draw.hpp).
  [[nodiscard]] virtual std::vector<std::string> pngs(PictureSize size, std::span<const Shot> shots,
                                                      const Speak& speak) const = 0;
};

// The functions of pipeline/preview/drawing that others call, each as its header says.
class Drawing {
 public:
  virtual ~Drawing() = default;

  // Of what version of hotblade it is a part.
  [[nodiscard]] virtual const char* version() const = 0;
  virtual void load_driver() const = 0;
  // The scene has to outlive what is returned.
  [[nodiscard]] virtual std::unique_ptr<const DrawnScene> drawn(const Scene& scene) const = 0;
  virtual void write_vtm(const Scene& scene, const std::filesystem::path& file, bool force) const = 0;
  [[nodiscard]] virtual std::string png_of(const ViewModel& model, const ViewState& state,
                                           PictureSize size) const = 0;
  virtual void write_movie(const ViewModel& model, const ViewState& state, const MovieOptions& options,
                           const std::filesystem::path& file, bool force,
                           const std::function<void(double)>& report) const = 0;
  virtual void expect_display() const = 0;
  virtual void show(const ViewModel& model, const ViewState& state, PictureSize size) const = 0;
};

// Returns what draws: what draw_with() has been given, else the library that stands beside the program, which
// gives itself when it is opened. Throws Error (kDrawing) where it cannot be opened or is of another version.
[[nodiscard]] const Drawing& drawing();

// Has `drawing` draw from now on; it has to outlive all that does.
void draw_with(const Drawing& drawing);

// Has the machine's driver loaded, which takes a while the first time in a process; where there is none, the
// first picture says so. Any thread.
void load_driver();

}  // namespace hotblade::pipeline::preview

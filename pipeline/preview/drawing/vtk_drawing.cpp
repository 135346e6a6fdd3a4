#include "pipeline/preview/drawing/vtk_drawing.hpp"

#include "pipeline/preview/drawing/draw.hpp"
#include "pipeline/preview/drawing/exchange.hpp"
#include "pipeline/preview/drawing/movie.hpp"
#include "pipeline/preview/drawing/stage.hpp"
#include "pipeline/preview/drawing/window.hpp"

namespace hotblade::pipeline::preview {
namespace {

class SceneOfVtk final : public DrawnScene {
 public:
  explicit SceneOfVtk(const Scene& scene) : scene_(scene), meshes_(scene) {}

  [[nodiscard]] std::string gltf() const override { return gltf_of(scene_, meshes_); }
  [[nodiscard]] std::vector<std::string> pngs(PictureSize size, std::span<const Shot> shots,
                                              const Speak& speak) const override {
    return pngs_of(scene_, meshes_, size, shots, speak);
  }

 private:
  const Scene& scene_;
  SceneMeshes meshes_;
};

class DrawingByVtk final : public Drawing {
 public:
  [[nodiscard]] const char* version() const override { return HOTBLADE_VERSION; }
  void load_driver() const override { load_egl(); }
  [[nodiscard]] std::unique_ptr<const DrawnScene> drawn(const Scene& scene) const override {
    return std::make_unique<const SceneOfVtk>(scene);
  }
  void write_vtm(const Scene& scene, const std::filesystem::path& file, bool force) const override {
    preview::write_vtm(scene, file, force);
  }
  [[nodiscard]] std::string png_of(const ViewModel& model, const ViewState& state,
                                   PictureSize size) const override {
    return preview::png_of(model, state, size);
  }
  void write_movie(const ViewModel& model, const ViewState& state, const MovieOptions& options,
                   const std::filesystem::path& file, bool force,
                   const std::function<void(double)>& report) const override {
    preview::write_movie(model, state, options, file, force, report);
  }
  void expect_display() const override { preview::expect_display(); }
  void show(const ViewModel& model, const ViewState& state, PictureSize size) const override {
    preview::show(model, state, size);
  }
};

}  // namespace

const Drawing& vtk_drawing() {
  static const DrawingByVtk one;
  return one;
}

}  // namespace hotblade::pipeline::preview

// The parts of a picture: actors for the scene's geometry, camera.
#pragma once

#include <memory>
#include <vector>

#include "pipeline/preview/colors.hpp"
#include "pipeline/preview/drawing/draw.hpp"

class vtkActor;
class vtkImageData;
class vtkRenderer;

namespace hotblade::pipeline::preview {

// What stands for a scene in VTK, owned by the renderer; null where there is nothing to show.
struct SceneActors {
  vtkActor *design = nullptr, *borders = nullptr, *cut = nullptr, *blocks = nullptr, *ribs = nullptr;
  vtkActor *blades = nullptr, *blade_now = nullptr, *clamps_a = nullptr, *clamps_b = nullptr;
  vtkActor* worst = nullptr;
  std::vector<vtkActor*> cell;  // in the scene's order
  double line_depth = 0;        // that puts lines before the surfaces they lie on, for line_actor
};

// Adds the actors of a scene to the renderer; `zoom` is how many pixels are drawn for one of the picture.
SceneActors add_actors(const Scene& scene, vtkRenderer& renderer, double zoom);
// The same with the scene's meshes at hand; they may go before the actors.
SceneActors add_actors(const Scene& scene, const SceneMeshes& meshes, vtkRenderer& renderer, double zoom);

// Colours the cut's actor anew; without a scale by strip.
void color_cut(vtkActor& cut, const Scene& scene, const std::vector<double>& values,
               const std::optional<ColorScale>& scale);

// Adds an actor, which the renderer owns. `width` in pixels drawn; `depth` as in SceneActors.
[[nodiscard]] vtkActor& add_lines(vtkRenderer& renderer, const std::vector<Polyline>& lines, const Rgb& color,
                                  double width, double depth);
void set_actor_lines(vtkActor& actor, const std::vector<Polyline>& lines);

// Adds an actor, which the renderer owns: blocks along the blade where clamps grip, each as large as
// `size_mm`.
[[nodiscard]] vtkActor& add_clamps(vtkRenderer& renderer, const std::vector<Pose>& clamps, double size_mm,
                                   const Rgb& color);
void set_actor_clamps(vtkActor& actor, const std::vector<Pose>& clamps, double size_mm);

// Moves the actors of a scene's cell, and colours those that have margins by them.
void set_cell_places(const SceneActors& actors, const std::vector<CellPlace>& places);
// The colour of a link by what its joint has to its limit: red at it, amber, green.
[[nodiscard]] Rgb margin_color(double margin_rad);

void aim_camera(const Scene& scene, vtkRenderer& renderer, PictureSize size, View view, bool with_time_bar);

// Draws what is in its renderer without a display. Throws Error (kDrawing) when the machine has
// no EGL that can draw off screen.
class Painter {
 public:
  // The number of pixels drawn for one of the picture, each way. Averaged, they give smooth edges and
  // letters without multisampling, which is eight times slower on the software rasterisers that machines
  // without a display have.
  static constexpr int kZoom = 2;

  explicit Painter(PictureSize size);
  ~Painter();
  Painter(const Painter&) = delete;
  Painter& operator=(const Painter&) = delete;

  [[nodiscard]] vtkRenderer& renderer();
  // Draws into the image: RGB, rows from the bottom.
  void paint(vtkImageData& image);

 private:
  struct Window;
  std::unique_ptr<Window> window_;
};

// The image as the bytes of a PNG file.
[[nodiscard]] std::string encoded(vtkImageData& image);

}  // namespace hotblade::pipeline::preview

// The parts of a picture: colours, actors for the scene's geometry, camera.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "pipeline/preview/draw.hpp"

class vtkActor;
class vtkImageData;
class vtkRenderer;

namespace hotblade::pipeline::preview {

using Rgb = std::array<double, 3>;  // 0 to 1

// Light enough for print, dark enough that white surfaces stand out.
constexpr Rgb kBackground{0.925, 0.935, 0.945};
constexpr Rgb kInk{0.13, 0.15, 0.18};
constexpr Rgb kGoodColor{0.07, 0.45, 0.22};
constexpr Rgb kWarningColor{0.63, 0.35, 0.0};
constexpr Rgb kBadColor{0.75, 0.08, 0.08};
constexpr Rgb kDesignColor{0.78, 0.79, 0.80};
constexpr Rgb kRibColor{0.42, 0.45, 0.50};
constexpr Rgb kBladeColor{0.20, 0.42, 0.62};
constexpr Rgb kBladeNowColor{0.85, 0.10, 0.10};
constexpr Rgb kClampAColor{0.10, 0.55, 0.30};
constexpr Rgb kClampBColor{0.85, 0.50, 0.05};
constexpr Rgb kStockColor{0.55, 0.57, 0.60};
constexpr Rgb kPathColor{0.55, 0.30, 0.65};
constexpr Rgb kWorstColor{0.80, 0.10, 0.62};  // no colour of a map
constexpr Rgb kFirstArmColor{0.86, 0.62, 0.36};
constexpr Rgb kSecondArmColor{0.52, 0.62, 0.74};
constexpr Rgb kToolColor{0.30, 0.32, 0.36};
constexpr Rgb kStandingColor{0.80, 0.79, 0.76};
constexpr Rgb kSelectedColor{0.95, 0.10, 0.55};

// The colour of a value on a scale; values outside take the colour of its end.
[[nodiscard]] Rgb color_at(const ColorScale& scale, double value);
// The colour of the strip with this index; colours repeat after eight.
[[nodiscard]] Rgb strip_color(int strip);

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

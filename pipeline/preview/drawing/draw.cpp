#include "pipeline/preview/drawing/draw.hpp"

#include <vtkCallbackCommand.h>
#include <vtkCamera.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkRenderer.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <future>

#include "pipeline/preview/drawing/offscreen.hpp"
#include "pipeline/preview/drawing/overlay.hpp"
#include "pipeline/settings/error.hpp"

namespace hotblade::pipeline::preview {
namespace {

constexpr int kZoom = Painter::kZoom;

// A drawing is kZoom times as large as its picture each way, and drawn tile by tile: each is as large as the
// picture, so that it takes no more memory than that. Rows count from the bottom.
struct Tile {
  int column, row;
};

// Adds the pixels of a tile, RGB rows from the bottom, to the sums of those that become one of the picture.
void add_tile(vtkUnsignedCharArray& pixels, PictureSize size, Tile tile, std::vector<std::uint16_t>& sums) {
  const unsigned char* in = pixels.GetPointer(0);
  for (int y = 0; y < size.height; ++y) {
    const std::ptrdiff_t row = (tile.row * size.height + y) / kZoom * std::ptrdiff_t{size.width};
    for (int x = 0; x < size.width; ++x) {
      const std::ptrdiff_t pixel = row + (tile.column * size.width + x) / kZoom;
      for (std::ptrdiff_t c = 0; c < 3; ++c) {
        std::uint16_t& sum = sums[static_cast<std::size_t>(3 * pixel + c)];
        sum = static_cast<std::uint16_t>(sum + *in++);
      }
    }
  }
}

// Turns a camera, whose projection is parallel, to a tile while it lives: by themselves VTK's tiles are of
// what lies over a scene alone.
class CameraOfTile {
 public:
  CameraOfTile(vtkCamera& camera, Tile tile) : camera_(camera), scale_(camera.GetParallelScale()) {
    camera_.SetParallelScale(scale_ / kZoom);
    camera_.SetWindowCenter(2 * tile.column + 1 - kZoom, 2 * tile.row + 1 - kZoom);
  }
  ~CameraOfTile() {
    camera_.SetParallelScale(scale_);
    camera_.SetWindowCenter(0, 0);
  }
  CameraOfTile(const CameraOfTile&) = delete;
  CameraOfTile& operator=(const CameraOfTile&) = delete;

 private:
  vtkCamera& camera_;
  double scale_;
};

// A window object on a context of our own: VTK's own off-screen window asks for an X display. GLEW as Debian
// builds it loads every function and then complains that there is no GLX; VTK reports that as an error and
// works. Errors of the window are therefore kept, and count only if no picture comes out.
class OffscreenWindow {
 public:
  explicit OffscreenWindow(PictureSize size) : size_(size) {
    vtkNew<vtkCallbackCommand> keep;
    keep->SetClientData(&errors_);
    keep->SetCallback([](vtkObject*, unsigned long, void* errors, void* message) {
      *static_cast<std::string*>(errors) += static_cast<const char*>(message);
    });
    window_->AddObserver(vtkCommand::ErrorEvent, keep);
    window_->SetOwnContext(0);
    window_->SetMapped(false);
    window_->SetReadyForRendering(true);
    window_->SetSupportsOpenGL(1);
    window_->SetIsDirect(1);
    window_->SetIsCurrent(true);
    window_->SetOffScreenRendering(1);
    window_->SetMultiSamples(0);
    window_->SetSize(size.width, size.height);
    window_->SetTileScale(kZoom);
    window_->OpenGLInit();
    window_->AddRenderer(renderer_);
  }
  ~OffscreenWindow() { window_->Finalize(); }
  OffscreenWindow(const OffscreenWindow&) = delete;
  OffscreenWindow& operator=(const OffscreenWindow&) = delete;

  [[nodiscard]] vtkRenderer& renderer() { return *renderer_; }

  // Pixels of a tile as RGB rows from the bottom.
  [[nodiscard]] vtkNew<vtkUnsignedCharArray> render(Tile tile) {
    const auto share = [](int k) { return static_cast<double>(k) / kZoom; };
    window_->SetTileViewport(share(tile.column), share(tile.row), share(tile.column + 1),
                             share(tile.row + 1));
    const CameraOfTile camera(*renderer_->GetActiveCamera(), tile);
    window_->Render();
    vtkNew<vtkUnsignedCharArray> pixels;
    window_->GetPixelData(0, 0, size_.width - 1, size_.height - 1, 0, pixels, 0);
    const vtkIdType expected = vtkIdType{3} * size_.width * size_.height;
    if (pixels->GetNumberOfValues() != expected) {
      throw Error(ErrorKind::kDrawing, "picture: nothing was drawn: " + errors_);
    }
    return pixels;
  }

 private:
  PictureSize size_;
  std::string errors_;
  vtkNew<vtkRenderer> renderer_;
  vtkNew<vtkGenericOpenGLRenderWindow> window_;
};

}  // namespace

void load_egl() {
  try {
    const OffscreenContext context;
  } catch (const Error&) {
    return;
  }
}

std::string encoded(vtkImageData& image) {
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputData(&image);
  writer->WriteToMemoryOn();
  writer->Write();
  vtkUnsignedCharArray* bytes = writer->GetResult();
  return {reinterpret_cast<const char*>(bytes->GetPointer(0)),
          static_cast<std::size_t>(bytes->GetNumberOfValues())};
}

struct Painter::Window {
  explicit Window(PictureSize s) : size(s), window(s) {}
  PictureSize size;
  OffscreenContext context;
  OffscreenWindow window;
};

Painter::Painter(PictureSize size) : window_(std::make_unique<Window>(size)) {}

Painter::~Painter() = default;

vtkRenderer& Painter::renderer() {
  return window_->window.renderer();
}

void Painter::paint(vtkImageData& image) {
  const PictureSize size = window_->size;
  std::vector<std::uint16_t> sums(std::size_t{3} * static_cast<std::size_t>(size.width * size.height), 0);
  for (int row = 0; row < kZoom; ++row) {
    for (int column = 0; column < kZoom; ++column)
      add_tile(*window_->window.render({column, row}), size, {column, row}, sums);
  }
  constexpr int kPixels = kZoom * kZoom;
  image.SetDimensions(size.width, size.height, 1);
  image.AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  std::transform(sums.begin(), sums.end(), static_cast<unsigned char*>(image.GetScalarPointer()),
                 [](std::uint16_t sum) { return static_cast<unsigned char>((sum + kPixels / 2) / kPixels); });
}

namespace {

// Where strips are, by their ids; one that would lie over another is left out. `pixels`: drawn for one of the
// canvas.
void draw_strip_ids(Canvas& canvas, const std::vector<Mark>& ids, vtkRenderer& renderer, double pixels) {
  constexpr double kHeight = 14, kLetter = 0.62 * kHeight, kEdge = 3;
  std::vector<std::array<double, 4>> drawn;
  for (const Mark& id : ids) {
    renderer.SetWorldPoint(id.at.x(), id.at.y(), id.at.z(), 1);
    renderer.WorldToDisplay();
    double place[3];
    renderer.GetDisplayPoint(place);
    const double x = place[0] / pixels, y = place[1] / pixels;
    const double width = kLetter * static_cast<double>(id.words.size()) + 2 * kEdge,
                 height = kHeight + 2 * kEdge;
    const std::array<double, 4> box{x - width / 2, y - height / 2, x + width / 2, y + height / 2};
    const bool free = std::none_of(drawn.begin(), drawn.end(), [&](const std::array<double, 4>& other) {
      return box[0] < other[2] && other[0] < box[2] && box[1] < other[3] && other[1] < box[3];
    });
    if (!free) continue;
    drawn.push_back(box);
    canvas.rectangle(box[0], box[1], width, height, {1, 1, 1}, 0.8);
    canvas.text(x, y, id.words, kHeight, true, Align::kCentre);
  }
}

}  // namespace

std::vector<std::string> pngs_of(const Scene& scene, PictureSize size, std::span<const Shot> shots,
                                 const Speak& speak) {
  return pngs_of(scene, SceneMeshes(scene), size, shots, speak);
}

std::vector<std::string> pngs_of(const Scene& scene, const SceneMeshes& meshes, PictureSize size,
                                 std::span<const Shot> shots, const Speak& speak) {
  Painter painter(size);
  vtkRenderer& renderer = painter.renderer();
  renderer.SetBackground(kBackground[0], kBackground[1], kBackground[2]);
  const SceneActors actors = add_actors(scene, meshes, renderer, Painter::kZoom);
  Sheets sheets(renderer);
  Canvas canvas(sheets, overlay_scale(size) * Painter::kZoom);
  canvas.speak(speak);
  std::vector<vtkNew<vtkImageData>> images(shots.size());
  // Each is packed while the next is drawn.
  std::vector<std::future<std::string>> packed;
  for (std::size_t i = 0; i < shots.size(); ++i) {
    Overlay overlay = overlay_of(scene);
    if (!shots[i].caption) overlay.caption.clear();
    if (shots[i].by_strip) overlay.scale.reset();
    if (actors.cut != nullptr) color_cut(*actors.cut, scene, scene.cut.values, overlay.scale);
    aim_camera(scene, renderer, size, shots[i].view, false);
    draw_overlay(canvas, overlay, size);
    // Smaller they could not be read.
    if (overlay_scale(size) > 0.5)
      draw_strip_ids(canvas, scene.strip_ids, renderer, overlay_scale(size) * Painter::kZoom);
    canvas.finish();
    painter.paint(*images[i]);
    packed.push_back(std::async(std::launch::async, [&image = *images[i]] { return encoded(image); }));
  }
  std::vector<std::string> pngs;
  for (std::future<std::string>& png : packed) pngs.push_back(png.get());
  return pngs;
}

std::string png_of(const Scene& scene, PictureSize size, View view) {
  return pngs_of(scene, size, std::array{Shot{view}}).front();
}

}  // namespace hotblade::pipeline::preview

#include "pipeline/preview/draw.hpp"

#include <vtkCallbackCommand.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkRenderer.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <array>
#include <future>

#include "pipeline/preview/offscreen.hpp"
#include "pipeline/preview/overlay.hpp"
#include "pipeline/settings/error.hpp"

namespace hotblade::pipeline::preview {
namespace {

constexpr int kZoom = Painter::kZoom;

// RGB rows from the bottom, averaged over kZoom x kZoom pixels.
void reduce(vtkUnsignedCharArray& pixels, PictureSize size, vtkImageData& image) {
  image.SetDimensions(size.width, size.height, 1);
  image.AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  auto* out = static_cast<unsigned char*>(image.GetScalarPointer());
  const unsigned char* in = pixels.GetPointer(0);
  const std::ptrdiff_t row_bytes = 3L * size.width * kZoom;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width * 3; ++x) {
      const unsigned char* corner = in + y * kZoom * row_bytes + (x / 3) * 3 * kZoom + x % 3;
      int sum = kZoom * kZoom / 2;
      for (int v = 0; v < kZoom; ++v) {
        for (int u = 0; u < kZoom; ++u) sum += corner[v * row_bytes + 3 * u];
      }
      *out++ = static_cast<unsigned char>(sum / (kZoom * kZoom));
    }
  }
}

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
    window_->SetSize(size.width * kZoom, size.height * kZoom);
    window_->OpenGLInit();
    window_->AddRenderer(renderer_);
  }
  ~OffscreenWindow() { window_->Finalize(); }
  OffscreenWindow(const OffscreenWindow&) = delete;
  OffscreenWindow& operator=(const OffscreenWindow&) = delete;

  [[nodiscard]] vtkRenderer& renderer() { return *renderer_; }

  // Pixels as RGB rows from the bottom, kZoom times the picture's size.
  [[nodiscard]] vtkNew<vtkUnsignedCharArray> render() {
    window_->Render();
    vtkNew<vtkUnsignedCharArray> pixels;
    window_->GetPixelData(0, 0, size_.width * kZoom - 1, size_.height * kZoom - 1, 0, pixels, 0);
    const vtkIdType expected = vtkIdType{3} * size_.width * kZoom * size_.height * kZoom;
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

void load_driver() {
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
  const auto pixels = window_->window.render();
  reduce(*pixels, window_->size, image);
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

#include "pipeline/preview/draw.hpp"

#include <vtkCallbackCommand.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkImageData.h>
#include <vtkInteractorStyleTrackballCamera.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>
#include <vtkUnsignedCharArray.h>

#include "pipeline/command_error.hpp"
#include "pipeline/preview/draw_parts.hpp"
#include "pipeline/preview/offscreen.hpp"

namespace hotblade::pipeline::preview {
namespace {

// Drawn twice as large and averaged: smooth edges and letters without multisampling, which is eight times
// slower on the software rasterisers that machines without a display have.
constexpr int kZoom = 2;

void compose(const Scene& scene, const Scene& framed, vtkRenderer& renderer, PictureSize size, double zoom,
             View view) {
  renderer.SetBackground(kBackground[0], kBackground[1], kBackground[2]);
  add_actors(scene, renderer, zoom);
  add_overlay(scene, renderer, size, zoom);
  aim_camera(framed, renderer, size, view);
}

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

std::string encoded(vtkImageData& image) {
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputData(&image);
  writer->WriteToMemoryOn();
  writer->Write();
  vtkUnsignedCharArray* bytes = writer->GetResult();
  return {reinterpret_cast<const char*>(bytes->GetPointer(0)),
          static_cast<std::size_t>(bytes->GetNumberOfValues())};
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
  }
  ~OffscreenWindow() { window_->Finalize(); }
  OffscreenWindow(const OffscreenWindow&) = delete;
  OffscreenWindow& operator=(const OffscreenWindow&) = delete;

  // Pixels as RGB rows from the bottom, kZoom times the picture's size.
  [[nodiscard]] vtkNew<vtkUnsignedCharArray> render(vtkRenderer& renderer) {
    window_->AddRenderer(&renderer);
    window_->Render();
    vtkNew<vtkUnsignedCharArray> pixels;
    window_->GetPixelData(0, 0, size_.width * kZoom - 1, size_.height * kZoom - 1, 0, pixels, 0);
    const vtkIdType expected = vtkIdType{3} * size_.width * kZoom * size_.height * kZoom;
    if (pixels->GetNumberOfValues() != expected) {
      throw CommandError(Exit::kInternal, "picture: nothing was drawn: " + errors_);
    }
    return pixels;
  }

 private:
  PictureSize size_;
  std::string errors_;
  vtkNew<vtkGenericOpenGLRenderWindow> window_;
};

}  // namespace

void draw_image(const Scene& scene, const Scene& framed, PictureSize size, View view, vtkImageData& image) {
  const OffscreenContext context;
  vtkNew<vtkRenderer> renderer;
  OffscreenWindow window(size);
  compose(scene, framed, *renderer, size, kZoom, view);
  const auto pixels = window.render(*renderer);
  reduce(*pixels, size, image);
}

std::string png_of(const Scene& scene, PictureSize size, View view) {
  vtkNew<vtkImageData> image;
  draw_image(scene, scene, size, view, *image);
  return encoded(*image);
}

void show(const Scene& scene, PictureSize size, View view) {
  expect_display();
  vtkNew<vtkRenderWindow> window;
  window->SetSize(size.width, size.height);
  window->SetWindowName(("hotblade: " + scene.title).c_str());
  window->SetMultiSamples(4);
  vtkNew<vtkRenderer> renderer;
  window->AddRenderer(renderer);
  compose(scene, scene, *renderer, size, 1, view);
  vtkNew<vtkRenderWindowInteractor> interactor;
  vtkNew<vtkInteractorStyleTrackballCamera> style;
  interactor->SetInteractorStyle(style);
  interactor->SetRenderWindow(window);
  window->Render();
  interactor->Start();
}

}  // namespace hotblade::pipeline::preview

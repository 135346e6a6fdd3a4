// A model in a renderer: geometry is built once, and a change of state moves, hides or colours it. The same
// stage draws the window and the pictures made without a display.
#pragma once

#include <array>
#include <memory>

#include "pipeline/preview/drawing/overlay.hpp"
#include "pipeline/preview/drawing/picking.hpp"

namespace hotblade::pipeline::preview {

class Stage {
 public:
  // Model and renderer have to outlive the stage. `zoom` is how many pixels are drawn for one of the
  // picture.
  Stage(const ViewModel& model, vtkRenderer& renderer, PictureSize size, double zoom);
  ~Stage();
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  // Brings the renderer from the state shown before to this one; the first call aims the camera.
  void show(const ViewState& state);

  // Gives the picture another size from the next show() on.
  void resize(PictureSize size);
  [[nodiscard]] PictureSize size() const;

  // The part that the camera sees now under a pixel, x and y from the lower left.
  [[nodiscard]] Picked pick_at(const ViewState& state, double x, double y) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

// The window's picture of a state as the bytes of a PNG file, drawn without a display; throws as
// png_of(scene) does.
[[nodiscard]] std::string png_of(const ViewModel& model, const ViewState& state, PictureSize size);

}  // namespace hotblade::pipeline::preview

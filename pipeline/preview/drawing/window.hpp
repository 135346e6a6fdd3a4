// The window: keys, clicks and the clock become changes of the state, which the stage shows.
#pragma once

#include "pipeline/preview/view_model.hpp"

namespace hotblade::pipeline::preview {

// Opens a window on the model, and returns when it is closed. Throws Error (kBadSettings) when
// there is no display, or one without GLX.
void show(const ViewModel& model, const ViewState& state, PictureSize size);

}  // namespace hotblade::pipeline::preview

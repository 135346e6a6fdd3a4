// This room as what draws (drawing.hpp).
#pragma once

#include "pipeline/preview/drawing.hpp"

namespace hotblade::pipeline::preview {

[[nodiscard]] const Drawing& vtk_drawing();

}  // namespace hotblade::pipeline::preview

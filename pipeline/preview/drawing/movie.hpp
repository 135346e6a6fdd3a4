// The cut as a film: Ogg Theora, drawn without a display.
#pragma once

#include <filesystem>
#include <functional>

#include "pipeline/preview/view_model.hpp"

namespace hotblade::pipeline::preview {

// Writes a film of what the window shows in `state`, over the model's whole time: the camera stands still,
// the cut grows with the blade. `report` is called before each frame with the share done. `file` is written
// whole or not at all. Throws Error as png_of does, and (kFile) when the file cannot be written.
void write_movie(const ViewModel& model, ViewState state, const MovieOptions& options,
                 const std::filesystem::path& file, bool force, const std::function<void(double)>& report);

}  // namespace hotblade::pipeline::preview

// The cut as a film: Ogg Theora, drawn without a display.
#pragma once

#include <filesystem>
#include <functional>

#include "pipeline/preview/draw.hpp"

namespace hotblade::pipeline::preview {

struct MovieOptions {
  PictureSize size;
  View view = View::kBest;
  int frames = 60;
  int frames_per_s = 12;
};

// One frame for each of `frames` times from start to end; `scene_at` makes the scene of a time and is called
// in order. The camera stands where all of `framed` is seen. Written to `file`, whole or not at all. Throws
// CommandError as png_of does, and (7) when the file cannot be written.
void write_movie(const std::function<Scene(double)>& scene_at, const Scene& framed, double start_s,
                 double end_s, const MovieOptions& options, const std::filesystem::path& file, bool force);

}  // namespace hotblade::pipeline::preview

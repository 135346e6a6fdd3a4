// Cells and arms that the program brings, so that it needs no files beside it.
#pragma once

#include <span>

namespace hotblade::pipeline {

struct EmbeddedFile {
  const char* path;  // "cells/two_irb4600.toml", "arms/abb_irb4600_40_255/arm.urdf"
  const char* text;
};

// Returns all, cells first. The texts are those of samples/cells and data/arms (cmake/EmbedFiles.cmake).
[[nodiscard]] std::span<const EmbeddedFile> embedded_files();

}  // namespace hotblade::pipeline

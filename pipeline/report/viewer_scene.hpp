// The scene of the view in report.html: what the pictures show, quantised, packed and written as text, for
// pipeline/report/viewer.js to draw. The same plan gives the same bytes.
//
// The bytes are gzip over: the magic "HBV1", the header's length (4 bytes, low first), the header (JSON), and
// the arrays that the header lists one after the other. An array is the list of its numbers or of their
// first or second differences, zigzag coded, low bytes first, then the next ones: what is smooth packs well.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "pipeline/preview/scene.hpp"
#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

// What `plan --viewer` says.
enum class Viewer { kFull, kLight, kNone };
[[nodiscard]] std::optional<Viewer> viewer_named(const std::string& name);

struct ViewerLimits {
  std::size_t triangles = 200000;
  std::size_t text_bytes = 1000000;  // of the scene in the page
};
[[nodiscard]] ViewerLimits limits_of(Viewer viewer);

struct ViewerScene {
  std::string text;  // base64, in lines
  std::size_t triangles = 0;
  // Every so many rows of the cut, and points of a row, are drawn; 1: all of them.
  std::size_t row_step = 1, column_step = 1;
  // Is the design drawn with fewer triangles than it has?
  bool coarse_design = false;
};

// Returns the scene of a program, within the limits: rows of the cut are left out evenly, then points of the
// rows, and a design of more than a quarter of the triangles is drawn by fewer. Positions stand on a grid of
// 65,535 steps over the scene's box, normals have 2 bytes, colours 1. `program` has no strips where nothing
// is cut.
[[nodiscard]] ViewerScene viewer_scene(const preview::Scene& scene, const Program& program,
                                       const ViewerLimits& limits);

// Returns the bytes as base64 in one line.
[[nodiscard]] std::string base64(const std::string& bytes);

}  // namespace hotblade::pipeline

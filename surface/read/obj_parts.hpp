// Looks through OBJ text in parts, side by side, for what has to be known before each part can be read alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "surface/read/obj_statements.hpp"

namespace hotblade::surface {

// Some whole lines of OBJ text, and what stands in and before them.
struct ObjPart {
  std::size_t begin = 0, end = 0;  // bytes of the text
  std::size_t lines = 0, vertices = 0, faces = 0, corners = 0;
  std::vector<std::size_t> names;  // where statements of objects and groups start
  ObjStatements::Before before;
  std::size_t faces_before = 0, corners_before = 0;
};

// Returns parts of about `bytes` each, the first at the beginning, what stands before each among them.
// Nothing where lines may be joined or ended otherwise than by LF and CR LF, or there is more of anything
// than ObjStatements::kMost: such text is read in one.
[[nodiscard]] std::optional<std::vector<ObjPart>> obj_parts(std::string_view text, std::size_t bytes);

}  // namespace hotblade::surface

// Reads the text of an OBJ file, checked statement by statement: positions and polygons as written, nothing
// repaired.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hotblade::surface {

// Holds all polygons in one flat array: face f has corners[first_corner[f]] .. corners[first_corner[f + 1]].
struct ObjText {
  std::vector<Eigen::Vector3d> positions;   // in the file's units and axes
  std::vector<int> corners;                 // indices into positions, from 0
  std::vector<std::uint32_t> first_corner;  // faces + 1 entries
  std::vector<std::uint32_t> face_line;     // where face f starts, from 1
  std::vector<std::uint32_t> face_group;    // index into groups
  // The names in force for a face, as written: the words after `o` joined by blanks, and those after `g`.
  struct Group {
    std::string object;
    std::vector<std::string> names;
    // Tells whether `name` is the object, one of the group's names, or all of them joined by blanks.
    [[nodiscard]] bool has(std::string_view name) const;
  };
  std::vector<Group> groups;
  std::vector<std::string> warnings;  // statements that were passed over although they may carry geometry

  [[nodiscard]] std::size_t faces() const { return face_line.size(); }
  // Returns the corners of face f, as indices into positions.
  [[nodiscard]] std::span<const int> face(std::size_t f) const {
    return std::span(corners).subspan(first_corner[f], first_corner[f + 1] - first_corner[f]);
  }
};

// Returns what OBJ text holds. `name` is the file's name in messages, `limit` the largest coordinate taken,
// in the file's units. Throws MeshError for the first line that is not usable.
[[nodiscard]] ObjText parse_obj(std::string_view text, const std::string& name, double limit);

// Drops the faces outside the group or object `group`; vertices stay. Throws MeshError, with `name` and the
// groups there are, when no face is left.
void keep_group(ObjText& obj, const std::string& group, const std::string& name);

}  // namespace hotblade::surface

// What every reader takes from a design's file: positions and polygons as they stand there, nothing repaired.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hotblade::surface {

// Ten kilometres: far beyond any building part, so a larger coordinate is a damaged number or a wrong unit.
inline constexpr double kLargestCoordinateMm = 1e7;

// Holds all polygons in one flat array: face f has corners[first_corner[f]] .. corners[first_corner[f + 1]].
struct Polygons {
  std::vector<Eigen::Vector3d> positions;  // in the file's units and axes
  std::size_t joined = 0;                  // positions that the file has more: each is one of these again
  std::vector<int> corners;                // indices into positions, from 0
  std::vector<std::uint32_t> first_corner{0U};  // faces + 1 entries
  // What a face is counted by in the file (line, facet, face or triangle), and of each its number, from 1.
  std::string_view place = "line";
  std::vector<std::uint32_t> face_place;
  std::vector<std::uint32_t> face_group;  // index into groups
  // The names in force for a face, as written: of its object (the words after `o` joined by blanks, a solid,
  // a node), and of its groups (those after `g`, a mesh).
  struct Group {
    std::string object;
    std::vector<std::string> names;
    // Tells whether `name` is the object, one of the group's names, or all of them joined by blanks.
    [[nodiscard]] bool has(std::string_view name) const;
  };
  std::vector<Group> groups{Group{}};
  // The distance of neighbouring numbers of single precision at the largest coordinate, in the file's units;
  // 0 where coordinates are of double precision.
  double spacing = 0;
  std::vector<std::string> warnings;  // what was passed over although it may carry geometry
  std::string beside;                 // the bytes of further files that the design's file names

  [[nodiscard]] std::size_t faces() const { return face_place.size(); }
  // Returns the corners of face f, as indices into positions.
  [[nodiscard]] std::span<const int> face(std::size_t f) const {
    return std::span(corners).subspan(first_corner[f], first_corner[f + 1] - first_corner[f]);
  }
};

// Drops the faces outside the group or object `group`; vertices stay. Throws MeshError, with `name` and the
// groups there are, when no face is left.
void keep_group(Polygons& polygons, const std::string& group, const std::string& name);

// Returns the beginning of a message about a place of a file: `name:12: ` of a line, else `name: facet 12: `.
[[nodiscard]] std::string place_of(const std::string& name, std::string_view place, std::size_t number);

// Returns why a coordinate cannot be taken, with the number as it is shown; empty when it can. `limit` is the
// largest one taken, in the file's units.
[[nodiscard]] std::string refusal_of_coordinate(double value, std::string_view shown, double limit);
// The same of three numbers in binary: of the first that cannot be taken.
[[nodiscard]] std::string refusal_of_position(const Eigen::Vector3d& position, double limit);

// Returns the distance of neighbouring numbers of single precision at the largest of the positions.
[[nodiscard]] double single_precision_spacing(std::span<const Eigen::Vector3d> positions);

}  // namespace hotblade::surface

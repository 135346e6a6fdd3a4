// Reads the design: a triangulated surface in the design frame (mm, +z up), read strictly from OBJ, STL, PLY
// or glTF, with its health measured.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "surface/read/file_format.hpp"
#include "surface/read/triangle_mesh.hpp"

namespace hotblade::surface {

// The text or the geometry of the input is not usable; what() reads `file:line: what (value, limit): hint`.
struct MeshError : std::runtime_error {
  using std::runtime_error::runtime_error;
};
// The file is missing or cannot be read.
struct FileError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Says what was found in the file and in the mesh. Counts are of the mesh as used, but for
// non_manifold_vertices, degenerate_faces, duplicate_faces and unused_vertices, which tell what was found and
// repaired. Border figures of a mesh with blockers stay 0.
struct Health {
  std::size_t file_vertices = 0, file_faces = 0;  // as written
  std::size_t vertices = 0, triangles = 0;
  std::size_t components = 0;
  std::size_t border_loops = 0;
  double border_length_mm = 0;
  std::size_t non_manifold_edges = 0, non_manifold_vertices = 0;
  std::size_t degenerate_faces = 0, duplicate_faces = 0, unused_vertices = 0;
  bool orientable = true;
  bool closed = false;  // no border at all
  double area_mm2 = 0;
  std::array<Eigen::Vector3d, 2> bbox_mm{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  std::vector<std::string> repairs;   // what was changed, one line each, with counts
  std::vector<std::string> warnings;  // implausible size and the like, said with the number
  std::vector<std::string> blockers;  // why the mesh cannot be sliced; empty: sliceable
};

struct DesignSurface {
  TriangleMesh mesh;
  // What a face is counted by in the file (line, facet, face or triangle), and per triangle its face's
  // number.
  std::string_view place = "line";
  std::vector<std::uint32_t> face_place;
  Health health;
  FileFormat format = FileFormat::kObj;
  std::string file_name;  // base name
  std::string sha256;     // of the file's bytes, lower-case hex
  std::string units;      // mm, cm, m, in or ft
  char up = 'z';
  double scale_to_mm = 1;
};

struct ReadOptions {
  std::string units;       // required: mm, cm, m, in or ft
  char up = 'z';           // 'z' or 'y'; y-up input is turned (x, y, z) -> (x, -z, y)
  std::string group = {};  // takes the faces of this group or object only; empty: all
  // Takes the faces whose normal, as the file winds them, is within facing_max_rad of this direction of the
  // design frame, of any length; absent: all.
  std::optional<Eigen::Vector3d> facing = std::nullopt;
  double facing_max_rad = 1.4;
  double stitch_mm = 0;  // joins border vertices of the design that lie within this distance; 0: none
  std::optional<FileFormat> format = std::nullopt;  // absent: as format_of() tells
  // Warns where the file's single precision is coarser than this; 0: never.
  double resolution_mm = 0;
};

// Returns how many mm a unit of this name has; throws std::logic_error for an unknown name.
[[nodiscard]] double scale_to_mm(const std::string& units);

// Reads a design: its file is checked line by line or number by number, then its faces become a half-edge
// mesh, on which they are repaired and measured. Throws FileError, or MeshError for the first place that is
// not usable. Geometry that can be read but not sliced is reported in health.blockers, not thrown. Face
// normals are made to agree within a component where that is possible.
[[nodiscard]] DesignSurface read_surface(const std::filesystem::path& file, const ReadOptions& options);

// The same of a file's bytes that are at hand; messages name them `file`, and what a glTF file refers to is
// looked for beside it.
[[nodiscard]] DesignSurface surface_of(std::string bytes, const std::filesystem::path& file,
                                       const ReadOptions& options);

// The same of an OBJ, whatever its name ends with.
[[nodiscard]] DesignSurface read_obj(const std::filesystem::path& file, const ReadOptions& options);

}  // namespace hotblade::surface

#include "surface/read/file_format.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <string>
#include <utility>

#include "surface/read/bytes.hpp"
#include "surface/read/design_surface.hpp"
#include "surface/read/words.hpp"

namespace hotblade::surface {
namespace {

constexpr std::array<std::pair<FileFormat, std::string_view>, 4> kWords{{{FileFormat::kObj, "obj"},
                                                                         {FileFormat::kStl, "stl"},
                                                                         {FileFormat::kPly, "ply"},
                                                                         {FileFormat::kGltf, "gltf"}}};

// What a file's name ends with, in lower case, with its point.
std::string ending_of(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  for (char& c : ending) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  return ending;
}

// A format of other programs, and what makes a design of it (docs/inputs.md, Other formats).
struct OtherFormat {
  std::string_view name;
  std::string_view head;                    // its first bytes; empty: they do not tell
  std::string_view word;                    // that stands among them; empty: any
  std::array<std::string_view, 4> endings;  // of names
  std::string_view conversion;
  std::string_view then = "";  // options that what comes of it is read with
};

constexpr std::string_view kByGmsh = "gmsh IN -2 -clmax 20 -clcurv 200 -format stl -o out.stl",
                           kByMeshio = "meshio convert IN out.obj", kByAssimp = "assimp export IN out.obj";
// meshio reads grids of VTK and no polygons.
constexpr std::string_view
    kPolygonsByVtk =
        "python3 -c \"import vtk; r = vtk.vtkPolyDataReader(); r.SetFileName('IN'); "
        "w = vtk.vtkPLYWriter(); w.SetFileName('out.ply'); "
        "w.SetInputConnection(r.GetOutputPort()); w.Write()\"",
    kXmlByVtk =
        "python3 -c \"import vtk; r = vtk.vtkXMLPolyDataReader(); r.SetFileName('IN'); "
        "w = vtk.vtkPLYWriter(); w.SetFileName('out.ply'); "
        "w.SetInputConnection(r.GetOutputPort()); w.Write()\"";
constexpr std::array<OtherFormat, 10> kOthers{{
    {"STEP", "ISO-10303-21", "", {".step", ".stp"}, kByGmsh},
    {"IGES", "", "", {".iges", ".igs"}, kByGmsh},
    {"BREP", "DBRep_DrawableShape", "", {".brep"}, kByGmsh},
    {"VTK", "# vtk DataFile", "POLYDATA", {".vtk"}, kPolygonsByVtk},
    {"VTK", "# vtk DataFile", "", {".vtk", ".vtu"}, kByMeshio},
    {"VTP", "", "", {".vtp"}, kXmlByVtk},
    {"MSH", "$MeshFormat", "", {".msh"}, kByMeshio},
    {"DAE, FBX, 3DS or 3MF", "", "", {".dae", ".fbx", ".3ds", ".3mf"}, kByAssimp},
    {"OFF", "", "", {".off"}, kByAssimp},
    {"DXF", "", "", {".dxf"}, kByAssimp, "--up y"},
}};
// No converter at hand reads what these programs write: they export it themselves.
struct OtherProgram {
  std::string_view ending, name;
};
constexpr std::array<OtherProgram, 3> kPrograms{
    {{".3dm", "Rhino"}, {".dwg", "AutoCAD"}, {".skp", "SketchUp"}}};

void refuse_other_formats(std::string_view head, const std::filesystem::path& file) {
  const std::string ending = ending_of(file);
  for (const OtherProgram& program : kPrograms) {
    if (ending != program.ending) continue;
    const std::string name(program.name);
    throw MeshError(file.string() + ": a file of " + name + ", which is not read: export it from " + name +
                    " as OBJ or STL, polygon mesh");
  }
  for (const OtherFormat& other : kOthers) {
    const bool named = !ending.empty() &&
                       std::find(other.endings.begin(), other.endings.end(), ending) != other.endings.end();
    if (!named && (other.head.empty() || !head.starts_with(other.head))) continue;
    if (head.find(other.word) == std::string_view::npos) continue;
    std::string line(other.conversion);
    line.replace(line.find("IN"), 2, file.filename().string());
    throw MeshError(file.string() + ": of format " + std::string(other.name) + " by its " +
                    (named ? "name" : "first bytes") + ", which is not read: convert it, as by `" + line +
                    "`" + (other.then.empty() ? "" : " and read that with " + std::string(other.then)) +
                    ", or say with --format what it is");
  }
}

std::optional<FileFormat> by_name(const std::filesystem::path& file) {
  const std::string ending = ending_of(file);
  if (ending.empty()) return std::nullopt;
  return ending == ".glb" ? FileFormat::kGltf : format_named(ending.substr(1));
}

// The header of a binary STL may hold anything, so its size is asked first.
bool has_size_of_stl(std::string_view head, std::uintmax_t size) {
  constexpr std::size_t kCountAt = 80;
  return head.size() >= kCountAt + 4 &&
         size == kCountAt + 4 + std::uintmax_t{50} * number_at<std::uint32_t>(head, kCountAt);
}

// In OBJ text `solid` would be a word to pass over, so the line after it is looked at too.
bool begins_as_text_stl(std::string_view head) {
  Words words(head);
  if (words.next() != "solid") return false;
  (void)words.rest_of_line();
  const std::string_view word = words.next();
  return word == "facet" || word == "endsolid";
}

std::optional<FileFormat> by_content(std::string_view head, std::uintmax_t size) {
  if (head.starts_with("glTF")) return FileFormat::kGltf;
  if (head.starts_with("ply\n") || head.starts_with("ply\r")) return FileFormat::kPly;
  if (has_size_of_stl(head, size) || begins_as_text_stl(head)) return FileFormat::kStl;
  if (Words(head).next().starts_with('{')) return FileFormat::kGltf;
  return std::nullopt;
}

}  // namespace

std::string_view name(FileFormat format) {
  for (const auto& [value, word] : kWords) {
    if (value == format) return word;
  }
  return "";
}

std::optional<FileFormat> format_named(std::string_view word) {
  for (const auto& [value, known] : kWords) {
    if (known == word) return value;
  }
  return std::nullopt;
}

FileFormat format_of(std::string_view head, std::uintmax_t size, const std::filesystem::path& file) {
  const std::optional<FileFormat> said = by_content(head, size), named = by_name(file);
  if (said && named && *said != *named) {
    throw MeshError(file.string() + ": the name says " + std::string(name(*named)) + ", the bytes say " +
                    std::string(name(*said)) +
                    ": rename the file, or say which with --format or design.format");
  }
  if (!said && !named) refuse_other_formats(head, file);
  return said ? *said : named.value_or(FileFormat::kObj);
}

std::optional<FileFormat> format_of_file(const std::filesystem::path& file) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  std::ifstream stream(file, std::ios::binary);
  if (error || !stream) return std::nullopt;
  std::string head(kFormatHead, '\0');
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(stream.gcount()));
  return format_of(head, size, file);
}

}  // namespace hotblade::surface

#include "surface/read/design_surface.hpp"

#include <openssl/evp.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <utility>

#include "surface/read/gltf.hpp"
#include "surface/read/mesh_health.hpp"
#include "surface/read/mesh_repair.hpp"
#include "surface/read/obj_text.hpp"
#include "surface/read/ply.hpp"
#include "surface/read/polygons.hpp"
#include "surface/read/stl.hpp"
#include "surface/read/warning.hpp"

namespace hotblade::surface {
namespace {

[[noreturn]] void file_error(const std::filesystem::path& file, const std::string& why) {
  throw FileError(file.string() + ": " + why);
}

std::string read_whole(const std::filesystem::path& file) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) file_error(file, "no such file: check the path");
  if (std::filesystem::is_directory(status))
    file_error(file, "is a directory, not a file: name a mesh's file");
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"), std::fclose);
  if (!stream)
    file_error(file, std::string("cannot be opened (") + std::strerror(errno) + "): check the permissions");
  std::string text;
  const auto size = std::filesystem::file_size(file, error);
  if (!error) text.reserve(size);
  std::array<char, 1 << 16> block;
  for (std::size_t n = 0; (n = std::fread(block.data(), 1, block.size(), stream.get())) > 0;) {
    text.append(block.data(), n);
  }
  if (std::ferror(stream.get()) != 0)
    file_error(file, std::string("cannot be read (") + std::strerror(errno) + ")");
  return text;
}

std::string sha256_of(const std::string& bytes) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int length = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), &length, EVP_sha256(), nullptr) != 1) {
    throw std::runtime_error("SHA-256 is not available from OpenSSL: check its configuration");
  }
  std::string hex;
  for (unsigned int i = 0; i < length; ++i) {
    constexpr const char* kDigits = "0123456789abcdef";
    hex += kDigits[digest[i] >> 4];
    hex += kDigits[digest[i] & 15];
  }
  return hex;
}

void to_design_frame(std::vector<Eigen::Vector3d>& positions, double scale, char up) {
  for (Eigen::Vector3d& p : positions) {
    p *= scale;
    if (up == 'y') p = Eigen::Vector3d(p.x(), -p.z(), p.y());
  }
}

Polygons parse(std::string_view bytes, FileFormat format, const std::filesystem::path& file, double limit) {
  switch (format) {
    case FileFormat::kObj:
      return parse_obj(bytes, file.string(), limit);
    case FileFormat::kStl:
      return parse_stl(bytes, file.string(), limit);
    case FileFormat::kPly:
      return parse_ply(bytes, file.string(), limit);
    case FileFormat::kGltf:
      return parse_gltf(bytes, file, limit, read_whole);
  }
  throw std::logic_error("no reader for a format");
}

// glTF is in metres with y up, whatever is asked for.
void take_units(DesignSurface& design, const std::filesystem::path& file, const ReadOptions& options) {
  const bool gltf = design.format == FileFormat::kGltf;
  if (gltf && !options.units.empty() && options.units != "m")
    throw MeshError(file.string() + ": glTF is in metres, not in " + options.units + ": leave the unit out");
  design.units = gltf ? "m" : options.units;
  design.up = gltf ? 'y' : options.up;
  design.scale_to_mm = scale_to_mm(design.units);
}

void warn_of_spacing(Polygons& polygons, double scale_to_mm, double resolution_mm) {
  const double spacing_mm = polygons.spacing * scale_to_mm;
  if (!(resolution_mm > 0) || spacing_mm <= resolution_mm) return;
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2g", spacing_mm);
  polygons.warnings.push_back(text_of(Warning::kSinglePrecision, {std::string(text.data())}));
}

}  // namespace

double scale_to_mm(const std::string& units) {
  constexpr std::array<std::pair<const char*, double>, 5> kScales = {
      {{"mm", 1}, {"cm", 10}, {"m", 1000}, {"in", 25.4}, {"ft", 304.8}}};
  for (const auto& [name, scale] : kScales) {
    if (units == name) return scale;
  }
  throw std::logic_error("unknown unit ('" + units + "'): give mm, cm, m, in or ft");
}

DesignSurface surface_of(std::string text, const std::filesystem::path& file, const ReadOptions& options) {
  if (options.up != 'z' && options.up != 'y') {
    throw std::logic_error(std::string("unknown up axis ('") + options.up + "'): give z or y");
  }
  if (!(options.stitch_mm >= 0) || (options.facing && !(options.facing->norm() > 0))) {
    throw std::logic_error("read_surface: stitch_mm has to be 0 or more and facing has to have a length");
  }
  DesignSurface design;
  design.file_name = file.filename().string();
  design.format = options.format ? *options.format : format_of(text, text.size(), file);
  take_units(design, file, options);
  Polygons polygons = parse(text, design.format, file, kLargestCoordinateMm / design.scale_to_mm);
  design.sha256 = sha256_of(polygons.beside.empty() ? text : text + polygons.beside);
  std::string().swap(text);
  std::string().swap(polygons.beside);
  design.place = polygons.place;
  warn_of_spacing(polygons, design.scale_to_mm, options.resolution_mm);
  design.health.file_vertices = polygons.positions.size();
  design.health.file_faces = polygons.faces();
  design.health.warnings = std::move(polygons.warnings);
  if (!options.group.empty()) {
    keep_group(polygons, options.group, file.string());
    design.health.repairs.push_back("took the " + std::to_string(polygons.faces()) + " of " +
                                    std::to_string(design.health.file_faces) + " faces in group " +
                                    options.group);
  }
  to_design_frame(polygons.positions, design.scale_to_mm, design.up);
  std::vector<Eigen::Vector3d> positions = std::exchange(polygons.positions, {});
  RepairedMesh repaired =
      repair_mesh(std::move(polygons), std::move(positions), options, file.string(), design.health);
  measure_mesh(repaired.mesh, design.health);
  design.mesh = repaired.mesh;
  design.face_place = std::move(repaired.place);
  return design;
}

DesignSurface read_surface(const std::filesystem::path& file, const ReadOptions& options) {
  return surface_of(read_whole(file), file, options);
}

DesignSurface read_obj(const std::filesystem::path& file, const ReadOptions& options) {
  ReadOptions as_obj = options;
  as_obj.format = FileFormat::kObj;
  return read_surface(file, as_obj);
}

}  // namespace hotblade::surface

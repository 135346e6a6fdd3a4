#include "surface/read/design_surface.hpp"

#include <openssl/evp.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <limits>
#include <memory>
#include <utility>

#include "surface/read/blocks.hpp"
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

// The bytes of a file.
class FileBytes {
 public:
  FileBytes() = default;
  explicit FileBytes(std::string bytes) : text_(std::move(bytes)) {}
  FileBytes(std::unique_ptr<char[]> block, std::size_t size) : block_(std::move(block)), size_(size) {}

  [[nodiscard]] std::string_view view() const {
    return block_ ? std::string_view(block_.get(), size_) : std::string_view(text_);
  }

 private:
  std::string text_;
  std::unique_ptr<char[]> block_;
  std::size_t size_ = 0;
};

using Stream = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

Stream opened(const std::filesystem::path& file) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) file_error(file, "no such file: check the path");
  if (std::filesystem::is_directory(status))
    file_error(file, "is a directory, not a file: name a mesh's file");
  Stream stream(std::fopen(file.c_str(), "rb"), std::fclose);
  if (!stream)
    file_error(file, std::string("cannot be opened (") + std::strerror(errno) + "): check the permissions");
  return stream;
}

std::string read_whole(const std::filesystem::path& file) {
  const Stream stream = opened(file);
  std::string text;
  std::array<char, 1 << 16> block;
  for (std::size_t n = 0; (n = std::fread(block.data(), 1, block.size(), stream.get())) > 0;) {
    text.append(block.data(), n);
  }
  if (std::ferror(stream.get()) != 0)
    file_error(file, std::string("cannot be read (") + std::strerror(errno) + ")");
  return text;
}

// Large files are read in parts side by side: most of the time goes to new pages of memory.
FileBytes read_bytes(const std::filesystem::path& file) {
  constexpr std::size_t kLarge = std::size_t{1} << 20;
  std::error_code error;
  const std::uintmax_t size =
      std::filesystem::is_regular_file(file, error) ? std::filesystem::file_size(file, error) : 0;
  if (error || size < kLarge) return FileBytes(read_whole(file));
  const Stream stream = opened(file);
  std::unique_ptr<char[]> block(new char[size]);  // not set to 0, as make_unique would
  std::atomic<bool> whole = true;
  for_blocks(size, kLarge, [&](std::size_t from, std::size_t to) {
    while (from < to) {
      const ::ssize_t n =
          ::pread(::fileno(stream.get()), block.get() + from, to - from, static_cast<::off_t>(from));
      if (n > 0) {
        from += static_cast<std::size_t>(n);
      } else if (n == 0 || errno != EINTR) {
        whole = false;
        return;
      }
    }
  });
  // A file that changed its size or fails is read from its beginning, which tells what is wrong.
  if (!whole || std::filesystem::file_size(file, error) != size) return FileBytes(read_whole(file));
  return {std::move(block), size};
}

// The checksum of bytes that come one after another.
class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
    check(context_ && EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1);
  }
  void add(std::string_view bytes) {
    check(EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()) == 1);
  }
  // In lower-case hex; nothing can be added afterwards.
  [[nodiscard]] std::string end() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned int length = 0;
    check(EVP_DigestFinal_ex(context_.get(), digest.data(), &length) == 1);
    std::string hex;
    for (unsigned int i = 0; i < length; ++i) {
      constexpr const char* kDigits = "0123456789abcdef";
      hex += kDigits[digest[i] >> 4];
      hex += kDigits[digest[i] & 15];
    }
    return hex;
  }

 private:
  static void check(bool worked) {
    if (!worked) throw std::runtime_error("SHA-256 is not available from OpenSSL: check its configuration");
  }
  std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> context_;
};

void to_design_frame(std::vector<Eigen::Vector3d>& positions, double scale, char up) {
  for_blocks(positions.size(), kBlock, [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      Eigen::Vector3d& p = positions[i];
      p *= scale;
      if (up == 'y') p = Eigen::Vector3d(p.x(), -p.z(), p.y());
    }
  });
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

// The edges of the box around all faces' corners; zero without any.
Eigen::Vector3d extent_of(const Polygons& polygons) {
  Eigen::AlignedBox3d box;
  for (const int v : polygons.corners) box.extend(polygons.positions[static_cast<std::size_t>(v)]);
  return box.isEmpty() ? Eigen::Vector3d(0, 0, 0) : Eigen::Vector3d(box.sizes());
}

// Coordinates are too large by a wrong unit, or of a design that is as large as buildings are and lies far
// from the origin, as a survey's do.
Polygons parse_within_limit(std::string_view bytes, FileFormat format, const std::filesystem::path& file,
                            double scale_to_mm) {
  constexpr double kLargestPartMm = 1e6;
  try {
    return parse(bytes, format, file, kLargestCoordinateMm / scale_to_mm);
  } catch (const MeshError& error) {
    Eigen::Vector3d extent = Eigen::Vector3d::Zero();
    try {
      extent = scale_to_mm * extent_of(parse(bytes, format, file, std::numeric_limits<double>::max()));
    } catch (const MeshError&) {
      extent.setZero();  // something else is wrong with the file
    }
    if (!(extent.maxCoeff() > 0) || extent.maxCoeff() > kLargestPartMm) throw;
    std::array<char, 128> itself{};
    std::snprintf(itself.data(), itself.size(),
                  ", or move the design, itself %.0f x %.0f x %.0f mm, to the origin", extent.x(), extent.y(),
                  extent.z());
    throw MeshError(error.what() + std::string(itself.data()));
  }
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

namespace {

DesignSurface design_of(FileBytes bytes, const std::filesystem::path& file, const ReadOptions& options) {
  if (options.up != 'z' && options.up != 'y') {
    throw std::logic_error(std::string("unknown up axis ('") + options.up + "'): give z or y");
  }
  if (!(options.stitch_mm >= 0) || (options.facing && !(options.facing->norm() > 0))) {
    throw std::logic_error("read_surface: stitch_mm has to be 0 or more and facing has to have a length");
  }
  DesignSurface design;
  design.file_name = file.filename().string();
  const std::string_view text = bytes.view();
  design.format = options.format ? *options.format : format_of(text, text.size(), file);
  take_units(design, file, options);
  Polygons polygons;
  Sha256 checksum;
  side_by_side([&] { checksum.add(text); },
               [&] { polygons = parse_within_limit(text, design.format, file, design.scale_to_mm); });
  checksum.add(polygons.beside);
  design.sha256 = checksum.end();
  bytes = {};
  std::string().swap(polygons.beside);
  design.place = polygons.place;
  warn_of_spacing(polygons, design.scale_to_mm, options.resolution_mm);
  design.health.file_vertices = polygons.positions.size() + polygons.joined;
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

}  // namespace

DesignSurface surface_of(std::string bytes, const std::filesystem::path& file, const ReadOptions& options) {
  return design_of(FileBytes(std::move(bytes)), file, options);
}

DesignSurface read_surface(const std::filesystem::path& file, const ReadOptions& options) {
  return design_of(read_bytes(file), file, options);
}

DesignSurface read_obj(const std::filesystem::path& file, const ReadOptions& options) {
  ReadOptions as_obj = options;
  as_obj.format = FileFormat::kObj;
  return read_surface(file, as_obj);
}

}  // namespace hotblade::surface

// Broken designs of every format: each reader must either accept or throw the error it promises; anything
// else, and any report of the sanitizers it is built with, ends the run. usage: hotblade_fuzz_designs [ROUNDS
// [SEED]]. A round breaks a design of each format and reads it, an OBJ in parts too; what was taken of every
// hundredth goes on through repair and slicing. The seed makes a run repeatable.
#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "surface/read/design_surface.hpp"
#include "surface/read/gltf.hpp"
#include "surface/read/obj_text.hpp"
#include "surface/read/ply.hpp"
#include "surface/read/polygons.hpp"
#include "surface/read/stl.hpp"
#include "surface/slice/slice.hpp"
#include "tests/fuzz/broken_text.hpp"

namespace {

using namespace hotblade;
namespace fs = std::filesystem;

// Tokens that have broken readers before.
constexpr const char* kTokens[] = {"nan",
                                   "inf",
                                   "-1",
                                   "0",
                                   "1e999",
                                   "4294967296",
                                   "-2147483649",
                                   "\\\n",
                                   "\x01",
                                   "\r\n",
                                   "f ",
                                   "v ",
                                   "/",
                                   "//",
                                   "{",
                                   "]",
                                   "\"",
                                   "null",
                                   "1e-320",
                                   "= ",
                                   "[[x]]",
                                   "\xff\xfe",
                                   "9999999999",
                                   ",",
                                   "16777216",
                                   "property list ",
                                   "\x7f\xc0\xff\xff"};

std::string broken(std::string text, std::mt19937_64& random) {
  return testing::broken(std::move(text), kTokens, random);
}

// A small design: the first rows of a sample would not mesh, so a grid of its own.
std::string small_obj() {
  std::string text = "# grid\no grid\n";
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      text +=
          "v " + std::to_string(40 * i) + " " + std::to_string(40 * j) + " " + std::to_string(i * j) + ".5\n";
    }
  }
  for (int i = 0; i < 5; ++i) {
    for (int j = 1; j < 6; ++j) {
      const int a = 6 * i + j;
      text += "f " + std::to_string(a) + " " + std::to_string(a + 6) + " " + std::to_string(a + 7) + " " +
              std::to_string(a + 1) + "\n";
    }
  }
  return text;
}

// The same grid in other formats, made of what the OBJ's reader takes from it.
struct Triangles {
  std::vector<Eigen::Vector3f> corners;  // three of each
};

Triangles small_triangles() {
  const surface::Polygons grid = surface::parse_obj(small_obj(), "grid", 1e7);
  Triangles made;
  for (std::size_t f = 0; f < grid.faces(); ++f) {
    for (const int k : {0, 1, 2, 0, 2, 3}) {
      const auto corner = static_cast<std::size_t>(grid.face(f)[static_cast<std::size_t>(k)]);
      made.corners.push_back(grid.positions[corner].cast<float>());
    }
  }
  return made;
}

template <class Number>
std::string raw(Number value, std::endian order) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  if (order != std::endian::native) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

std::string raw(const Eigen::Vector3f& v, std::endian order) {
  return raw(v.x(), order) + raw(v.y(), order) + raw(v.z(), order);
}

std::string small_binary_stl(const Triangles& mesh) {
  std::string bytes =
      std::string(80, ' ') + raw(static_cast<std::uint32_t>(mesh.corners.size() / 3), std::endian::little);
  for (std::size_t i = 0; i < mesh.corners.size(); i += 3) {
    bytes += raw(Eigen::Vector3f(0, 0, 1), std::endian::little);
    for (std::size_t k = 0; k < 3; ++k) bytes += raw(mesh.corners[i + k], std::endian::little);
    bytes += std::string(2, '\0');
  }
  return bytes;
}

std::string vector_text(const Eigen::Vector3f& v) {
  return std::to_string(v.x()) + " " + std::to_string(v.y()) + " " + std::to_string(v.z());
}

std::string small_text_stl(const Triangles& mesh) {
  std::string text = "solid grid\n";
  for (std::size_t i = 0; i < mesh.corners.size(); i += 3) {
    text += "facet normal 0 0 1\nouter loop\n";
    for (std::size_t k = 0; k < 3; ++k) text += "vertex " + vector_text(mesh.corners[i + k]) + "\n";
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid grid\n";
}

std::string ply_header(const Triangles& mesh, const std::string& format) {
  return "ply\nformat " + format + " 1.0\nelement vertex " + std::to_string(mesh.corners.size()) +
         "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nelement face " +
         std::to_string(mesh.corners.size() / 3) + "\nproperty list uchar int vertex_indices\nend_header\n";
}

std::string small_text_ply(const Triangles& mesh) {
  std::string text = ply_header(mesh, "ascii");
  for (const Eigen::Vector3f& corner : mesh.corners) text += vector_text(corner) + " 7\n";
  for (std::size_t i = 0; i < mesh.corners.size(); i += 3)
    text += "3 " + std::to_string(i) + " " + std::to_string(i + 1) + " " + std::to_string(i + 2) + "\n";
  return text;
}

std::string small_binary_ply(const Triangles& mesh, std::endian order) {
  std::string bytes =
      ply_header(mesh, order == std::endian::big ? "binary_big_endian" : "binary_little_endian");
  for (const Eigen::Vector3f& corner : mesh.corners) bytes += raw(corner, order) + "r";
  for (std::size_t i = 0; i < mesh.corners.size(); ++i)
    bytes += (i % 3 == 0 ? "\x03" : "") + raw(static_cast<std::int32_t>(i), order);
  return bytes;
}

std::string small_glb(const Triangles& mesh) {
  std::string data;
  for (const Eigen::Vector3f& corner : mesh.corners) data += raw(corner, std::endian::little);
  const std::string count = std::to_string(mesh.corners.size()), size = std::to_string(data.size());
  std::string json =
      R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"children":[1],"scale":[0.001,0.001,0.001]},)"
      R"({"mesh":0,"name":"grid","rotation":[0,0,0,1],"translation":[1,2,3]}],"meshes":[{"primitives":[)"
      R"({"attributes":{"POSITION":0},"mode":4}]}],"accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":)" +
      count + R"(}],"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":)" + size +
      R"(}],"buffers":[{"byteLength":)" + size + "}]}";
  while (json.size() % 4 != 0) json += ' ';
  const auto chunk = [](const std::string& type, const std::string& bytes) {
    return raw(static_cast<std::uint32_t>(bytes.size()), std::endian::little) + type + bytes;
  };
  const std::string chunks = chunk("JSON", json) + chunk(std::string("BIN\0", 4), data);
  return "glTF" + raw(std::uint32_t{2}, std::endian::little) +
         raw(static_cast<std::uint32_t>(12 + chunks.size()), std::endian::little) + chunks;
}

std::string small_gltf() {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"matrix":)"
         R"([0,1,0,0,-1,0,0,0,0,0,1,0,5,0,0,1]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],)"
         R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},)"
         R"({"bufferView":1,"componentType":5121,"count":3,"type":"SCALAR"}],"bufferViews":[)"
         R"({"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":3}],"buffers":[{"byteLength":39,)"
         R"("uri":"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAEC"}]})";
}

// Designs as files have them, each with the format that it is read as.
struct DesignFile {
  surface::FileFormat format;
  std::string bytes;
};

std::vector<DesignFile> small_designs() {
  const Triangles mesh = small_triangles();
  using enum surface::FileFormat;
  return {{kObj, small_obj()},
          {kStl, small_binary_stl(mesh)},
          {kStl, small_text_stl(mesh)},
          {kPly, small_text_ply(mesh)},
          {kPly, small_binary_ply(mesh, std::endian::little)},
          {kPly, small_binary_ply(mesh, std::endian::big)},
          {kGltf, small_glb(mesh)},
          {kGltf, small_gltf()}};
}

constexpr double kLimit = 1e7;

surface::Polygons parsed(const DesignFile& design) {
  switch (design.format) {
    case surface::FileFormat::kObj:
      return surface::parse_obj(design.bytes, "fuzz.obj", kLimit);
    case surface::FileFormat::kStl:
      return surface::parse_stl(design.bytes, "fuzz.stl", kLimit);
    case surface::FileFormat::kPly:
      return surface::parse_ply(design.bytes, "fuzz.ply", kLimit);
    case surface::FileFormat::kGltf:
      break;
  }
  const auto no_file = [](const fs::path& file) -> std::string {
    throw surface::FileError(file.string() + ": no file beside is given");
  };
  return surface::parse_gltf(design.bytes, "fuzz.glb", kLimit, no_file);
}

// What was taken has to be whole.
void expect_whole(const surface::Polygons& polygons) {
  const auto points = static_cast<int>(polygons.positions.size());
  bool whole = polygons.faces() > 0 && polygons.first_corner.size() == polygons.faces() + 1 &&
               polygons.first_corner.back() == polygons.corners.size() &&
               polygons.face_group.size() == polygons.faces();
  for (const int corner : polygons.corners) whole = whole && corner >= 0 && corner < points;
  for (const Eigen::Vector3d& p : polygons.positions) whole = whole && p.cwiseAbs().maxCoeff() <= 1e7;
  for (const std::uint32_t group : polygons.face_group) whole = whole && group < polygons.groups.size();
  for (std::size_t f = 0; f < polygons.faces() && whole; ++f) whole = polygons.face(f).size() >= 3;
  if (!whole) throw std::logic_error("a reader took a design that is not whole");
}

// OBJ text says the same, errors too, whatever the size of the parts that it is read in.
void expect_the_same_in_parts(const std::string& text, std::size_t part_bytes) {
  const auto read = [&](std::size_t bytes) -> std::pair<surface::Polygons, std::string> {
    try {
      return {surface::parse_obj(text, "fuzz.obj", kLimit, bytes), ""};
    } catch (const surface::MeshError& error) {
      return {{}, error.what()};
    }
  };
  const auto [whole, error] = read(text.size() + 1);
  const auto [parts, other] = read(part_bytes);
  const bool same = error == other && whole.positions == parts.positions && whole.corners == parts.corners &&
                    whole.first_corner == parts.first_corner && whole.face_place == parts.face_place &&
                    whole.face_group == parts.face_group && whole.groups.size() == parts.groups.size() &&
                    whole.warnings == parts.warnings;
  if (!same) {
    throw std::logic_error("an OBJ is another one read in parts of " + std::to_string(part_bytes) +
                           " bytes: '" + error + "', '" + other + "'");
  }
}

bool read_in_memory(const DesignFile& design) {
  try {
    (void)surface::format_of(design.bytes.substr(0, surface::kFormatHead), design.bytes.size(), "fuzz");
    expect_whole(parsed(design));
    return true;
  } catch (const surface::MeshError&) {
  } catch (const surface::FileError&) {
  }
  return false;
}

void read_and_slice(const DesignFile& design, const fs::path& file) {
  std::ofstream(file, std::ios::binary) << design.bytes;
  surface::ReadOptions options{design.format == surface::FileFormat::kGltf ? "m" : "mm", 'z'};
  options.format = design.format;
  try {
    const surface::DesignSurface read = surface::read_surface(file, options);
    if (!read.health.blockers.empty() || read.mesh.triangles().empty()) return;
    const std::vector<double> offsets{-10, 0, 0.5, 10};
    (void)surface::slice(read.mesh, surface::parallel_about(read.mesh, Eigen::Vector3d::UnitX()), offsets);
  } catch (const surface::MeshError&) {
  } catch (const surface::FileError&) {
  }
}

}  // namespace

int main(int argc, char** argv) {
  const long rounds = argc > 1 ? std::atol(argv[1]) : 20000;
  const unsigned long seed = argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 1;
  constexpr long kWholeWay = 100;
  constexpr std::size_t kLargestPart = 400;  // bytes of about a thousand
  std::mt19937_64 random(seed);
  const fs::path file = fs::temp_directory_path() / ("hotblade_fuzz_designs_" + std::to_string(seed));
  const std::vector<DesignFile> designs = small_designs();
  for (const DesignFile& design : designs) expect_whole(parsed(design));
  long taken = 0;
  for (long i = 0; i < rounds; ++i) {
    for (const DesignFile& design : designs) {
      const DesignFile changed{design.format, broken(design.bytes, random)};
      try {
        taken += read_in_memory(changed) ? 1 : 0;
        if (changed.format == surface::FileFormat::kObj)
          expect_the_same_in_parts(changed.bytes, 1 + random() % kLargestPart);
        if (i % kWholeWay == 0) read_and_slice(changed, file);
      } catch (const std::exception& error) {
        std::ofstream(file, std::ios::binary) << changed.bytes;
        std::printf("round %ld of seed %lu: %s\ninput left in %s\n", i, seed, error.what(), file.c_str());
        return 1;
      }
    }
  }
  fs::remove(file);
  std::printf("%ld rounds of seed %lu, %zu designs each: %ld taken, all others refused as promised\n", rounds,
              seed, designs.size(), taken);
  return 0;
}

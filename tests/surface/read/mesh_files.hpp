// Files of other formats than OBJ, written byte by byte.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>

#include "tests/surface/meshes.hpp"

namespace hotblade::surface {

template <class Number>
std::string number_bytes(Number value, std::endian order = std::endian::little) {
  std::string raw(sizeof value, '\0');
  std::memcpy(raw.data(), &value, sizeof value);
  if (order != std::endian::native) std::reverse(raw.begin(), raw.end());
  return raw;
}

// A facet of a binary STL; its normal as the corners go round, times `turn`.
inline std::string stl_facet(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c,
                             std::uint16_t attribute = 0, float turn = 1) {
  const Eigen::Vector3f normal = turn * (b - a).cross(c - a).normalized();
  std::string bytes;
  for (const Eigen::Vector3f& v : {normal, a, b, c}) {
    for (const float value : v) bytes += number_bytes(value);
  }
  return bytes + number_bytes(attribute);
}

inline std::string binary_stl(const std::string& facets, std::uint32_t count,
                              const std::string& header = "solid of some program") {
  std::string bytes = header;
  bytes.resize(80, ' ');
  return bytes + number_bytes(count) + facets;
}

inline std::string to_binary_stl(const TriangleSoup& mesh) {
  std::string facets;
  const auto at = [&](int v) {
    return Eigen::Vector3f(mesh.vertices[static_cast<std::size_t>(v)].cast<float>());
  };
  for (const auto& t : mesh.triangles) facets += stl_facet(at(t[0]), at(t[1]), at(t[2]));
  return binary_stl(facets, static_cast<std::uint32_t>(mesh.triangles.size()));
}

inline std::string to_text_stl(const TriangleSoup& mesh, const std::string& name = "panel") {
  std::string text = "solid " + name + "\n";
  char line[120];
  for (const auto& t : mesh.triangles) {
    text += " facet normal 0 0 0\n  outer loop\n";
    for (const int v : t) {
      const Eigen::Vector3d& p = mesh.vertices[static_cast<std::size_t>(v)];
      std::snprintf(line, sizeof line, "   vertex %.17g %.17g %.17g\n", p.x(), p.y(), p.z());
      text += line;
    }
    text += "  endloop\n endfacet\n";
  }
  return text + "endsolid " + name + "\n";
}

inline const char* const kPlyHeader =
    "element vertex 4\nproperty double x\nproperty double y\nproperty double z\nproperty uchar red\n"
    "element face 2\nproperty uchar flag\nproperty list uchar int vertex_indices\n"
    "element edge 1\nproperty int vertex1\nproperty list int float knots\nend_header\n";

inline std::string text_ply(const std::string& body, const std::string& header = kPlyHeader) {
  return "ply\nformat ascii 1.0\ncomment of a test\n" + header + body;
}

inline const char* const kPlySquare = "0 0 0 255\n100 0 0 255\n100 100 0 255\n0 100 0 7\n";

// A square of a triangle and a face of four corners, beside properties and elements that are passed over.
inline std::string binary_ply(std::endian order, const std::string& more = "") {
  const bool big = order == std::endian::big;
  std::string bytes =
      std::string("ply\nformat binary_") + (big ? "big" : "little") + "_endian 1.0\n" + kPlyHeader;
  const double corners[4][3] = {{0, 0, 0}, {100, 0, 0}, {100, 100, 0}, {0, 100, 0}};
  for (const auto& corner : corners) {
    for (const double value : corner) bytes += number_bytes(value, order);
    bytes += '\x10';
  }
  const auto face = [&](std::initializer_list<std::int32_t> indices) {
    bytes += '\0';
    bytes += static_cast<char>(indices.size());
    for (const std::int32_t index : indices) bytes += number_bytes(index, order);
  };
  face({0, 1, 2});
  face({0, 2, 3});
  bytes += number_bytes(std::int32_t{3}, order) + number_bytes(std::int32_t{2}, order);
  return bytes + number_bytes(1.0F, order) + number_bytes(2.0F, order) + more;
}

inline DesignSurface read_bytes_as(const std::string& bytes, const std::string& name,
                                   const ReadOptions& options = {"mm", 'z'}) {
  const ScratchFile file(bytes, name);
  return read_surface(file.path(), options);
}

inline std::string refusal_of(const std::string& bytes, const std::string& name,
                              const ReadOptions& options = {"mm", 'z'}) {
  const ScratchFile file(bytes, name);
  return message_of<MeshError>([&] { static_cast<void>(read_surface(file.path(), options)); });
}

}  // namespace hotblade::surface

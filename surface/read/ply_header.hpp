// The header of a PLY: which elements the file has, and how they are written.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hotblade::surface {

enum class PlyEncoding { kText, kLittleEndian, kBigEndian };
enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

[[nodiscard]] std::size_t bytes_of(PlyType type);
[[nodiscard]] constexpr bool is_integer(PlyType type) {
  return type != PlyType::kFloat && type != PlyType::kDouble;
}

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat;  // of a list: of its items
  std::optional<PlyType> count;    // of a list: what its length is written as
};

struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;
  std::size_t line = 0;  // of the header

  // Returns the place of a property in the list of them; absent where there is none of the name.
  [[nodiscard]] std::optional<std::size_t> find(std::string_view property) const;
  // Returns the bytes of one such element in binary where its lists are empty; in text the number of its
  // characters, a blank or line end after each number.
  [[nodiscard]] std::size_t least_bytes(PlyEncoding encoding) const;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kText;
  std::vector<PlyElement> elements;
  std::size_t bytes = 0, lines = 0;  // how far the header goes
};

// Returns the header of a PLY that begins with `ply`. Throws MeshError, with `name` and the line, for the
// first statement that is not usable, and for elements that the file has no room for.
[[nodiscard]] PlyHeader parse_ply_header(std::string_view bytes, const std::string& name);

}  // namespace hotblade::surface

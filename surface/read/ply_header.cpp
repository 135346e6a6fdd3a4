#include "surface/read/ply_header.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <utility>

#include "surface/read/design_surface.hpp"
#include "surface/read/polygons.hpp"
#include "surface/read/words.hpp"

namespace hotblade::surface {
namespace {

constexpr std::array<std::pair<std::string_view, PlyType>, 16> kPlyTypes{{{"char", PlyType::kInt8},
                                                                          {"uchar", PlyType::kUint8},
                                                                          {"short", PlyType::kInt16},
                                                                          {"ushort", PlyType::kUint16},
                                                                          {"int", PlyType::kInt32},
                                                                          {"uint", PlyType::kUint32},
                                                                          {"float", PlyType::kFloat},
                                                                          {"double", PlyType::kDouble},
                                                                          {"int8", PlyType::kInt8},
                                                                          {"uint8", PlyType::kUint8},
                                                                          {"int16", PlyType::kInt16},
                                                                          {"uint16", PlyType::kUint16},
                                                                          {"int32", PlyType::kInt32},
                                                                          {"uint32", PlyType::kUint32},
                                                                          {"float32", PlyType::kFloat},
                                                                          {"float64", PlyType::kDouble}}};

// Far more than any program writes; beyond, the header is damaged.
constexpr std::size_t kMostElements = 100, kMostProperties = 1000;

class PlyHeaderText {
 public:
  PlyHeaderText(std::string_view text, const std::string& name) : text_(text), words_(text), name_(name) {}

  PlyHeader parse() {
    if (words_.next_in_line() != "ply") fail("not a PLY: it begins with another word than ply");
    end_line();
    read_format();
    for (;;) {
      const std::string_view word = words_.next();
      if (word.empty()) fail("the header has no end_header: the file is cut short, export it again");
      if (word == "end_header") break;
      if (word == "comment" || word == "obj_info") {
        (void)words_.rest_of_line();
        continue;
      }
      if (word == "element") {
        read_element();
      } else if (word == "property") {
        read_property();
      } else {
        fail("not a statement of a PLY's header ('" + shown_token(word) +
             "'): element, property, comment or end_header is due");
      }
      end_line();
    }
    end_line();
    header_.bytes = words_.offset();
    header_.lines = words_.line();
    check_room();
    return std::move(header_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { fail_in(words_.line(), what); }
  [[noreturn]] void fail_in(std::size_t line, const std::string& what) const {
    throw MeshError(place_of(name_, "line", line) + what);
  }

  std::string_view due(const char* what) {
    const std::string_view word = words_.next_in_line();
    if (word.empty()) fail(std::string("the line ends where ") + what + " is due: the header is damaged");
    return word;
  }

  void end_line() {
    if (const std::string_view more = words_.rest_of_line(); !more.empty())
      fail("more in the line than belongs there ('" + shown_token(more) + "'): the header is damaged");
  }

  void read_format() {
    std::string_view word = words_.next();
    while (word == "comment" || word == "obj_info") {
      (void)words_.rest_of_line();
      word = words_.next();
    }
    if (word != "format") fail("the format is due ('" + shown_token(word) + "'): the header is damaged");
    const std::string_view encoding = due("ascii, binary_little_endian or binary_big_endian");
    if (encoding == "ascii") {
      header_.encoding = PlyEncoding::kText;
    } else if (encoding == "binary_little_endian") {
      header_.encoding = PlyEncoding::kLittleEndian;
    } else if (encoding == "binary_big_endian") {
      header_.encoding = PlyEncoding::kBigEndian;
    } else {
      fail("unknown format ('" + shown_token(encoding) +
           "'): ascii, binary_little_endian and binary_big_endian are read");
    }
    if (const std::string_view version = due("version 1.0"); version != "1.0")
      fail("unknown version ('" + shown_token(version) + "', 1.0 is read): export it again");
    end_line();
  }

  void read_element() {
    PlyElement element;
    element.name = due("the element's name");
    element.line = words_.line();
    const std::string_view count = due("the number of elements");
    const auto [rest, error] = std::from_chars(count.data(), count.data() + count.size(), element.count);
    if (error != std::errc() || rest != count.data() + count.size())
      fail("not a number of elements ('" + shown_token(count) + "'): a whole number is due");
    for (const PlyElement& other : header_.elements) {
      if (other.name == element.name) fail("element '" + shown_token(element.name) + "' is there twice");
    }
    if (header_.elements.size() == kMostElements)
      fail("too many elements (limit " + std::to_string(kMostElements) + "): the header is damaged");
    header_.elements.push_back(std::move(element));
  }

  void read_property() {
    if (header_.elements.empty()) fail("a property before any element: the header is damaged");
    PlyElement& element = header_.elements.back();
    PlyProperty property;
    std::string_view word = due("the property's type");
    if (word == "list") {
      property.count = type(due("the type of the list's length"));
      if (!is_integer(*property.count))
        fail("the length of a list is no whole number: the header is damaged");
      word = due("the type of the list's items");
    }
    property.type = type(word);
    property.name = due("the property's name");
    if (element.find(property.name))
      fail("property '" + shown_token(property.name) + "' is there twice: the header is damaged");
    if (element.properties.size() == kMostProperties)
      fail("too many properties (limit " + std::to_string(kMostProperties) + "): the header is damaged");
    element.properties.push_back(std::move(property));
  }

  PlyType type(std::string_view word) const {
    for (const auto& [known, value] : kPlyTypes) {
      if (known == word) return value;
    }
    fail("unknown type ('" + shown_token(word) + "'): char to double and int8 to float64 are read");
  }

  // Before anything is allocated for them.
  void check_room() const {
    const std::size_t room = text_.size() - header_.bytes;
    for (const PlyElement& element : header_.elements) {
      const std::size_t least = element.least_bytes(header_.encoding);
      // The last line of a text needs no line end.
      const std::size_t given = room + (header_.encoding == PlyEncoding::kText ? 1 : 0);
      if (element.count <= given / std::max<std::size_t>(least, 1)) continue;
      fail_in(element.line, "more elements than the file has room for (" + std::to_string(element.count) +
                                " of '" + shown_token(element.name) + "', " + std::to_string(room) +
                                " bytes after the header): it is cut short, export it again");
    }
  }

  std::string_view text_;
  Words words_;
  const std::string& name_;
  PlyHeader header_;
};

}  // namespace

std::size_t bytes_of(PlyType type) {
  switch (type) {
    case PlyType::kInt8:
    case PlyType::kUint8:
      return 1;
    case PlyType::kInt16:
    case PlyType::kUint16:
      return 2;
    case PlyType::kInt32:
    case PlyType::kUint32:
    case PlyType::kFloat:
      return 4;
    case PlyType::kDouble:
      break;
  }
  return 8;
}

std::optional<std::size_t> PlyElement::find(std::string_view property) const {
  for (std::size_t i = 0; i < properties.size(); ++i) {
    if (properties[i].name == property) return i;
  }
  return std::nullopt;
}

std::size_t PlyElement::least_bytes(PlyEncoding encoding) const {
  std::size_t sum = 0;
  for (const PlyProperty& property : properties) {
    sum += encoding == PlyEncoding::kText ? 2 : bytes_of(property.count ? *property.count : property.type);
  }
  return sum;
}

PlyHeader parse_ply_header(std::string_view bytes, const std::string& name) {
  return PlyHeaderText(bytes, name).parse();
}

}  // namespace hotblade::surface

#include "surface/read/ply.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "surface/read/bytes.hpp"
#include "surface/read/design_surface.hpp"
#include "surface/read/ply_header.hpp"
#include "surface/read/warning.hpp"
#include "surface/read/words.hpp"

namespace hotblade::surface {
namespace {

constexpr std::size_t kMostIndices = std::numeric_limits<int>::max();

// Reads values of a text, an element a line.
class PlyTextValues {
 public:
  PlyTextValues(std::string_view bytes, const PlyHeader& header, const std::string& name)
      : words_(bytes.substr(header.bytes), header.lines), name_(name) {}

  void begin(const PlyElement& element, std::size_t number) {
    element_ = &element;
    number_ = number;
    fresh_ = true;
  }
  void end() {
    if (const std::string_view more = words_.rest_of_line(); !more.empty())
      fail("more values than the header says ('" + shown_token(more) + "'): the file is damaged");
  }

  double real(PlyType) {
    const std::string_view word = next();
    const std::optional<double> value = number_in(word);
    if (value) return *value;
    if (word.find('#') != std::string_view::npos) return std::numeric_limits<double>::quiet_NaN();
    reject(word, "a number");
  }
  long long integer(PlyType) {
    const std::string_view word = next();
    long long value = 0;
    const auto [rest, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || rest != word.data() + word.size()) reject(word, "a whole number");
    return value;
  }
  // Returns how many values of a type there can still be.
  [[nodiscard]] std::size_t room(PlyType) const { return kMostIndices; }
  void pass(PlyType type, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) (void)real(type);
  }

  // The last value as it is written.
  [[nodiscard]] std::string shown() const { return std::string(word_); }
  [[nodiscard]] static std::string_view place() { return "line"; }
  [[nodiscard]] std::size_t place_number() const { return words_.line(); }
  [[noreturn]] void fail(const std::string& what) const { fail_at_place(words_.line(), what); }
  [[noreturn]] void fail_at_place(std::size_t line, const std::string& what) const {
    throw MeshError(place_of(name_, "line", line) + what);
  }
  void check_end() {
    if (const std::string_view more = words_.next(); !more.empty())
      fail("more lines than the header's elements ('" + shown_token(more) + "'): its counts are wrong");
  }

 private:
  std::string_view next() {
    word_ = fresh_ ? words_.next() : words_.next_in_line();
    if (word_.empty()) {
      fail((fresh_ ? std::string("the text ends before ") : std::string("the line ends within ")) +
           shown_token(element_->name) + " " + std::to_string(number_) + " of " +
           std::to_string(element_->count) + ": the file is cut short, or its header wrong");
    }
    fresh_ = false;
    return word_;
  }

  [[noreturn]] void reject(std::string_view word, const char* due) const {
    const bool comma = word.find(',') != std::string_view::npos;
    fail(std::string("not ") + due + " ('" + shown_token(word) + "'): " +
         (comma ? "export with a decimal point, not a comma" : "the file is damaged, or its header wrong"));
  }

  Words words_;
  const std::string& name_;
  const PlyElement* element_ = nullptr;
  std::size_t number_ = 0;
  bool fresh_ = false;
  std::string_view word_;
};

// Reads values of a binary file.
class PlyBinaryValues {
 public:
  PlyBinaryValues(std::string_view bytes, const PlyHeader& header, const std::string& name)
      : bytes_(bytes),
        at_(header.bytes),
        order_(header.encoding == PlyEncoding::kBigEndian ? std::endian::big : std::endian::little),
        name_(name) {}

  void begin(const PlyElement& element, std::size_t number) {
    element_ = &element;
    number_ = number;
    begin_ = at_;
  }
  void end() {}

  double real(PlyType type) {
    last_ = type == PlyType::kFloat    ? static_cast<double>(take<float>())
            : type == PlyType::kDouble ? take<double>()
                                       : static_cast<double>(integer(type));
    return last_;
  }
  long long integer(PlyType type) {
    switch (type) {
      case PlyType::kInt8:
        return take<std::int8_t>();
      case PlyType::kUint8:
        return take<std::uint8_t>();
      case PlyType::kInt16:
        return take<std::int16_t>();
      case PlyType::kUint16:
        return take<std::uint16_t>();
      case PlyType::kInt32:
        return take<std::int32_t>();
      case PlyType::kUint32:
        return take<std::uint32_t>();
      case PlyType::kFloat:
      case PlyType::kDouble:
        break;
    }
    throw std::logic_error("a PLY's integer is of an integer type");
  }
  [[nodiscard]] std::size_t room(PlyType type) const { return (bytes_.size() - at_) / bytes_of(type); }
  void pass(PlyType type, std::size_t count) {
    if (count > room(type)) cut_short();
    at_ += count * bytes_of(type);
  }

  [[nodiscard]] std::string shown() const {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.17g", last_);
    return text.data();
  }
  [[nodiscard]] static std::string_view place() { return "face"; }
  [[nodiscard]] std::size_t place_number() const { return number_; }
  [[noreturn]] void fail(const std::string& what) const {
    throw MeshError(name_ + ": " + shown_token(element_->name) + " " + std::to_string(number_) + " (byte " +
                    std::to_string(begin_) + "): " + what);
  }
  [[noreturn]] void fail_at_place(std::size_t number, const std::string& what) const {
    throw MeshError(place_of(name_, place(), number) + what);
  }
  void check_end() const {
    // Some programs end a binary file with a line end.
    const std::string_view rest = bytes_.substr(at_);
    if (rest.size() <= 2 && rest.find_first_not_of("\r\n") == std::string_view::npos) return;
    throw MeshError(name_ + ": byte " + std::to_string(at_) + ": more bytes than the header's elements (" +
                    std::to_string(rest.size()) + " left): its counts or properties are wrong");
  }

 private:
  template <class Number>
  Number take() {
    if (bytes_.size() - at_ < sizeof(Number)) cut_short();
    const auto value = number_at<Number>(bytes_, at_, order_);
    at_ += sizeof(Number);
    return value;
  }
  [[noreturn]] void cut_short() const {
    fail("the file ends within it (" + std::to_string(bytes_.size()) + " bytes, element " +
         std::to_string(number_) + " of " + std::to_string(element_->count) +
         "): it is cut short, or its header wrong");
  }

  std::string_view bytes_;
  std::size_t at_, begin_ = 0;
  std::endian order_;
  const std::string& name_;
  const PlyElement* element_ = nullptr;
  std::size_t number_ = 0;
  double last_ = 0;
};

// Reads the elements of a file through what gives its values.
template <class Values>
class PlyBody {
 public:
  PlyBody(const PlyHeader& header, Values values, const std::string& name, double limit, bool points_alone)
      : header_(header), values_(std::move(values)), name_(name), limit_(limit), points_alone_(points_alone) {
    polygons_.place = Values::place();
  }

  Polygons read() {
    check_elements();
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex") {
        read_vertices(element);
      } else if (element.name == "face" && !points_alone_) {
        read_faces(element);
      } else {
        pass_over(element);
      }
    }
    values_.check_end();
    return std::move(polygons_);
  }

 private:
  [[noreturn]] void fail_in(std::size_t line, const std::string& what) const {
    throw MeshError(place_of(name_, "line", line) + what);
  }

  void check_elements() {
    const PlyElement* vertex = find("vertex");
    const PlyElement* face = find("face");
    if (vertex == nullptr || vertex->count == 0)
      fail_in(vertex != nullptr ? vertex->line : header_.lines,
              "no vertices in the file: export the design as a polygon mesh");
    vertices_ = static_cast<long long>(vertex->count);
    if (vertex->count > kMostIndices)
      fail_in(vertex->line,
              "too many vertices (limit " + std::to_string(kMostIndices) + "): thin the mesh out");
    for (std::size_t axis = 0; axis < 3; ++axis) axes_[axis] = axis_of(*vertex, axis);
    if (points_alone_) return;
    if (face == nullptr && find("tristrips") != nullptr)
      fail_in(find("tristrips")->line, "triangle strips are not read: export single triangles");
    if (face == nullptr || face->count == 0) {
      fail_in(face != nullptr ? face->line : header_.lines,
              "no faces in the file (" + std::to_string(vertex->count) +
                  " vertices): export a mesh, not a cloud of points");
    }
    if (face->count > kMostIndices / 3)
      fail_in(face->line,
              "too many faces (limit " + std::to_string(kMostIndices / 3) + "): thin the mesh out");
    find_list(*face);
  }

  const PlyElement* find(std::string_view element) const {
    for (const PlyElement& one : header_.elements) {
      if (one.name == element) return &one;
    }
    return nullptr;
  }

  std::size_t axis_of(const PlyElement& vertex, std::size_t axis) {
    const std::string word(1, "xyz"[axis]);
    const std::optional<std::size_t> at = vertex.find(word);
    if (!at) fail_in(vertex.line, "vertices without " + word + ": export the design again");
    const PlyProperty& property = vertex.properties[*at];
    if (property.count || is_integer(property.type))
      fail_in(vertex.line, word + " of vertices is neither float nor double: export the design again");
    single_ = single_ || property.type == PlyType::kFloat;
    return *at;
  }

  void find_list(const PlyElement& face) {
    std::optional<std::size_t> at = face.find("vertex_indices");
    if (!at) at = face.find("vertex_index");
    if (!at) fail_in(face.line, "faces without vertex_indices: export the design again");
    const PlyProperty& property = face.properties[*at];
    if (!property.count || !is_integer(property.type))
      fail_in(face.line, property.name + " of faces is no list of whole numbers: export the design again");
    list_ = *at;
  }

  void read_vertices(const PlyElement& element) {
    polygons_.positions.reserve(element.count);
    for (std::size_t v = 0; v < element.count; ++v) {
      values_.begin(element, v + 1);
      Eigen::Vector3d position;
      for (std::size_t i = 0; i < element.properties.size(); ++i) {
        const auto axis = std::find(axes_.begin(), axes_.end(), i);
        if (axis == axes_.end()) {
          pass_property(element.properties[i]);
          continue;
        }
        const double value = values_.real(element.properties[i].type);
        // The shortest test first: it is asked of every number.
        if (!(std::abs(value) <= limit_)) values_.fail(refusal_of_coordinate(value, values_.shown(), limit_));
        position[axis - axes_.begin()] = value;
      }
      values_.end();
      polygons_.positions.push_back(position);
    }
    if (single_ && header_.encoding != PlyEncoding::kText)
      polygons_.spacing = single_precision_spacing(polygons_.positions);
  }

  void read_faces(const PlyElement& element) {
    polygons_.first_corner.reserve(element.count + 1);
    polygons_.face_place.reserve(element.count);
    for (std::size_t f = 0; f < element.count; ++f) {
      values_.begin(element, f + 1);
      for (std::size_t i = 0; i < element.properties.size(); ++i) {
        if (i == list_) {
          read_corners(element.properties[i]);
        } else {
          pass_property(element.properties[i]);
        }
      }
      if (values_.place_number() > std::numeric_limits<std::uint32_t>::max())
        values_.fail("too many lines (limit 4294967295): save it as a binary PLY");
      polygons_.first_corner.push_back(static_cast<std::uint32_t>(polygons_.corners.size()));
      polygons_.face_place.push_back(static_cast<std::uint32_t>(values_.place_number()));
      polygons_.face_group.push_back(0);
      values_.end();
    }
  }

  // Returns how many items a list says it has.
  std::size_t length_of(const PlyProperty& list) {
    const long long length = values_.integer(*list.count);
    if (length < 0 || static_cast<std::size_t>(length) > values_.room(list.type)) {
      values_.fail("a list of a length that cannot be (" + std::to_string(length) +
                   "): the file is cut short or damaged");
    }
    return static_cast<std::size_t>(length);
  }

  void read_corners(const PlyProperty& list) {
    const std::size_t corners = length_of(list);
    if (corners < 3)
      values_.fail("face with too few corners (" + std::to_string(corners) +
                   ", at least 3): remove it or export again");
    if (polygons_.corners.size() + corners > kMostIndices)
      values_.fail("too many face corners (limit " + std::to_string(kMostIndices) + "): thin the mesh out");
    for (std::size_t i = 0; i < corners; ++i) {
      const long long index = values_.integer(list.type);
      if (index < 0 || index >= vertices_) {
        values_.fail("vertex index out of range (" + std::to_string(index) + ", the file has " +
                     std::to_string(vertices_) +
                     " vertices, counted from 0): the file is damaged or was joined wrongly");
      }
      polygons_.corners.push_back(static_cast<int>(index));
    }
  }

  void pass_property(const PlyProperty& property) {
    values_.pass(property.type, property.count ? length_of(property) : 1);
  }

  void pass_over(const PlyElement& element) {
    for (std::size_t i = 0; i < element.count; ++i) {
      values_.begin(element, i + 1);
      for (const PlyProperty& property : element.properties) pass_property(property);
      values_.end();
    }
    if (element.count == 0 || element.name != "tristrips") return;
    polygons_.warnings.push_back(text_of(Warning::kTriangleStrips));
  }

  const PlyHeader& header_;
  Values values_;
  const std::string& name_;
  double limit_;
  bool points_alone_;
  std::array<std::size_t, 3> axes_{};
  std::size_t list_ = 0;
  long long vertices_ = 0;
  bool single_ = false;
  Polygons polygons_;
};

Polygons parsed_ply(std::string_view bytes, const std::string& name, double limit, bool points_alone) {
  const PlyHeader header = parse_ply_header(bytes, name);
  if (header.encoding == PlyEncoding::kText)
    return PlyBody(header, PlyTextValues(bytes, header, name), name, limit, points_alone).read();
  return PlyBody(header, PlyBinaryValues(bytes, header, name), name, limit, points_alone).read();
}

}  // namespace

Polygons parse_ply(std::string_view bytes, const std::string& name, double limit) {
  return parsed_ply(bytes, name, limit, false);
}

std::vector<Eigen::Vector3d> parse_ply_points(std::string_view bytes, const std::string& name, double limit) {
  return parsed_ply(bytes, name, limit, true).positions;
}

}  // namespace hotblade::surface

#include "surface/read/gltf.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "surface/read/bytes.hpp"
#include "surface/read/design_surface.hpp"
#include "surface/read/gltf_buffers.hpp"
#include "surface/read/gltf_json.hpp"
#include "surface/read/warning.hpp"
#include "surface/read/words.hpp"

namespace hotblade::surface {
namespace {

// Meshes may be there many times without a byte more, so what they amount to is bounded: ten times the
// largest design that was tried, and 7 GB.
constexpr std::size_t kMostGltfCorners = 300'000'000;

// What a required extension may be about without changing a triangle.
bool says_nothing_of_triangles(const std::string& extension) {
  constexpr std::array<std::string_view, 6> kHarmless{"KHR_materials_", "KHR_texture_", "KHR_lights_",
                                                      "KHR_xmp",        "EXT_texture_", "EXT_lights_"};
  return std::any_of(kHarmless.begin(), kHarmless.end(),
                     [&](std::string_view beginning) { return extension.starts_with(beginning); });
}

struct GltfParts {
  std::string_view json, chunk;
  std::size_t json_at = 0;
};

GltfParts parts_of_glb(std::string_view bytes, const std::string& name) {
  constexpr std::size_t kHeader = 12, kChunkHeader = 8;
  constexpr std::uint32_t kJson = 0x4e4f534a, kBinary = 0x004e4942;
  const auto fail = [&name](std::size_t at, const std::string& what) {
    throw MeshError(name + ": byte " + std::to_string(at) + ": " + what + ": export it again");
  };
  if (bytes.size() < kHeader + kChunkHeader) fail(bytes.size(), "the GLB ends within its header");
  if (const auto version = number_at<std::uint32_t>(bytes, 4); version != 2)
    fail(4, "unknown version of GLB (" + std::to_string(version) + ", 2 is read)");
  if (const auto length = number_at<std::uint32_t>(bytes, 8); length != bytes.size())
    fail(8, "the GLB has another size than it says (" + std::to_string(bytes.size()) + " bytes, " +
                std::to_string(length) + " said)");
  GltfParts parts;
  bool has_json = false;
  for (std::size_t at = kHeader; at < bytes.size();) {
    if (bytes.size() - at < kChunkHeader) fail(at, "the GLB ends within a chunk's header");
    const std::size_t length = number_at<std::uint32_t>(bytes, at);
    const auto type = number_at<std::uint32_t>(bytes, at + 4);
    if (length > bytes.size() - at - kChunkHeader)
      fail(at, "a chunk goes beyond the file (" + std::to_string(length) + " bytes)");
    const std::string_view chunk = bytes.substr(at + kChunkHeader, length);
    if (has_json == (type == kJson)) fail(at, "the first chunk, and no other, has to be the JSON");
    if (type == kJson) {
      parts.json = chunk;
      parts.json_at = at + kChunkHeader;
      has_json = true;
    } else if (type == kBinary && parts.chunk.data() == nullptr) {
      parts.chunk = chunk;
    }
    at += kChunkHeader + length;
  }
  return parts;
}

class GltfScene {
 public:
  GltfScene(const GltfJson& root, GltfBuffers& buffers, double limit)
      : root_(root), buffers_(buffers), limit_(limit) {
    polygons_.place = "triangle";
  }

  Polygons read() {
    check_version();
    check_extensions();
    const std::optional<GltfJson> nodes = root_.find("nodes");
    reached_.resize(nodes ? nodes->size() : 0);
    begin_at_roots();
    while (!waiting_.empty()) {
      const Waiting next = waiting_.back();
      waiting_.pop_back();
      read_node(next);
    }
    if (polygons_.faces() == 0)
      root_.fail("no triangles in the file (" + counted(reached_.size(), "node", "nodes") +
                 "): export the design as a mesh");
    tell_what_was_passed_over();
    polygons_.beside = buffers_.take_beside();
    return std::move(polygons_);
  }

 private:
  struct Waiting {
    GltfJson node;
    Eigen::Affine3d above;
  };

  void check_version() const {
    const GltfJson asset = root_.field("asset");
    const GltfJson version = asset.field("version");
    if (!version.text().starts_with("2."))
      version.fail("unknown version ('" + shown_token(version.text()) + "', 2.0 is read): export it again");
    const std::optional<GltfJson> least = asset.find("minVersion");
    if (least && least->text() != "2.0")
      least->fail("unknown version ('" + shown_token(least->text()) + "', 2.0 is read): export it again");
  }

  void check_extensions() const {
    const std::optional<GltfJson> required = root_.find("extensionsRequired");
    for (std::size_t i = 0; required && i < required->size(); ++i) {
      const std::string extension = required->item(i).text();
      if (says_nothing_of_triangles(extension)) continue;
      required->item(i).fail("extension that is not read ('" + shown_token(extension) +
                             "'): export without compression, quantization and extensions");
    }
  }

  void begin_at_roots() {
    const Eigen::Affine3d here = Eigen::Affine3d::Identity();
    const std::optional<GltfJson> scenes = root_.find("scenes");
    if (!scenes || scenes->size() == 0) root_.fail("has no scene: export the design as a mesh");
    const std::optional<GltfJson> chosen = root_.find("scene");
    const GltfJson scene = chosen ? chosen->named_item("scenes", root_) : scenes->item(0);
    if (const std::optional<GltfJson> nodes = scene.find("nodes")) wait_for(*nodes, here);
  }

  // The first of the list is to be read first.
  void wait_for(const GltfJson& nodes, const Eigen::Affine3d& above) {
    for (std::size_t i = nodes.size(); i > 0; --i) {
      const GltfJson number = nodes.item(i - 1);
      GltfJson node = number.named_item("nodes", root_);
      const std::size_t index = number.count();
      if (reached_[index])
        number.fail("node " + std::to_string(index) + " is reached twice: nodes form no tree");
      reached_[index] = true;
      waiting_.push_back({std::move(node), above});
    }
  }

  void read_node(const Waiting& next) {
    const GltfJson& node = next.node;
    const Eigen::Affine3d here = next.above * own_matrix(node);
    if (!here.matrix().allFinite()) node.fail("its matrices amount to no finite numbers: repair the node");
    if (const std::optional<GltfJson> mesh = node.find("mesh")) read_mesh(node, *mesh, here);
    if (const std::optional<GltfJson> children = node.find("children")) wait_for(*children, here);
  }

  static Eigen::Affine3d own_matrix(const GltfJson& node) {
    Eigen::Affine3d own = Eigen::Affine3d::Identity();
    if (const std::optional<GltfJson> matrix = node.find("matrix")) {
      const auto values = numbers<16>(*matrix);
      own.matrix() = Eigen::Map<const Eigen::Matrix4d>(values.data());  // column by column
      if (own.matrix().row(3) != Eigen::RowVector4d(0, 0, 0, 1))
        matrix->fail("its last row is not 0 0 0 1: repair the node in the CAD program");
      return own;
    }
    if (const std::optional<GltfJson> given = node.find("translation")) {
      const auto v = numbers<3>(*given);
      own.translate(Eigen::Vector3d(v[0], v[1], v[2]));
    }
    if (const std::optional<GltfJson> given = node.find("rotation")) {
      constexpr double kOff = 1e-3;  // of the length 1; files have six digits and more
      const auto v = numbers<4>(*given);
      const Eigen::Quaterniond turn(v[3], v[0], v[1], v[2]);
      if (!(std::abs(turn.norm() - 1) <= kOff)) given->fail("is no rotation: its length is not 1");
      own.rotate(turn.normalized());
    }
    if (const std::optional<GltfJson> given = node.find("scale")) {
      const auto v = numbers<3>(*given);
      own.scale(Eigen::Vector3d(v[0], v[1], v[2]));
    }
    return own;
  }

  template <std::size_t N>
  static std::array<double, N> numbers(const GltfJson& list) {
    if (list.size() != N)
      list.fail("has " + std::to_string(list.size()) + " numbers, " + std::to_string(N) + " are due");
    std::array<double, N> values;
    for (std::size_t i = 0; i < N; ++i) values[i] = list.item(i).number();
    return values;
  }

  void read_mesh(const GltfJson& node, const GltfJson& number, const Eigen::Affine3d& here) {
    const GltfJson mesh = number.named_item("meshes", root_);
    Polygons::Group group;
    if (const std::optional<GltfJson> name = node.find("name")) group.object = name->text();
    if (const std::optional<GltfJson> name = mesh.find("name")) group.names.push_back(name->text());
    polygons_.groups.push_back(std::move(group));
    if (node.find("skin") || mesh.find("weights")) ++at_rest_;
    const GltfJson primitives = mesh.field("primitives");
    for (std::size_t i = 0; i < primitives.size(); ++i) read_primitive(primitives.item(i), here);
  }

  void read_primitive(const GltfJson& primitive, const Eigen::Affine3d& here) {
    constexpr std::size_t kTriangles = 4, kFan = 6;  // 5 is a strip
    const std::size_t mode = primitive.count_or("mode", kTriangles);
    if (mode > kFan) primitive.field("mode").fail("unknown (" + std::to_string(mode) + ", 0 to 6)");
    if (mode < kTriangles) {
      ++lines_and_points_;
      return;
    }
    if (const std::optional<GltfJson> extensions = primitive.find("extensions");
        extensions && extensions->find("KHR_draco_mesh_compression"))
      extensions->fail("Draco's compression is not read: export without it");
    const int first = static_cast<int>(polygons_.positions.size());
    const std::size_t vertices = add_positions(primitive, here);
    const std::vector<int> order = vertex_order(primitive, vertices);
    if (order.size() < 3 || (mode == kTriangles && order.size() % 3 != 0))
      primitive.fail("its corners make no triangles (" + std::to_string(order.size()) +
                     "): the file is damaged");
    const bool mirrored = here.linear().determinant() < 0;
    const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
      add_triangle({first + order[a], first + order[mirrored ? c : b], first + order[mirrored ? b : c]});
    };
    if (mode == kTriangles) {
      for (std::size_t i = 0; i < order.size(); i += 3) add(i, i + 1, i + 2);
    } else {
      for (std::size_t i = 0; i + 2 < order.size(); ++i) {
        mode == kFan ? add(i + 1, i + 2, 0) : add(i, i + 1 + i % 2, i + 2 - i % 2);
      }
    }
    check_size(primitive, 0);
  }

  void check_size(const GltfJson& at, std::size_t more) const {
    if (polygons_.corners.size() + more > kMostGltfCorners ||
        polygons_.positions.size() + more > kMostGltfCorners)
      at.fail("too many corners in all (limit " + std::to_string(kMostGltfCorners) + "): thin the mesh out");
  }

  // Returns how many there are.
  std::size_t add_positions(const GltfJson& primitive, const Eigen::Affine3d& here) {
    constexpr std::array kTypes{kGltfFloat};
    const GltfJson number = primitive.field("attributes").field("POSITION");
    const GltfList list = buffers_.list(number, "VEC3", kTypes);
    check_size(primitive, list.count);
    const std::size_t first = polygons_.positions.size();
    for (std::size_t i = 0; i < list.count; ++i) {
      Eigen::Vector3d own;
      for (std::size_t axis = 0; axis < 3; ++axis)
        own[static_cast<int>(axis)] = number_at<float>(list.bytes, i * list.stride + 4 * axis);
      polygons_.positions.push_back(own);
    }
    const std::span<Eigen::Vector3d> added = std::span(polygons_.positions).subspan(first);
    const double stretch = here.linear().colwise().norm().maxCoeff();
    for (std::size_t i = 0; i < added.size(); ++i) {
      // Not finite before is not finite after.
      const std::string why = refusal_of_position(here * added[i], limit_);
      if (!why.empty()) throw_at(list, i, why);
    }
    polygons_.spacing = std::max(polygons_.spacing, stretch * single_precision_spacing(added));
    for (Eigen::Vector3d& position : added) position = here * position;
    return list.count;
  }

  [[noreturn]] void throw_at(const GltfList& list, std::size_t item, const std::string& why) const {
    root_.fail(list.path + ": item " + std::to_string(item) + ": " + why);
  }

  // Returns the vertices of a primitive's corners, in their order.
  std::vector<int> vertex_order(const GltfJson& primitive, std::size_t vertices) {
    std::vector<int> order;
    const std::optional<GltfJson> number = primitive.find("indices");
    if (!number) {
      order.resize(vertices);
      for (std::size_t i = 0; i < vertices; ++i) order[i] = static_cast<int>(i);
      return order;
    }
    constexpr std::array kTypes{kGltfUint8, kGltfUint16, kGltfUint32};
    const GltfList list = buffers_.list(*number, "SCALAR", kTypes);
    // A strip has three corners for every index but two.
    check_size(primitive, 3 * list.count);
    order.reserve(list.count);
    for (std::size_t i = 0; i < list.count; ++i) {
      const std::size_t at = i * list.stride;
      const std::size_t index = list.component == kGltfUint8    ? number_at<std::uint8_t>(list.bytes, at)
                                : list.component == kGltfUint16 ? number_at<std::uint16_t>(list.bytes, at)
                                                                : number_at<std::uint32_t>(list.bytes, at);
      if (index >= vertices) {
        throw_at(list, i,
                 "vertex index out of range (" + std::to_string(index) + ", the primitive has " +
                     std::to_string(vertices) + " vertices): the file is damaged");
      }
      order.push_back(static_cast<int>(index));
    }
    return order;
  }

  void add_triangle(const std::array<int, 3>& corners) {
    polygons_.corners.insert(polygons_.corners.end(), corners.begin(), corners.end());
    polygons_.first_corner.push_back(static_cast<std::uint32_t>(polygons_.corners.size()));
    polygons_.face_place.push_back(static_cast<std::uint32_t>(polygons_.face_place.size() + 1));
    polygons_.face_group.push_back(static_cast<std::uint32_t>(polygons_.groups.size() - 1));
  }

  void tell_what_was_passed_over() {
    if (lines_and_points_ > 0) {
      polygons_.warnings.push_back(text_of(lines_and_points_, Warning::kLineOrPoint, {}));
    }
    if (at_rest_ > 0) {
      polygons_.warnings.push_back(text_of(at_rest_, Warning::kMeshAtRest, {}));
    }
  }

  const GltfJson& root_;
  GltfBuffers& buffers_;
  double limit_;
  std::vector<bool> reached_;
  std::vector<Waiting> waiting_;
  std::size_t lines_and_points_ = 0, at_rest_ = 0;
  Polygons polygons_;
};

}  // namespace

Polygons parse_gltf(std::string_view bytes, const std::filesystem::path& file, double limit,
                    const std::function<std::string(const std::filesystem::path&)>& read_file) {
  const std::string name = file.string();
  const GltfParts parts = bytes.starts_with("glTF") ? parts_of_glb(bytes, name) : GltfParts{bytes, {}, 0};
  const nlohmann::json json = GltfJson::parse(parts.json, name, parts.json_at);
  const GltfJson root(json, "", name);
  GltfBuffers buffers(root, parts.chunk, file, read_file);
  return GltfScene(root, buffers, limit).read();
}

}  // namespace hotblade::surface

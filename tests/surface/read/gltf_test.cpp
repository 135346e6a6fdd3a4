#include "surface/read/gltf.hpp"

#include <gmock/gmock.h>

#include <array>
#include <limits>
#include <nlohmann/json.hpp>

#include "tests/surface/read/mesh_files.hpp"

namespace hotblade::surface {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

// A square of 1 m in the plane of x and y: four positions, and six indices from byte 48 on.
std::string square_data() {
  std::string data;
  for (const float value : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 1.F, 1.F, 0.F, 0.F, 1.F, 0.F})
    data += number_bytes(value);
  for (const std::uint16_t index : std::array<std::uint16_t, 6>{0, 1, 2, 0, 2, 3})
    data += number_bytes(index);
  return data;
}

json square() {
  return json::parse(R"({
    "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
    "nodes": [{"mesh": 0, "name": "panel"}],
    "meshes": [{"name": "square", "primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                  {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}],
    "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
    "buffers": [{"byteLength": 60}]})");
}

std::string chunk(std::uint32_t type, std::string bytes, char fill) {
  while (bytes.size() % 4 != 0) bytes += fill;
  return number_bytes(static_cast<std::uint32_t>(bytes.size())) + number_bytes(type) + bytes;
}

std::string glb(const json& said, const std::string& data = square_data()) {
  const std::string chunks = chunk(0x4e4f534a, said.dump(), ' ') + chunk(0x004e4942, data, '\0');
  return "glTF" + number_bytes(std::uint32_t{2}) +
         number_bytes(static_cast<std::uint32_t>(12 + chunks.size())) + chunks;
}

const ReadOptions kMetres{"", 'z'};

DesignSurface read_glb(const json& said, const std::string& data = square_data()) {
  return read_bytes_as(glb(said, data), "a.glb", kMetres);
}
std::string refusal(const json& said, const std::string& data = square_data()) {
  return refusal_of(glb(said, data), "a.glb", kMetres);
}

std::string base64(const std::string& bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned int bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (int k = 3; k >= 0; --k) text += kDigits[bits >> 6 * k & 63U];
  }
  for (std::size_t k = 0; k < (3 - bytes.size() % 3) % 3; ++k) text[text.size() - 1 - k] = '=';
  return text;
}

// A GLB whose JSON has this behind it.
std::string glb_with(const std::string& behind) {
  const std::string json_chunk = chunk(0x4e4f534a, square().dump() + behind, ' ');
  const std::string chunks = json_chunk + chunk(0x004e4942, square_data(), '\0');
  return "glTF" + number_bytes(std::uint32_t{2}) +
         number_bytes(static_cast<std::uint32_t>(12 + chunks.size())) + chunks;
}

TEST(Gltf, HasNothingBehindANulOfItsJson) {
  std::string filled = square().dump();
  filled = std::string(4 - filled.size() % 4, '\0');
  EXPECT_NEAR(read_bytes_as(glb_with(filled), "a.glb", kMetres).health.area_mm2, 1e6, 1e-3);
  EXPECT_THAT(refusal_of(glb_with(filled + "more"), "a.glb", kMetres), HasSubstr("not the JSON of a glTF"));
}

TEST(Gltf, IsInMetresWithYUp) {
  const DesignSurface design = read_glb(square());
  ASSERT_THAT(design.mesh.vertices(), SizeIs(4));
  EXPECT_EQ(design.mesh.vertices()[2], Eigen::Vector3d(1000, 0, 1000));
  EXPECT_EQ(design.units, "m");
  EXPECT_EQ(design.up, 'y');
  EXPECT_EQ(design.format, FileFormat::kGltf);
  EXPECT_EQ(design.place, "triangle");
  EXPECT_THAT(refusal_of(glb(square()), "a.glb", {"mm", 'z'}), HasSubstr("glTF is in metres, not in mm"));
}

TEST(Gltf, MatricesOfNodesAndTheirParentsAreApplied) {
  json said = square();
  said["nodes"] = json::parse(R"([
    {"children": [1], "translation": [10, 0, 0]},
    {"mesh": 0, "rotation": [0, 0, 0.7071067811865476, 0.7071067811865476], "scale": [2, 3, 1]}])");
  const DesignSurface turned = read_glb(said);
  // (1, 1, 0) stretched to (2, 3, 0), turned about z to (-3, 2, 0), moved to (7, 2, 0); then y becomes up.
  EXPECT_LT((turned.mesh.vertices()[2] - Eigen::Vector3d(7000, 0, 2000)).norm(), 1e-9);
  said["nodes"] =
      json::parse(R"([{"mesh": 0, "matrix": [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1]}])");
  EXPECT_EQ(read_glb(said).mesh.vertices()[1], Eigen::Vector3d(5000, 0, 1000));
}

TEST(Gltf, AMirroringMatrixTurnsTrianglesOver) {
  json said = square();
  const auto normal = [&] {
    const DesignSurface design = read_glb(said);
    const auto t = design.mesh.triangles()[0];
    const auto at = [&](int k) {
      return design.mesh.vertices()[static_cast<std::size_t>(t[static_cast<std::size_t>(k)])];
    };
    return Eigen::Vector3d((at(1) - at(0)).cross(at(2) - at(0)).normalized());
  };
  const Eigen::Vector3d before = normal();
  said["nodes"][0]["scale"] = {-1, 1, 1};
  EXPECT_LT((normal() - before).norm(), 1e-12);
}

TEST(Gltf, StripsAndFansAreTriangles) {
  json said = square();
  said["meshes"][0]["primitives"][0].erase("indices");
  said["meshes"][0]["primitives"][0]["mode"] = 6;
  EXPECT_NEAR(read_glb(said).health.area_mm2, 1e6, 1e-3);
  std::string data;
  for (const float value : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F, 1.F, 1.F, 0.F})
    data += number_bytes(value);
  said["meshes"][0]["primitives"][0]["mode"] = 5;
  EXPECT_NEAR(read_glb(said, data + std::string(12, '\0')).health.area_mm2, 1e6, 1e-3);
}

TEST(Gltf, NodesAndMeshesAreGroups) {
  json said = square();
  said["nodes"].push_back({{"mesh", 0}, {"name", "other"}, {"translation", {0, 0, 5}}});
  said["scenes"][0]["nodes"] = {0, 1};
  EXPECT_THAT(read_glb(said).mesh.triangles(), SizeIs(4));
  ReadOptions options = kMetres;
  options.group = "other";
  EXPECT_THAT(read_bytes_as(glb(said), "a.glb", options).mesh.triangles(), SizeIs(2));
  options.group = "square";
  EXPECT_THAT(read_bytes_as(glb(said), "a.glb", options).mesh.triangles(), SizeIs(4));
  options.group = "none";
  EXPECT_THAT(refusal_of(glb(said), "a.glb", options), HasSubstr("choose one of other, panel, square"));
}

TEST(Gltf, BuffersMayBeInTheTextOrBesideTheFile) {
  json said = square();
  said["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64(square_data());
  EXPECT_THAT(read_bytes_as(said.dump(2), "a.gltf", kMetres).mesh.triangles(), SizeIs(2));
  said["buffers"][0]["uri"] = "the%20data.bin";
  const ScratchFile file(said.dump(), "a.gltf");
  EXPECT_THROW((void)read_surface(file.path(), kMetres), FileError);
  std::ofstream(file.folder() / "the data.bin", std::ios::binary) << square_data();
  const DesignSurface one = read_surface(file.path(), kMetres);
  EXPECT_THAT(one.mesh.triangles(), SizeIs(2));
  std::string moved = square_data();
  moved[15] = '\x40';
  std::ofstream(file.folder() / "the data.bin", std::ios::binary) << moved;
  EXPECT_NE(read_surface(file.path(), kMetres).sha256, one.sha256);
}

TEST(Gltf, BuffersOutsideTheFolderAreRefused) {
  for (const char* uri : {"../secret.bin", "/etc/hostname", "https://host/a.bin", "a/../../b", "%2e%2e/b",
                          "..\\b", "", "link/b", "%zz", "."}) {
    json said = square();
    said["buffers"][0]["uri"] = uri;
    const ScratchFile file(said.dump(), "a.gltf");
    std::filesystem::create_directory_symlink("/etc", file.folder() / "link");
    EXPECT_THAT(message_of<MeshError>([&] { (void)read_surface(file.path(), kMetres); }),
                AllOf(HasSubstr("buffers[0].uri"), HasSubstr("outside the file's folder")))
        << uri;
  }
}

TEST(Gltf, WhatIsNotReadIsRefusedByName) {
  json said = square();
  said["extensionsRequired"] = {"KHR_materials_unlit", "KHR_mesh_quantization"};
  EXPECT_THAT(refusal(said),
              HasSubstr("extensionsRequired[1]: extension that is not read ('KHR_mesh_quantization')"));
  said = square();
  said["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = json::object();
  EXPECT_THAT(refusal(said),
              HasSubstr("meshes[0].primitives[0].extensions: Draco's compression is not read"));
  said = square();
  said["accessors"][0]["sparse"] = json::object();
  EXPECT_THAT(refusal(said), HasSubstr("accessors[0].sparse: sparse data are not read"));
  said = square();
  said["accessors"][0]["componentType"] = 5122;
  EXPECT_THAT(refusal(said),
              HasSubstr("accessors[0].componentType: not a type of number that is read here (5122)"));
  said = square();
  said["accessors"][0].erase("bufferView");
  EXPECT_THAT(refusal(said), HasSubstr("accessors[0]: has no bufferView"));
  said = square();
  said["asset"]["version"] = "1.0";
  EXPECT_THAT(refusal(said), HasSubstr("asset.version: unknown version ('1.0', 2.0 is read)"));
}

TEST(Gltf, CountsAndPlacesThatLieAreToldWithTheirPath) {
  const auto with = [](const char* place, const json& value) {
    json said = square();
    said[json::json_pointer(place)] = value;
    return refusal(said);
  };
  EXPECT_THAT(with("/accessors/0/count", 5), HasSubstr("accessors[0]: goes beyond its bufferView (5 items"));
  EXPECT_THAT(with("/accessors/0/count", 9007199254740992), HasSubstr("accessors[0]: goes beyond"));
  EXPECT_THAT(with("/accessors/0/count", 1e300), HasSubstr("accessors[0].count: is no count"));
  EXPECT_THAT(with("/accessors/0/count", -1), HasSubstr("accessors[0].count: is no count (-1)"));
  EXPECT_THAT(with("/accessors/0/byteOffset", 4), HasSubstr("goes beyond its bufferView"));
  EXPECT_THAT(with("/bufferViews/0/byteLength", 61), HasSubstr("bufferViews[0]: goes beyond its buffer"));
  EXPECT_THAT(with("/bufferViews/0/byteStride", 8), HasSubstr("byteStride out of range (8, 12 to 252)"));
  EXPECT_THAT(with("/buffers/0/byteLength", 61),
              HasSubstr("buffers[0]: shorter than it says (60 bytes of 61)"));
  EXPECT_THAT(with("/bufferViews/1/buffer", 1),
              HasSubstr("bufferViews[1].buffer: out of range (1, the file has 1 buffers)"));
  EXPECT_THAT(with("/nodes/0/mesh", 7), HasSubstr("nodes[0].mesh: out of range"));
  EXPECT_THAT(with("/nodes/0/children", {0}), HasSubstr("nodes[0].children[0]: node 0 is reached twice"));
  EXPECT_THAT(with("/nodes/0/matrix", {1, 2}), HasSubstr("nodes[0].matrix: has 2 numbers, 16 are due"));
  EXPECT_THAT(with("/nodes/0/rotation", {0, 0, 0, 2}), HasSubstr("nodes[0].rotation: is no rotation"));
  EXPECT_THAT(with("/nodes/0/translation", {1e5, 0, 0}), HasSubstr("too large (100000, limit 1e7 mm"));
  EXPECT_THAT(with("/nodes/0/name", 5), HasSubstr("nodes[0].name: is no text"));
  EXPECT_THAT(with("/accessors/1/count", 5), HasSubstr("its corners make no triangles (5)"));
  EXPECT_THAT(with("/scene", 1), HasSubstr("scene: out of range"));
  EXPECT_THAT(with("/scenes/0/nodes", json::array()), HasSubstr("no triangles in the file"));
  EXPECT_THAT(with("/meshes/0/primitives/0/mode", 7), HasSubstr("primitives[0].mode: unknown (7"));
  EXPECT_THAT(with("/meshes/0/primitives/0/mode", 1), HasSubstr("no triangles in the file"));
}

TEST(Gltf, NumbersInBuffersAreChecked) {
  std::string data = square_data();
  data.replace(16, 4, number_bytes(std::numeric_limits<float>::quiet_NaN()));
  EXPECT_THAT(refusal(square(), data), HasSubstr("accessors[0]: item 1: coordinate is not a finite number"));
  data = square_data();
  data.replace(50, 2, number_bytes(std::uint16_t{4}));
  EXPECT_THAT(refusal(square(), data),
              HasSubstr("accessors[1]: item 1: vertex index out of range (4, the primitive has 4"));
}

TEST(Gltf, LinesAndSkinsAreWarnedOf) {
  json said = square();
  json line = said["meshes"][0]["primitives"][0];
  line["mode"] = 1;
  said["meshes"][0]["primitives"].push_back(line);
  said["nodes"][0]["skin"] = 0;
  EXPECT_THAT(
      read_glb(said).health.warnings,
      ElementsAre(HasSubstr("1 primitive of lines or points passed over"), HasSubstr("read as at rest")));
}

TEST(Gltf, WhatIsNoGlbIsToldWithItsByte) {
  const std::string good = glb(square());
  const auto with = [&](std::size_t at, const std::string& bytes) {
    std::string changed = good;
    changed.replace(at, bytes.size(), bytes);
    return refusal_of(changed, "a.glb", kMetres);
  };
  EXPECT_THAT(with(4, number_bytes(std::uint32_t{1})), HasSubstr("a.glb: byte 4: unknown version of GLB (1"));
  EXPECT_THAT(with(8, number_bytes(std::uint32_t{99})),
              HasSubstr("byte 8: the GLB has another size than it says"));
  EXPECT_THAT(with(12, number_bytes(0xffffffffU)), HasSubstr("byte 12: a chunk goes beyond the file"));
  EXPECT_THAT(with(16, "JUNK"), HasSubstr("byte 12: the first chunk, and no other, has to be the JSON"));
  EXPECT_THAT(with(20, "("), HasSubstr("byte 21: not the JSON of a glTF"));
}

TEST(Gltf, CutAnywhereItIsRefused) {
  const std::string binary = glb(square());
  for (std::size_t n = 0; n < binary.size(); ++n)
    EXPECT_THAT(refusal_of(binary.substr(0, n), "a.glb", kMetres), HasSubstr("a.glb")) << n;
  json said = square();
  said["buffers"][0]["uri"] = "data:;base64," + base64(square_data());
  const std::string text = said.dump();
  for (std::size_t n = 0; n < text.size(); ++n)
    EXPECT_THAT(refusal_of(text.substr(0, n), "a.gltf", kMetres), HasSubstr("a.gltf")) << n;
}

}  // namespace
}  // namespace hotblade::surface

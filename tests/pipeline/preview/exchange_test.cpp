#include "pipeline/preview/drawing/exchange.hpp"

#include <gmock/gmock.h>
#include <vtkCompositeDataSet.h>
#include <vtkInformation.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkXMLMultiBlockDataReader.h>

#include <nlohmann/json.hpp>

#include "pipeline/preview/drawing/movie.hpp"
#include "pipeline/settings/error.hpp"
#include "tests/pipeline/temporary_directory.hpp"
#include "tests/pipeline/vault_program.hpp"

namespace hotblade::pipeline::preview {
namespace {

using pipeline::testing::read_bytes;
using pipeline::testing::TemporaryDirectory;
using pipeline::testing::vault_program;
using ::testing::HasSubstr;

std::size_t decoded_size(const std::string& uri) {
  const std::string data = uri.substr(uri.find(',') + 1);
  return data.size() / 4 * 3 - static_cast<std::size_t>(std::count(data.end() - 2, data.end(), '='));
}

TEST(GltfOf, IsCompleteAndPointsOnlyIntoItself) {
  const auto gltf = nlohmann::json::parse(gltf_of(scene_of(vault_program({.strips = 2}), nullptr, {})));
  EXPECT_EQ(gltf["asset"]["version"], "2.0");
  for (const auto& buffer : gltf["buffers"]) {
    const std::string uri = buffer["uri"];
    EXPECT_THAT(uri, ::testing::StartsWith("data:"));
    EXPECT_EQ(decoded_size(uri), buffer["byteLength"].get<std::size_t>());
  }
  for (const auto& view : gltf["bufferViews"]) {
    const auto& buffer = gltf["buffers"].at(view["buffer"].get<std::size_t>());
    EXPECT_LE(view.value("byteOffset", 0u) + view["byteLength"].get<std::size_t>(),
              buffer["byteLength"].get<std::size_t>());
  }
  for (const auto& accessor : gltf["accessors"]) {
    ASSERT_NO_THROW(gltf["bufferViews"].at(accessor["bufferView"].get<std::size_t>()));
  }
  for (const auto& image : gltf["images"]) EXPECT_TRUE(image.contains("bufferView") || image.contains("uri"));
  for (const auto& mesh : gltf["meshes"]) {
    for (const auto& primitive : mesh["primitives"]) {
      ASSERT_NO_THROW(gltf["accessors"].at(primitive["indices"].get<std::size_t>()));
      ASSERT_NO_THROW(gltf["materials"].at(primitive["material"].get<std::size_t>()));
    }
  }
}

TEST(GltfOf, IsInMetresWithYUp) {
  const Scene scene = scene_of(vault_program(), nullptr, {});
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e300), high = -low;
  for (const Eigen::Vector3d& p : scene.cut.vertices) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const auto gltf = nlohmann::json::parse(gltf_of(scene));
  bool found = false;
  for (const auto& node : gltf["nodes"]) {
    if (!node.contains("mesh")) continue;
    const auto& primitive = gltf["meshes"].at(node["mesh"].get<std::size_t>())["primitives"][0];
    if (primitive["mode"] != 4 || !primitive["attributes"].contains("TEXCOORD_0")) continue;
    const auto& position = gltf["accessors"].at(primitive["attributes"]["POSITION"].get<std::size_t>());
    const std::vector<double> m = node["matrix"];
    const auto moved = [&](const std::vector<double>& p) {
      return Eigen::Vector3d(m[0] * p[0] + m[4] * p[1] + m[8] * p[2] + m[12],
                             m[1] * p[0] + m[5] * p[1] + m[9] * p[2] + m[13],
                             m[2] * p[0] + m[6] * p[1] + m[10] * p[2] + m[14]);
    };
    const Eigen::Vector3d a = moved(position["min"]), b = moved(position["max"]);
    EXPECT_LT((a.cwiseMin(b) - Eigen::Vector3d(low.x(), low.z(), -high.y()) / 1000).norm(), 1e-6);
    EXPECT_LT((a.cwiseMax(b) - Eigen::Vector3d(high.x(), high.z(), -low.y()) / 1000).norm(), 1e-6);
    found = true;
  }
  EXPECT_TRUE(found) << "no coloured surface";
}

TEST(WriteVtm, ReadsBackWithItsBlocksAndStrips) {
  const TemporaryDirectory directory;
  const Scene scene = scene_of(vault_program({.strips = 2}), nullptr, {});
  write_vtm(scene, directory / "a.vtm", false);
  vtkNew<vtkXMLMultiBlockDataReader> reader;
  reader->SetFileName((directory / "a.vtm").c_str());
  reader->Update();
  auto* blocks = vtkMultiBlockDataSet::SafeDownCast(reader->GetOutput());
  ASSERT_NE(blocks, nullptr);
  std::vector<std::string> names;
  for (unsigned int i = 0; i < blocks->GetNumberOfBlocks(); ++i) {
    names.emplace_back(blocks->GetMetaData(i)->Get(vtkCompositeDataSet::NAME()));
    if (names.back() != "cut") continue;
    auto* cut = vtkPolyData::SafeDownCast(blocks->GetBlock(i));
    ASSERT_NE(cut, nullptr);
    EXPECT_EQ(static_cast<std::size_t>(cut->GetNumberOfPoints()), scene.cut.vertices.size());
    EXPECT_EQ(static_cast<std::size_t>(cut->GetNumberOfPolys()), scene.cut.triangles.size());
    auto* strips = cut->GetPointData()->GetArray("strip");
    ASSERT_NE(strips, nullptr);
    EXPECT_EQ(strips->GetRange()[1], 1);
  }
  EXPECT_THAT(names, ::testing::ElementsAre("cut", "ribs", "blades", "stock"));
}

TEST(WriteVtm, KeepsWhatIsThereWithoutForceAndLeavesNoDraft) {
  const TemporaryDirectory directory;
  const Scene scene = scene_of(vault_program(), nullptr, {});
  write_vtm(scene, directory / "a.vtm", false);
  EXPECT_THROW(write_vtm(scene, directory / "a.vtm", false), Error);
  write_vtm(scene, directory / "a.vtm", true);
  std::filesystem::create_directory(directory / "b");
  EXPECT_THROW(write_vtm(scene, directory / "b.vtm", false), Error);
  EXPECT_EQ(testing::files_in(directory.path()), 3u);  // a.vtm, a, b
}

TEST(WriteMovie, IsAnOggFileThatGrowsWithItsFrames) {
  const TemporaryDirectory directory;
  const ViewModel model = view_model(vault_program(), nullptr, {});
  const auto quiet = [](double) {};
  MovieOptions options;
  options.size = {320, 176};
  for (const int frames : {2, 8}) {
    options.frames = frames;
    write_movie(model, {}, options, directory / ("a" + std::to_string(frames) + ".ogv"), false, quiet);
  }
  const std::string two = read_bytes(directory / "a2.ogv"), eight = read_bytes(directory / "a8.ogv");
  EXPECT_EQ(two.substr(0, 4), "OggS");
  EXPECT_THAT(two.substr(0, 200), HasSubstr("theora"));
  EXPECT_GT(eight.size(), two.size());
  EXPECT_THROW(write_movie(model, {}, options, directory / "a8.ogv", false, quiet), Error);
}

}  // namespace
}  // namespace hotblade::pipeline::preview

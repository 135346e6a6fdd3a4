// Scenes and surfaces read by other makers' readers: assimp and OpenMesh.
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <gtest/gtest.h>

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <assimp/Importer.hpp>
#include <fstream>

#include "pipeline/export/surface_files.hpp"
#include "pipeline/preview/drawing/exchange.hpp"
#include "pipeline/verify/swept_surface.hpp"
#include "tests/pipeline/temporary_directory.hpp"
#include "tests/pipeline/vault_program.hpp"

namespace hotblade::pipeline {
namespace {

struct DoubleTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
};
using Mesh = OpenMesh::TriMesh_ArrayKernelT<DoubleTraits>;

constexpr double kSample_mm = 10;
// Six decimals in the file; OpenMesh and assimp read in single precision.
constexpr double kSingle_mm = 1e-4;

void expect_same_points(const std::vector<Eigen::Vector3d>& read,
                        const std::vector<Eigen::Vector3d>& written) {
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t i = 0; i < read.size(); ++i) ASSERT_LT((read[i] - written[i]).norm(), kSingle_mm) << i;
}

class SurfaceFile : public ::testing::TestWithParam<const char*> {
 protected:
  std::string write() const {
    const Program program = testing::vault_program({.strips = 2});
    const ExportedFile file =
        std::string(GetParam()) == "obj" ? as_cut_obj(program, kSample_mm) : as_cut_ply(program, kSample_mm);
    std::ofstream(directory_ / file.name) << file.text;
    return (directory_ / file.name).string();
  }
  testing::TemporaryDirectory directory_;
  SweptSurface swept_ = swept_surface(testing::vault_program({.strips = 2}), kSample_mm);
};

TEST_P(SurfaceFile, IsReadByOpenMeshVertexByVertexAndFaceByFace) {
  Mesh mesh;
  ASSERT_TRUE(OpenMesh::IO::read_mesh(mesh, write()));
  std::vector<Eigen::Vector3d> read;
  for (const auto v : mesh.vertices()) {
    const auto p = mesh.point(v);
    read.emplace_back(p[0], p[1], p[2]);
  }
  expect_same_points(read, swept_.vertices);
  ASSERT_EQ(mesh.n_faces(), swept_.triangles.size());
  for (const auto f : mesh.faces()) {
    std::array<int, 3> corners{};
    std::size_t k = 0;
    for (const auto v : mesh.fv_range(f)) corners.at(k++) = v.idx();
    std::array<int, 3> wanted = swept_.triangles[static_cast<std::size_t>(f.idx())];
    std::sort(corners.begin(), corners.end());
    std::sort(wanted.begin(), wanted.end());
    ASSERT_EQ(corners, wanted);
  }
}

TEST_P(SurfaceFile, IsReadByAssimpWithItsNormals) {
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(write(), aiProcess_ValidateDataStructure);
  ASSERT_NE(scene, nullptr) << importer.GetErrorString();
  std::size_t faces = 0;
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e300), high = -low;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& mesh = *scene->mMeshes[m];
    faces += mesh.mNumFaces;
    ASSERT_TRUE(mesh.HasNormals());
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const Eigen::Vector3d p(mesh.mVertices[i].x, mesh.mVertices[i].y, mesh.mVertices[i].z);
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
      EXPECT_NEAR(mesh.mNormals[i].Length(), 1, 1e-5);
      EXPECT_GT(mesh.mNormals[i].z, 0) << "the waste lies above";
    }
  }
  EXPECT_EQ(faces, swept_.triangles.size());
  Eigen::Vector3d wanted_low = Eigen::Vector3d::Constant(1e300), wanted_high = -wanted_low;
  for (const Eigen::Vector3d& p : swept_.vertices) {
    wanted_low = wanted_low.cwiseMin(p);
    wanted_high = wanted_high.cwiseMax(p);
  }
  EXPECT_LT((low - wanted_low).norm() + (high - wanted_high).norm(), kSingle_mm);
}

INSTANTIATE_TEST_SUITE_P(Formats, SurfaceFile, ::testing::Values("obj", "ply"),
                         [](const auto& format) { return std::string(format.param); });

aiMatrix4x4 to_world(const aiNode* node) {
  aiMatrix4x4 m = node->mTransformation;
  for (node = node->mParent; node != nullptr; node = node->mParent) m = node->mTransformation * m;
  return m;
}

struct Box {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e300), high = Eigen::Vector3d::Constant(-1e300);
};

void collect_textured(const aiScene& scene, const aiNode& node, Box& box, int& found) {
  for (unsigned m = 0; m < node.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[node.mMeshes[m]];
    if (!mesh.HasTextureCoords(0)) continue;
    ++found;
    const aiMatrix4x4 world = to_world(&node);
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const aiVector3D p = world * mesh.mVertices[i];
      box.low = box.low.cwiseMin(Eigen::Vector3d(p.x, p.y, p.z));
      box.high = box.high.cwiseMax(Eigen::Vector3d(p.x, p.y, p.z));
    }
  }
  for (unsigned c = 0; c < node.mNumChildren; ++c) collect_textured(scene, *node.mChildren[c], box, found);
}

TEST(GltfScene, IsReadByAssimpInMetresWithYUpAndItsColours) {
  const testing::TemporaryDirectory directory;
  preview::Scene scene =
      preview::scene_of(testing::vault_program({.strips = 2}), nullptr, {preview::Color::kCurvature, {}, {}});
  const auto file = directory / "scene.gltf";
  std::ofstream(file) << preview::gltf_of(scene);
  Assimp::Importer importer;
  const aiScene* read = importer.ReadFile(file.string(), aiProcess_ValidateDataStructure);
  ASSERT_NE(read, nullptr) << importer.GetErrorString();
  Box box, wanted;
  int found = 0;
  collect_textured(*read, *read->mRootNode, box, found);
  EXPECT_EQ(found, 1) << "one surface that carries the scale's colours";
  for (const Eigen::Vector3d& p : scene.cut.vertices) {
    const Eigen::Vector3d metres = 1e-3 * Eigen::Vector3d(p.x(), p.z(), -p.y());
    wanted.low = wanted.low.cwiseMin(metres);
    wanted.high = wanted.high.cwiseMax(metres);
  }
  EXPECT_LT((box.low - wanted.low).norm() + (box.high - wanted.high).norm(), 1e-3 * kSingle_mm * 10);
  ASSERT_EQ(read->mNumTextures, 1u);
  EXPECT_STREQ(read->mTextures[0]->achFormatHint, "png");
}

}  // namespace
}  // namespace hotblade::pipeline

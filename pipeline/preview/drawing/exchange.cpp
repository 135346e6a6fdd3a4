#include "pipeline/preview/drawing/exchange.hpp"

#include <vtkActor.h>
#include <vtkActorCollection.h>
#include <vtkCompositeDataSet.h>
#include <vtkDoubleArray.h>
#include <vtkGLTFExporter.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkInformation.h>
#include <vtkIntArray.h>
#include <vtkMatrix4x4.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkRenderer.h>
#include <vtkXMLMultiBlockDataWriter.h>

#include <algorithm>

#include "pipeline/preview/drawing/draw_parts.hpp"
#include "pipeline/preview/drawing/geometry.hpp"
#include "pipeline/program/atomic_file.hpp"
#include "pipeline/settings/error.hpp"

namespace hotblade::pipeline::preview {
namespace {

namespace fs = std::filesystem;

// mm with z up into metres with y up: (x, y, z) -> (x, z, -y) / 1000.
vtkNew<vtkMatrix4x4> design_to_gltf() {
  constexpr double kMetre = 1e-3;
  vtkNew<vtkMatrix4x4> m;
  m->Zero();
  m->SetElement(0, 0, kMetre);
  m->SetElement(1, 2, kMetre);
  m->SetElement(2, 1, -kMetre);
  m->SetElement(3, 3, 1);
  return m;
}

void add_block(vtkMultiBlockDataSet& blocks, const char* name, vtkPolyData& data) {
  const unsigned int index = blocks.GetNumberOfBlocks();
  blocks.SetBlock(index, &data);
  blocks.GetMetaData(index)->Set(vtkCompositeDataSet::NAME(), name);
}

vtkNew<vtkPolyData> cut_block(const Scene& scene) {
  vtkNew<vtkPolyData> mesh;
  set_mesh(*mesh, scene.cut.vertices, scene.cut.triangles);
  const auto count = static_cast<vtkIdType>(scene.cut.vertices.size());
  vtkNew<vtkIntArray> strips;
  strips->SetName("strip");
  strips->SetNumberOfValues(count);
  for (vtkIdType i = 0; i < count; ++i)
    strips->SetValue(i, scene.cut.strip_of_vertex[static_cast<std::size_t>(i)]);
  mesh->GetPointData()->AddArray(strips);
  if (scene.scale) {
    vtkNew<vtkDoubleArray> values;
    values->SetName(scene.scale->title.c_str());
    values->SetNumberOfValues(count);
    for (vtkIdType i = 0; i < count; ++i) values->SetValue(i, scene.cut.values[static_cast<std::size_t>(i)]);
    mesh->GetPointData()->SetScalars(values);
  }
  return mesh;
}

vtkNew<vtkMultiBlockDataSet> blocks_of(const Scene& scene) {
  vtkNew<vtkMultiBlockDataSet> blocks;
  const auto add_lines = [&](const char* name, const std::vector<Polyline>& lines) {
    if (lines.empty()) return;
    vtkNew<vtkPolyData> data;
    set_lines(*data, lines);
    add_block(*blocks, name, *data);
  };
  if (!scene.design.triangles().empty()) {
    vtkNew<vtkPolyData> design;
    set_mesh(*design, scene.design.vertices(), scene.design.triangles());
    add_block(*blocks, "design", *design);
  }
  if (!scene.cut.triangles.empty()) add_block(*blocks, "cut", *cut_block(scene));
  std::vector<Polyline> blades = scene.blades;
  if (scene.blade_now) blades.push_back(*scene.blade_now);
  add_lines("ribs", scene.ribs);
  add_lines("blades", blades);
  add_lines("stock", block_edges(scene.blocks));
  for (const CellPart& part : scene.cell) {
    vtkNew<vtkPolyData> mesh;
    std::vector<Eigen::Vector3d> vertices;
    for (const Eigen::Vector3d& vertex : part.vertices) vertices.emplace_back(part.place * vertex);
    set_mesh(*mesh, vertices, part.triangles);
    add_block(*blocks, part.name.c_str(), *mesh);
  }
  if (scene.worst) add_lines("worst place", rings_about(scene.worst->at, 2 * scene.clamp_size_mm));
  return blocks;
}

// Removed with all it holds when it goes out of scope.
struct Draft {
  fs::path path;
  ~Draft() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
};

}  // namespace

std::string gltf_of(const Scene& scene) {
  return gltf_of(scene, SceneMeshes(scene));
}

std::string gltf_of(const Scene& scene, const SceneMeshes& meshes) {
  vtkNew<vtkRenderer> renderer;
  add_actors(scene, meshes, *renderer, 1);
  const auto matrix = design_to_gltf();
  vtkActorCollection* actors = renderer->GetActors();
  actors->InitTraversal();
  while (vtkActor* actor = actors->GetNextActor()) {
    // Parts of a cell have places of their own.
    vtkNew<vtkMatrix4x4> whole;
    whole->DeepCopy(matrix);
    if (vtkMatrix4x4* place = actor->GetUserMatrix()) vtkMatrix4x4::Multiply4x4(matrix, place, whole);
    actor->SetUserMatrix(whole);
  }
  vtkNew<vtkGenericOpenGLRenderWindow> window;
  window->SetSize(1280, 720);
  window->AddRenderer(renderer);
  vtkNew<vtkGLTFExporter> exporter;
  exporter->SetRenderWindow(window);
  exporter->InlineDataOn();
  const std::string text = exporter->WriteToString();
  if (text.empty()) throw Error(ErrorKind::kDrawing, "glTF: nothing was written");
  return text;
}

void write_vtm(const Scene& scene, const fs::path& file, bool force) {
  expect_writable(file, force);
  const fs::path blocks = fs::path(file).replace_extension();
  std::error_code error;
  if (fs::exists(fs::symlink_status(blocks, error)) && !force) {
    throw Error(ErrorKind::kFile, blocks.string() + ": already exists: use --force to overwrite");
  }
  // VTK names the directory of the blocks after the file, so all of it is written below a draft of its own.
  const Draft draft{file.parent_path() / ("." + file.filename().string() + ".draft")};
  fs::remove_all(draft.path, error);
  ensure_directory(draft.path);
  vtkNew<vtkXMLMultiBlockDataWriter> writer;
  writer->SetInputData(blocks_of(scene));
  writer->SetFileName((draft.path / file.filename()).c_str());
  if (writer->Write() != 1) throw Error(ErrorKind::kFile, file.string() + ": cannot be written");
  fs::remove_all(blocks, error);
  fs::rename(draft.path / blocks.filename(), blocks, error);
  if (!error) fs::rename(draft.path / file.filename(), file, error);
  if (error) throw Error(ErrorKind::kFile, file.string() + ": cannot be written (" + error.message() + ")");
}

}  // namespace hotblade::pipeline::preview

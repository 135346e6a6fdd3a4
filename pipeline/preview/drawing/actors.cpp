#include <vtkActor.h>
#include <vtkDoubleArray.h>
#include <vtkFeatureEdges.h>
#include <vtkLookupTable.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataNormals.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "pipeline/preview/drawing/draw_parts.hpp"
#include "pipeline/preview/drawing/geometry.hpp"

namespace hotblade::pipeline::preview {

struct SceneMeshes::Parts {
  vtkSmartPointer<vtkPolyData> design, borders, cut;  // null where the scene has none
};

namespace {

using Triangles = std::vector<std::array<int, 3>>;

// The cut and the design lie a millimetre apart in a part a metre wide. So that the cut shows where there is
// one, and lines show on it, layers are moved along the line of sight, in the units VTK's mapper takes:
// millionths of the depth between the clipping planes, which is about the scene's diagonal.
class Depth {
 public:
  explicit Depth(const Scene& scene) {
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& vertex : scene.design.vertices()) box.extend(vertex);
    for (const Eigen::Vector3d& vertex : scene.cut.vertices) box.extend(vertex);
    for (const Polyline& blade : scene.blades) box.extend(blade.points.front()).extend(blade.points.back());
    for (const CellPart& part : scene.cell) {
      for (const Eigen::Vector3d& vertex : part.vertices) box.extend(part.place * vertex);
    }
    const double diagonal = box.isEmpty() ? 1 : box.diagonal().norm() + 1;
    double apart = 1;  // mm, half a band and a bit
    for (const double value :
         scene.scale&& scene.scale->tolerance ? scene.cut.values : std::vector<double>{}) {
      apart = std::max(apart, std::abs(value));
    }
    // No more than a fiftieth of the scene: surfaces farther apart are told apart by the eye as well.
    units_ = 1e6 * std::min(3 * apart, diagonal / 50) / diagonal;
    ring_mm_ = diagonal / 35;
  }
  [[nodiscard]] double behind() const { return units_; }
  [[nodiscard]] double before() const { return -units_; }
  // Before all that there is.
  [[nodiscard]] static double foremost() { return -1e6; }
  // Of a ring that is seen in the whole picture and hides little of it.
  [[nodiscard]] double ring_mm() const { return ring_mm_; }

 private:
  double units_ = 0, ring_mm_ = 1;
};

void set_depth(vtkMapper& mapper, double units) {
  mapper.SetResolveCoincidentTopologyToPolygonOffset();
  mapper.SetRelativeCoincidentTopologyPolygonOffsetParameters(0, units);
  mapper.SetRelativeCoincidentTopologyLineOffsetParameters(0, units);
}

// Normals are made once: the cut's triangles come and go, its vertices stay.
vtkSmartPointer<vtkPolyData> with_normals(vtkPolyData& data) {
  vtkNew<vtkPolyDataNormals> normals;
  normals->SetInputData(&data);
  normals->SplittingOff();
  normals->ConsistencyOff();
  normals->Update();
  return normals->GetOutput();
}

vtkSmartPointer<vtkActor> surface_actor(vtkPolyData& smooth, double depth) {
  // What is drawn on it is the actor's own.
  vtkNew<vtkPolyData> own;
  own->ShallowCopy(&smooth);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(own);
  set_depth(*mapper, depth);
  const auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  // Colours carry numbers, so light only shades them.
  actor->GetProperty()->SetAmbient(0.66);
  actor->GetProperty()->SetDiffuse(0.38);
  actor->GetProperty()->SetSpecular(0);
  return actor;
}

vtkSmartPointer<vtkActor> line_data_actor(vtkPolyData& data, const Rgb& color, double width, double depth) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(&data);
  mapper->ScalarVisibilityOff();
  set_depth(*mapper, depth);
  const auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(color[0], color[1], color[2]);
  actor->GetProperty()->SetLineWidth(static_cast<float>(width));
  actor->GetProperty()->LightingOff();
  return actor;
}

vtkPolyData& data_of(vtkActor& actor) {
  return *vtkPolyDataMapper::SafeDownCast(actor.GetMapper())->GetInput();
}

void add_design(const Scene& scene, const SceneMeshes& meshes, vtkRenderer& renderer, double zoom,
                const Depth& depth, SceneActors& actors) {
  if (!meshes.parts().design) return;
  const auto design = surface_actor(*meshes.parts().design, depth.behind());
  actors.design = design;
  vtkProperty& property = *actors.design->GetProperty();
  property.SetColor(kDesignColor[0], kDesignColor[1], kDesignColor[2]);
  const bool alone = scene.cut.triangles.empty();
  if (alone) {
    property.EdgeVisibilityOn();
    property.SetEdgeColor(0.62, 0.63, 0.66);
    property.SetLineWidth(static_cast<float>(0.6 * zoom));
  }
  renderer.AddActor(actors.design);
  const auto borders = line_data_actor(*meshes.parts().borders, kInk, 1.6 * zoom, depth.before());
  actors.borders = borders;
  renderer.AddActor(borders);
}

// Numbers are interpolated before they become colours, so the step at the tolerance is where it belongs, to a
// thousandth of the range.
vtkNew<vtkLookupTable> table_of(const ColorScale& scale) {
  constexpr int kEntries = 2048;
  vtkNew<vtkLookupTable> table;
  table->SetNumberOfTableValues(kEntries);
  table->SetTableRange(scale.low, scale.high);
  for (int i = 0; i < kEntries; ++i) {
    const Rgb color = color_at(scale, scale.low + (i + 0.5) / kEntries * (scale.high - scale.low));
    table->SetTableValue(i, color[0], color[1], color[2]);
  }
  return table;
}

vtkNew<vtkLookupTable> strip_table(int strips) {
  vtkNew<vtkLookupTable> table;
  table->SetNumberOfTableValues(strips);
  table->SetTableRange(-0.5, strips - 0.5);
  for (int i = 0; i < strips; ++i) {
    const Rgb color = strip_color(i);
    table->SetTableValue(i, color[0], color[1], color[2]);
  }
  return table;
}

// A clamp as a block along the blade, drawn where it grips.
void append_block(const Pose& pose, double size, std::vector<Eigen::Vector3d>& corners,
                  Triangles& triangles) {
  const int first = static_cast<int>(corners.size());
  const Eigen::Matrix3d axes = pose.q.normalized().toRotationMatrix();
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d half(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.35 : -0.35, corner & 4 ? 0.5 : -0.5);
    corners.push_back(pose.p + size * (axes * half));
  }
  constexpr int kFaces[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1},
                                {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
  for (const auto& f : kFaces) {
    triangles.push_back({first + f[0], first + f[1], first + f[2]});
    triangles.push_back({first + f[0], first + f[2], first + f[3]});
  }
}

}  // namespace

void color_cut(vtkActor& cut, const Scene& scene, const std::vector<double>& values,
               const std::optional<ColorScale>& scale) {
  vtkNew<vtkDoubleArray> scalars;
  scalars->SetNumberOfValues(static_cast<vtkIdType>(scene.cut.vertices.size()));
  for (std::size_t i = 0; i < scene.cut.vertices.size(); ++i)
    scalars->SetValue(static_cast<vtkIdType>(i), scale ? values[i] : scene.cut.strip_of_vertex[i]);
  data_of(cut).GetPointData()->SetScalars(scalars);
  vtkMapper& mapper = *cut.GetMapper();
  mapper.InterpolateScalarsBeforeMappingOn();
  mapper.SetLookupTable(scale ? table_of(*scale) : strip_table(static_cast<int>(scene.strip_names.size())));
  mapper.UseLookupTableScalarRangeOn();
}

vtkActor& add_lines(vtkRenderer& renderer, const std::vector<Polyline>& lines, const Rgb& color, double width,
                    double depth) {
  vtkNew<vtkPolyData> data;
  set_lines(*data, lines);
  const auto actor = line_data_actor(*data, color, width, depth);
  renderer.AddActor(actor);
  return *actor;
}

void set_actor_lines(vtkActor& actor, const std::vector<Polyline>& lines) {
  vtkNew<vtkPolyData> data;
  set_lines(*data, lines);
  vtkPolyDataMapper::SafeDownCast(actor.GetMapper())->SetInputData(data);
}

vtkActor& add_clamps(vtkRenderer& renderer, const std::vector<Pose>& clamps, double size_mm,
                     const Rgb& color) {
  vtkNew<vtkPolyDataMapper> mapper;
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  set_actor_clamps(*actor, clamps, size_mm);
  actor->GetProperty()->SetColor(color[0], color[1], color[2]);
  actor->GetProperty()->SetAmbient(0.3);
  actor->GetProperty()->SetInterpolationToFlat();
  renderer.AddActor(actor);
  return *actor;
}

void set_actor_clamps(vtkActor& actor, const std::vector<Pose>& clamps, double size_mm) {
  std::vector<Eigen::Vector3d> corners;
  Triangles triangles;
  for (const Pose& clamp : clamps) append_block(clamp, size_mm, corners, triangles);
  vtkNew<vtkPolyData> blocks;
  set_mesh(*blocks, corners, triangles);
  vtkPolyDataMapper::SafeDownCast(actor.GetMapper())->SetInputData(blocks);
}

namespace {

Rgb color_of(CellPartKind kind) {
  switch (kind) {
    case CellPartKind::kFirstArm:
      return kFirstArmColor;
    case CellPartKind::kSecondArm:
      return kSecondArmColor;
    case CellPartKind::kTool:
      return kToolColor;
    case CellPartKind::kStanding:
      break;
  }
  return kStandingColor;
}

// Machines are lit, so that their shape is seen.
vtkActor& add_cell_part(vtkRenderer& renderer, const CellPart& part) {
  vtkNew<vtkPolyData> mesh;
  set_mesh(*mesh, part.vertices, part.triangles);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(mesh);
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  const Rgb color = part.margin_rad ? margin_color(*part.margin_rad) : color_of(part.kind);
  vtkProperty& property = *actor->GetProperty();
  property.SetColor(color[0], color[1], color[2]);
  property.SetAmbient(0.35);
  property.SetDiffuse(0.7);
  property.SetInterpolationToFlat();
  renderer.AddActor(actor);
  return *actor;
}

}  // namespace

Rgb margin_color(double margin_rad) {
  constexpr Rgb kAtLimit{0.80, 0.10, 0.10}, kBetween{0.93, 0.72, 0.20}, kFar{0.25, 0.60, 0.35};
  const double share = std::clamp(margin_rad / kGreenMargin_rad, 0.0, 1.0);
  const bool low = share < 0.5;
  const double along = low ? 2 * share : 2 * share - 1;
  const Rgb &from = low ? kAtLimit : kBetween, &to = low ? kBetween : kFar;
  Rgb color{};
  for (std::size_t i = 0; i < color.size(); ++i) color[i] = from[i] + along * (to[i] - from[i]);
  return color;
}

void set_cell_places(const SceneActors& actors, const std::vector<CellPlace>& places) {
  for (std::size_t i = 0; i < actors.cell.size() && i < places.size(); ++i) {
    vtkNew<vtkMatrix4x4> matrix;
    const Eigen::Matrix4d place = places[i].at.matrix();
    for (int row = 0; row < 4; ++row) {
      for (int column = 0; column < 4; ++column) matrix->SetElement(row, column, place(row, column));
    }
    actors.cell[i]->SetUserMatrix(matrix);
    if (!places[i].margin_rad) continue;
    const Rgb color = margin_color(*places[i].margin_rad);
    actors.cell[i]->GetProperty()->SetColor(color[0], color[1], color[2]);
  }
}

SceneMeshes::SceneMeshes(const Scene& scene) {
  auto parts = std::make_unique<Parts>();
  if (!scene.design.triangles().empty()) {
    vtkNew<vtkPolyData> mesh;
    set_mesh(*mesh, scene.design.vertices(), scene.design.triangles());
    parts->design = with_normals(*mesh);
    vtkNew<vtkFeatureEdges> edges;
    edges->SetInputData(mesh);
    edges->BoundaryEdgesOn();
    edges->FeatureEdgesOff();
    edges->NonManifoldEdgesOff();
    edges->ManifoldEdgesOff();
    edges->ColoringOff();
    edges->Update();
    parts->borders = edges->GetOutput();
  }
  if (!scene.cut.triangles.empty()) {
    vtkNew<vtkPolyData> mesh;
    set_mesh(*mesh, scene.cut.vertices, scene.cut.triangles);
    parts->cut = with_normals(*mesh);
  }
  parts_ = std::move(parts);
}

SceneMeshes::~SceneMeshes() = default;

SceneActors add_actors(const Scene& scene, vtkRenderer& renderer, double zoom) {
  return add_actors(scene, SceneMeshes(scene), renderer, zoom);
}

SceneActors add_actors(const Scene& scene, const SceneMeshes& meshes, vtkRenderer& renderer, double zoom) {
  const Depth depth(scene);
  SceneActors actors;
  actors.line_depth = depth.before();
  add_design(scene, meshes, renderer, zoom, depth, actors);
  if (meshes.parts().cut) {
    const auto cut = surface_actor(*meshes.parts().cut, 0);
    actors.cut = cut;
    color_cut(*actors.cut, scene, scene.cut.values, scene.scale);
    renderer.AddActor(actors.cut);
  }
  const auto lines = [&](const std::vector<Polyline>& places, const Rgb& color, double width, double before) {
    return places.empty() ? nullptr : &add_lines(renderer, places, color, width * zoom, before);
  };
  actors.blocks = lines(block_edges(scene.blocks), kStockColor, 1.2, 0);
  actors.ribs = lines(scene.ribs, kRibColor, 0.9, depth.before());
  actors.blades = lines(scene.blades, kBladeColor, 1.4, depth.before());
  if (scene.blade_now) actors.blade_now = lines({*scene.blade_now}, kBladeNowColor, 3, depth.before());
  if (scene.worst)
    actors.worst = lines(rings_about(scene.worst->at, depth.ring_mm()), kWorstColor, 2.5, Depth::foremost());
  const auto clamps = [&](const std::vector<Pose>& places, const Rgb& color) {
    return places.empty() ? nullptr : &add_clamps(renderer, places, scene.clamp_size_mm, color);
  };
  std::vector<CellPlace> places;
  for (const CellPart& part : scene.cell) {
    actors.cell.push_back(&add_cell_part(renderer, part));
    places.push_back({part.place, part.margin_rad});
  }
  set_cell_places(actors, places);
  actors.clamps_a = clamps(scene.clamps_a, kClampAColor);
  actors.clamps_b = clamps(scene.clamps_b, kClampBColor);
  return actors;
}

}  // namespace hotblade::pipeline::preview

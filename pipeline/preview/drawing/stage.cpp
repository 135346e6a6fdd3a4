#include "pipeline/preview/drawing/stage.hpp"

#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkImageData.h>
#include <vtkMapper.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkPlane.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkRenderer.h>

#include <algorithm>

#include "pipeline/preview/drawing/geometry.hpp"

namespace hotblade::pipeline::preview {
namespace {

// Lines of what is selected: a strip's block and ribs, a rib, or the blade of a pose.
std::vector<Polyline> selected_lines(const ViewModel& model, const Selection& selection) {
  if (selection.part == Part::kNone) return {};
  const Strip& strip = model.program.strips[static_cast<std::size_t>(selection.strip)];
  const auto index = static_cast<std::size_t>(selection.index);
  if (selection.part == Part::kRib) return {line_of(strip.ribs[index].frame, strip.ribs[index].elastica)};
  if (selection.part == Part::kPose) return {line_of(strip.poses[index].frame, strip.poses[index].blade)};
  std::vector<Polyline> lines = block_edges({strip.block});
  if (strip.ribs.empty()) return lines;
  for (const Rib* rib : {&strip.ribs.front(), &strip.ribs.back()})
    lines.push_back(line_of(rib->frame, rib->elastica));
  return lines;
}

}  // namespace

struct Stage::Parts {
  Parts(const ViewModel& m, vtkRenderer& r, PictureSize s, double z)
      : model(m),
        renderer(r),
        size(s),
        zoom(z),
        sheets(r),
        legend(sheets, 1),
        card(sheets, 1),
        time(sheets, 1),
        help(sheets, 1) {
    renderer.SetBackground(kBackground[0], kBackground[1], kBackground[2]);
    actors = add_actors(model.scene, renderer, zoom);
    ghosts.blades = model.scene.blades;
    const double depth = actors.line_depth, clamp_mm = model.scene.clamp_size_mm;
    paths = &add_lines(renderer, model.air_paths, kPathColor, 1.2 * zoom, depth);
    selected = &add_lines(renderer, {}, kSelectedColor, 3 * zoom, depth);
    blade = &add_lines(renderer, {}, kBladeNowColor, 3.2 * zoom, depth);
    clamp_a = &add_clamps(renderer, {}, clamp_mm, kClampAColor);
    clamp_b = &add_clamps(renderer, {}, clamp_mm, kClampBColor);
    if (actors.cut) whole_cut->ShallowCopy(cut_data().GetPolys());
  }

  [[nodiscard]] vtkPolyData& cut_data() const {
    return *vtkPolyDataMapper::SafeDownCast(actors.cut->GetMapper())->GetInput();
  }
  [[nodiscard]] bool has_program() const { return !model.program.strips.empty(); }

  void set_layers(const ViewState& state);
  void set_ghosts(const ViewState& state);
  void set_blade(const ViewState& state);
  void set_cut(const ViewState& state);
  void set_clip(const ClipPlane& clip);
  void set_legend(const ViewState& state);
  void set_color(Color color);
  void draw_texts(const ViewState& state, const ViewState* before);

  const ViewModel& model;
  vtkRenderer& renderer;
  PictureSize size;
  double zoom;
  SceneActors actors;
  // Owned by the renderer.
  vtkActor *paths = nullptr, *selected = nullptr, *blade = nullptr, *clamp_a = nullptr, *clamp_b = nullptr;
  vtkNew<vtkCellArray> whole_cut;
  Ghosts ghosts;
  std::size_t triangles_shown = static_cast<std::size_t>(-1);
  Moment moment{-1, -1};
  Sheets sheets;
  Canvas legend, card, time, help;
  double card_top = 0;
  std::optional<ViewState> shown;
  bool resized = false;
};

void Stage::Parts::set_layers(const ViewState& state) {
  const auto set = [](vtkActor* actor, bool visible) {
    if (actor) actor->SetVisibility(visible);
  };
  set(actors.design, state.shows(Layer::kDesign));
  set(actors.borders, state.shows(Layer::kDesign));
  set(actors.cut, state.shows(Layer::kCut));
  set(actors.blocks, state.shows(Layer::kBlocks));
  set(actors.ribs, state.shows(Layer::kRibs));
  for (const auto& actor : {actors.blades, actors.clamps_a, actors.clamps_b})
    set(actor, state.shows(Layer::kGhosts));
  for (const auto& actor : {blade, clamp_a, clamp_b}) set(actor, has_program() && state.shows(Layer::kBlade));
  set(paths, state.shows(Layer::kPaths));
  for (vtkActor* part : actors.cell) set(part, state.shows(Layer::kArms));
}

void Stage::Parts::set_ghosts(const ViewState& state) {
  if (!has_program()) return;
  ghosts = ghosts_of(model.scene.cut, model.program, state.ghost_step_mm);
  if (actors.blades) set_actor_lines(*actors.blades, ghosts.blades);
  if (actors.clamps_a) set_actor_clamps(*actors.clamps_a, ghosts.clamps_a, model.scene.clamp_size_mm);
  if (actors.clamps_b) set_actor_clamps(*actors.clamps_b, ghosts.clamps_b, model.scene.clamp_size_mm);
}

void Stage::Parts::set_blade(const ViewState& state) {
  if (!has_program()) return;
  const Moment now = moment_at(model.facts, state.time_s);
  if (now.strip == moment.strip && now.pose == moment.pose) return;
  moment = now;
  const BladePose& pose = pose_at(model, now);
  set_actor_lines(*blade, {line_of(pose.frame, pose.blade)});
  set_actor_clamps(*clamp_a, {pose.a}, 1.3 * model.scene.clamp_size_mm);
  set_actor_clamps(*clamp_b, {pose.b}, 1.3 * model.scene.clamp_size_mm);
  if (model.cell != nullptr)
    set_cell_places(actors,
                    cell_places(*model.cell, model.program.strips[static_cast<std::size_t>(now.strip)],
                                static_cast<std::size_t>(now.pose)));
}

// The triangles lie in the order of their times, so those done are the first ones.
void Stage::Parts::set_cut(const ViewState& state) {
  if (!actors.cut) return;
  const std::size_t count = shown_triangles(model, state);
  if (count == triangles_shown) return;
  triangles_shown = count;
  if (count == model.scene.cut.triangles.size()) {
    whole_cut->Modified();  // or the mapper takes it for what it drew first
    cut_data().SetPolys(whole_cut);
    return;
  }
  vtkNew<vtkCellArray> cells;
  cells->AllocateExact(static_cast<vtkIdType>(count), static_cast<vtkIdType>(3 * count));
  for (std::size_t i = 0; i < count; ++i) {
    const auto& [a, b, c] = model.scene.cut.triangles[i];
    const vtkIdType ids[3] = {a, b, c};
    cells->InsertNextCell(3, ids);
  }
  cut_data().SetPolys(cells);
}

void Stage::Parts::set_clip(const ClipPlane& clip) {
  vtkNew<vtkPlane> plane;
  if (clip.axis >= 0) {
    double origin[3] = {0, 0, 0}, normal[3] = {0, 0, 0};
    origin[clip.axis] = clip_offset_mm(model, clip);
    normal[clip.axis] = clip.keeps_low ? -1 : 1;
    plane->SetOrigin(origin);
    plane->SetNormal(normal);
  }
  for (const auto& actor : {actors.design, actors.borders, actors.cut, actors.ribs, actors.blocks}) {
    if (!actor) continue;
    actor->GetMapper()->RemoveAllClippingPlanes();
    if (clip.axis >= 0) actor->GetMapper()->AddClippingPlane(plane);
  }
}

void Stage::Parts::set_color(Color color) {
  const auto found = model.colorings.find(color);
  if (!actors.cut || found == model.colorings.end()) return;
  color_cut(*actors.cut, model.scene, found->second.values, found->second.scale);
}

void Stage::Parts::set_legend(const ViewState& state) {
  legend.set_pixels(overlay_scale(size) * zoom);
  card_top = size.height / overlay_scale(size) - 16;
  if (state.shows(Layer::kLegend)) {
    Overlay overlay = overlay_of(model.scene);
    const auto found = model.colorings.find(state.color);
    overlay.scale = found == model.colorings.end() ? std::nullopt : found->second.scale;
    for (KeyLine& key : overlay.keys) {
      if (key.layer == Layer::kGhosts && key.color == kBladeColor) key.words = ghosts.note;
    }
    if (has_program()) {
      overlay.keys.insert(overlay.keys.begin(), {kBladeNowColor, "blade now", 4, Layer::kBlade});
      overlay.keys.push_back({kPathColor, "clamps' way in air", 3, Layer::kPaths});
    }
    std::erase_if(overlay.keys, [&](const KeyLine& key) { return !state.shows(key.layer); });
    card_top = draw_overlay(legend, overlay, size) - 4;
  }
  legend.finish();
}

void Stage::Parts::draw_texts(const ViewState& state, const ViewState* before) {
  const bool anew = !before || resized;
  const double pixels = overlay_scale(size) * zoom;
  const bool legend_changed = anew || before->color != state.color || before->hidden != state.hidden ||
                              before->ghost_step_mm != state.ghost_step_mm;
  if (legend_changed) set_legend(state);
  if (anew || legend_changed || before->selection != state.selection) {
    card.set_pixels(pixels);
    draw_card(card, card_of(model, state.selection), card_top);
    card.finish();
  }
  if (anew || before->time_s != state.time_s || before->playing != state.playing ||
      before->speed != state.speed) {
    time.set_pixels(pixels);
    draw_time_bar(time, model, state, size);
    time.finish();
  }
  if (anew || before->help != state.help) {
    help.set_pixels(pixels);
    if (state.help) draw_help(help, size);
    help.finish();
  }
}

Stage::Stage(const ViewModel& model, vtkRenderer& renderer, PictureSize size, double zoom)
    : parts_(std::make_unique<Parts>(model, renderer, size, zoom)) {}

Stage::~Stage() = default;

void Stage::show(const ViewState& state) {
  Parts& parts = *parts_;
  const ViewState* before = parts.shown ? &*parts.shown : nullptr;
  if (!before || before->color != state.color) parts.set_color(state.color);
  if (!before || before->ghost_step_mm != state.ghost_step_mm) parts.set_ghosts(state);
  if (!before || before->hidden != state.hidden) parts.set_layers(state);
  if (!before || before->clip != state.clip) parts.set_clip(state.clip);
  if (!before || before->selection != state.selection)
    set_actor_lines(*parts.selected, selected_lines(parts.model, state.selection));
  parts.set_blade(state);
  parts.set_cut(state);
  parts.draw_texts(state, before);
  if (!before || before->aims != state.aims)
    aim_camera(parts.model.scene, parts.renderer, parts.size, state.view, parts.has_program());
  parts.renderer.ResetCameraClippingRange();
  parts.shown = state;
  parts.resized = false;
}

void Stage::resize(PictureSize size) {
  parts_->size = size;
  parts_->resized = true;
}

PictureSize Stage::size() const {
  return parts_->size;
}

Picked Stage::pick_at(const ViewState& state, double x, double y) const {
  const Parts& parts = *parts_;
  Sight sight;
  sight.size = parts.size;
  const vtkMatrix4x4* seen = parts.renderer.GetActiveCamera()->GetCompositeProjectionTransformMatrix(
      static_cast<double>(parts.size.width) / parts.size.height, -1, 1);
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) sight.to_view(row, column) = seen->GetElement(row, column);
  }
  return pick(parts.model, state, parts.ghosts.blades, parts.ghosts.pose_of_blade, sight, {x, y});
}

std::string png_of(const ViewModel& model, const ViewState& state, PictureSize size) {
  Painter painter(size);
  Stage stage(model, painter.renderer(), size, Painter::kZoom);
  stage.show(state);
  vtkNew<vtkImageData> image;
  painter.paint(*image);
  return encoded(*image);
}

}  // namespace hotblade::pipeline::preview

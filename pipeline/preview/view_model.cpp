#include "pipeline/preview/view_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace hotblade::pipeline::preview {
namespace {

ViewFacts facts_of(const Program& program) {
  ViewFacts facts;
  double start = 0;
  for (const Strip& strip : program.strips) {
    facts.strip_start_s.push_back(start);
    facts.first_pose.push_back(static_cast<int>(facts.pose_s.size()));
    for (const BladePose& pose : strip.poses) facts.pose_s.push_back(start + pose.t - strip.poses.front().t);
    start = facts.pose_s.back();
  }
  facts.strip_start_s.push_back(start);
  facts.first_pose.push_back(static_cast<int>(facts.pose_s.size()));
  return facts;
}

// A triangle is done with the later of its rows.
std::vector<double> triangle_times(const ViewModel& model) {
  const CutSurface& cut = model.scene.cut;
  std::vector<double> times;
  times.reserve(cut.triangles.size());
  for (const auto& triangle : cut.triangles) {
    int latest = 0;
    for (const int vertex : triangle)
      latest = std::max(latest, cut.pose_of_vertex[static_cast<std::size_t>(vertex)]);
    const int strip = cut.strip_of_vertex[static_cast<std::size_t>(triangle[0])];
    times.push_back(time_of(model, {strip, latest}));
  }
  return times;
}

// Clamps stand still or move along lines in air, so a point every few millimetres shows their way.
void add_air_path(const Strip& strip, const PoseRow BladePose::*clamp, std::vector<Polyline>& paths) {
  constexpr double kStepMm = 2;
  Polyline path;
  const auto finish = [&] {
    if (path.points.size() > 1) paths.push_back(path);
    path.points.clear();
  };
  for (std::size_t i = 0; i < strip.poses.size(); ++i) {
    const BladePose& pose = strip.poses[i];
    const Eigen::Vector3d& place = (pose.*clamp).p;
    const bool last = i + 1 == strip.poses.size() || strip.poses[i + 1].foam;
    const bool moved = path.points.empty() || (place - path.points.back()).norm() >= kStepMm;
    if (!pose.foam && (moved || last)) path.points.push_back(place);
    if (pose.foam || last) finish();
  }
}

}  // namespace

ViewModel view_model(const Program& program, const surface::DesignSurface* design,
                     const SceneOptions& options) {
  ViewModel model;
  SceneOptions whole = options;
  whole.at_s.reset();
  if (options.at_s) (void)scene_of(program, nullptr, {Color::kStrip, options.strip, options.at_s, {}});
  model.scene = scene_of(program, design, whole);
  model.program = shown_part(program, whole);
  model.facts = facts_of(model.program);
  if (options.cell != nullptr) {
    model.cell = options.cell;
    const Strip& first = model.program.strips.front();
    show_cell(model.scene, *options.cell, first, 0);
  }
  for (const Color color :
       {Color::kDeviation, Color::kStrip, Color::kCurvature, Color::kMargin, Color::kFeed}) {
    if (color == Color::kDeviation && !design) continue;
    model.facts.colors.push_back(color);
    model.colorings[color] = coloring_of(color, model.program, model.scene.cut);
  }
  model.triangle_s = triangle_times(model);
  for (const Strip& strip : model.program.strips) {
    add_air_path(strip, &BladePose::a, model.air_paths);
    add_air_path(strip, &BladePose::b, model.air_paths);
  }
  return model;
}

ViewModel view_model(const surface::DesignSurface& design) {
  ViewModel model;
  model.scene = scene_of(design);
  return model;
}

ViewState first_state(const ViewModel& model, const SceneOptions& options, View view) {
  ViewState state;
  state.view = view;
  if (model.program.strips.empty()) return state;
  state.color = options.color.value_or(model.facts.colors.front());
  state.ghost_step_mm = options.ghost_step_mm;
  if (options.at_s) {
    state.time_s = *options.at_s - model.program.strips.front().poses.front().t;
    state.cut_so_far = true;
    state.hidden.set(static_cast<std::size_t>(Layer::kGhosts));
  }
  return state;
}

Moment moment_at(const ViewFacts& facts, double time_s) {
  if (facts.pose_s.empty()) throw std::logic_error("moment_at: no poses");
  const int strip = facts.strip_at(time_s);
  const auto place = [&](int i) {
    return facts.pose_s.begin() + facts.first_pose[static_cast<std::size_t>(i)];
  };
  const auto after = std::upper_bound(place(strip), place(strip + 1), time_s);
  return {strip, std::max(0, static_cast<int>(after - place(strip)) - 1)};
}

double time_of(const ViewModel& model, Moment moment) {
  const Strip& strip = model.program.strips[static_cast<std::size_t>(moment.strip)];
  return model.facts.strip_start_s[static_cast<std::size_t>(moment.strip)] + pose_at(model, moment).t -
         strip.poses.front().t;
}

const BladePose& pose_at(const ViewModel& model, Moment moment) {
  const Strip& strip = model.program.strips[static_cast<std::size_t>(moment.strip)];
  return strip.poses[static_cast<std::size_t>(moment.pose)];
}

std::string time_text(const ViewModel& model, const ViewState& state) {
  const Moment now = moment_at(model.facts, state.time_s);
  const Strip& strip = model.program.strips[static_cast<std::size_t>(now.strip)];
  const double start = model.facts.strip_start_s[static_cast<std::size_t>(now.strip)];
  const std::string speed =
      state.speed >= 1 ? fmt::format("{:g}", state.speed) : fmt::format("1/{:g}", 1 / state.speed);
  return fmt::format("{}   {:.2f} of {:.2f} s   {}{}   speed x {}", strip.id, state.time_s - start,
                     strip.poses.back().t - strip.poses.front().t, name(pose_at(model, now).phase),
                     pose_at(model, now).heat ? "" : ", cold", speed);
}

}  // namespace hotblade::pipeline::preview

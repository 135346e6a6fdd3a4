#include "pipeline/preview/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "pipeline/preview/cut_values.hpp"
#include "pipeline/preview/ghosts.hpp"
#include "pipeline/preview/picture_texts.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/verify/swept_surface.hpp"
#include "pipeline/verify/verdict.hpp"
#include "pipeline/verify/verify.hpp"

namespace hotblade::pipeline::preview {
namespace {

constexpr std::array<std::pair<Color, const char*>, 5> kColors{{{Color::kDeviation, "deviation"},
                                                                {Color::kStrip, "strip"},
                                                                {Color::kCurvature, "curvature"},
                                                                {Color::kMargin, "margin"},
                                                                {Color::kFeed, "feed"}}};

constexpr const char* kSliceable = "can be sliced";

std::vector<int> chosen_strips(const Program& program, const SceneOptions& options) {
  std::vector<int> chosen;
  for (std::size_t i = 0; i < program.strips.size(); ++i) {
    if (options.strip.empty() || program.strips[i].id == options.strip) chosen.push_back(static_cast<int>(i));
  }
  if (chosen.empty()) {
    throw Error(ErrorKind::kBadSettings, fmt::format("--strip: no such strip ({}, {} to {})", options.strip,
                                                     program.strips.front().id, program.strips.back().id));
  }
  if (options.at_s && chosen.size() > 1) {
    throw Error(
        ErrorKind::kBadSettings,
        fmt::format("--at: time runs from each strip's start ({} strips): give --strip", chosen.size()));
  }
  return chosen;
}

void add_blade_at(Scene& scene, const Strip& strip, double at_s, const CellShown* cell) {
  const double end = strip.poses.back().t;
  if (!(at_s >= strip.poses.front().t && at_s <= end)) {
    throw Error(ErrorKind::kBadSettings,
                fmt::format("--at: outside the strip ({} s, {} to {} s)", at_s, strip.poses.front().t, end));
  }
  const auto after = std::upper_bound(strip.poses.begin(), strip.poses.end(), at_s,
                                      [](double t, const BladePose& pose) { return t < pose.t; });
  const BladePose& pose = *(after - 1);
  scene.blade_now = line_of(pose.frame, pose.blade);
  scene.clamps_a.push_back(pose.a);
  scene.clamps_b.push_back(pose.b);
  scene.blade_note = fmt::format("blade at {:.2f} s, {}", pose.t, name(pose.phase));
  if (cell != nullptr)
    show_cell(scene, *cell, strip, static_cast<std::size_t>(after - strip.poses.begin()) - 1);
}

void add_strip(Scene& scene, const Strip& strip, const SceneOptions& options, double seen) {
  for (const Rib& rib : strip.ribs) scene.ribs.push_back(line_of(rib.frame, rib.elastica, seen));
  scene.blocks.push_back(strip.block);
  if (options.at_s) add_blade_at(scene, strip, *options.at_s, options.cell);
}

Eigen::Vector3d mean_direction(const std::vector<Eigen::Vector3d>& normals) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& normal : normals) sum += normal;
  return sum.norm() > 0 ? sum.normalized() : sum;
}

std::string duration_text(double seconds) {
  const long whole = std::lround(seconds);
  return whole < 60 ? fmt::format("{} s", whole) : fmt::format("{} min {} s", whole / 60, whole % 60);
}

std::optional<Eigen::Vector3d> middle_of_cut(const Strip& strip) {
  std::vector<const BladePose*> cut;
  for (const BladePose& pose : strip.poses) {
    if (pose.foam) cut.push_back(&pose);
  }
  if (cut.empty()) return std::nullopt;
  return middle_of(*cut[cut.size() / 2]);
}

void add_caption(Scene& scene, const Program& program, const std::vector<int>& strips, bool has_design) {
  const Verification& verified = program.verification;
  double seconds = 0;
  std::size_t ribs = 0;
  for (const int index : strips) {
    const Strip& strip = program.strips[static_cast<std::size_t>(index)];
    seconds += strip.poses.back().t - strip.poses.front().t;
    ribs += strip.ribs.size();
    scene.strip_names.push_back(text_of(PictureText::kStripBlade, strip.id, strip.blade_length_mm));
    if (const auto middle = middle_of_cut(strip); middle && strips.size() > 1)
      scene.strip_ids.push_back({*middle, strip.id});
  }
  scene.title = program.design.file;
  const Eigen::Vector3d size = program.design.bbox_mm[1] - program.design.bbox_mm[0];
  scene.caption.push_back(
      text_of(PictureText::kKept, size.x(), size.y(), size.z(), name(program.design.keep)));
  scene.caption.push_back(text_of(strips.size() == 1 ? PictureText::kOneStrip : PictureText::kStrips,
                                  strips.size(), ribs, duration_text(seconds)));
  scene.verdict = text_of(PictureText::kVerification, name(verified.status));
  const Verdict verdict = verdict_of(program);
  scene.verdict_color = verdict.color;
  if (verdict.color == VerdictColor::kAmber)
    scene.caption.push_back(text_of(PictureText::kAmber, needed_text(verdict)));
  scene.caption.push_back(
      text_of(PictureText::kLargestDeviation, verified.deviation_mm.max, verified.deviation_mm.p99));
  scene.caption.push_back(fmt::format("tolerance {:g} mm", verified.tolerance_mm));
  if (verified.uncut_mm2 > 0) scene.caption.push_back(text_of(PictureText::kUncut, verified.uncut_mm2));
  for (const std::string& override : program.overrides)
    scene.caption.push_back(text_of(PictureText::kOverride, override));
  if (!has_design) scene.caption.push_back("no design at hand: deviation is not shown");
  for (const int index : strips) {
    const Strip& strip = program.strips[static_cast<std::size_t>(index)];
    if (scene.cell.empty() || !strip.arms) continue;
    const StripArms::Nearest& joint = strip.arms->joint_margin_rad;
    scene.caption.push_back(fmt::format("joints {:.0f} deg or more from limits ({} J{})",
                                        joint.value / robot::kDegree_rad, joint.arm, joint.joint));
    const bool by_margin = std::any_of(scene.cell.begin(), scene.cell.end(),
                                       [](const CellPart& part) { return part.margin_rad.has_value(); });
    if (by_margin)
      scene.caption.push_back(
          fmt::format("links: red at a limit, green {:.0f} deg off", kGreenMargin_rad / robot::kDegree_rad));
  }
}

// Measures the cut of these strips against the design. What lies past its border, in the waste, or past a
// crease, in the strip's own block, is left out.
void measure(CutSurface& cut, const surface::DesignSurface& design, const Program& part) {
  const double near_mm = VerifyOptions{}.reach * part.verification.tolerance_mm;
  cut.deviation_mm = signed_deviation_mm(design.mesh, part, cut.vertices, cut.strip_of_vertex, near_mm);
  std::erase_if(cut.triangles, [&](const std::array<int, 3>& triangle) {
    return std::any_of(triangle.begin(), triangle.end(), [&](int vertex) {
      return std::isnan(cut.deviation_mm[static_cast<std::size_t>(vertex)]);
    });
  });
  // Of vertices that no triangle has.
  for (double& value : cut.deviation_mm) value = std::isnan(value) ? 0 : value;
}

}  // namespace

void show_cell(Scene& scene, const CellShown& cell, const Strip& strip, std::size_t pose) {
  scene.cell = cell_parts(cell, strip, pose);
  scene.view_axes = strip.design_to_cell.q.toRotationMatrix().transpose();
}

std::optional<Color> color_named(const std::string& name) {
  for (const auto& [color, one] : kColors) {
    if (one == name) return color;
  }
  return std::nullopt;
}

Program shown_part(const Program& program, const SceneOptions& options) {
  Program part;
  part.design = program.design;
  part.settings = program.settings;
  part.blade = program.blade;
  part.cell = program.cell;
  part.verification = program.verification;
  for (const int index : chosen_strips(program, options)) {
    Strip& strip = part.strips.emplace_back(program.strips[static_cast<std::size_t>(index)]);
    if (options.at_s) {
      std::erase_if(strip.poses, [&](const BladePose& pose) { return pose.t > *options.at_s; });
      if (!strip.joints.empty()) strip.joints.resize(strip.poses.size());  // the last ones are gone
    }
  }
  return part;
}

Scene scene_of(const Program& program, const surface::DesignSurface* design, const SceneOptions& options) {
  const Color color = options.color.value_or(design ? Color::kDeviation : Color::kStrip);
  if (color == Color::kDeviation && !design) {
    throw Error(ErrorKind::kBadSettings,
                "--color deviation: no design at hand to measure against: give --design");
  }
  const std::vector<int> strips = chosen_strips(program, options);
  Scene scene;
  const double seen = seen_mm(program);
  for (const int index : strips)
    add_strip(scene, program.strips[static_cast<std::size_t>(index)], options, seen);
  // A whole program of hundreds of strips is not copied.
  const bool whole = !options.at_s && strips.size() == program.strips.size();
  const Program chosen = whole ? Program{} : shown_part(program, options);
  const Program& part = whole ? program : chosen;
  SweptSurface swept = swept_surface(part, seen);
  scene.waste_direction = mean_direction(swept.normals);
  scene.cut = {std::move(swept.vertices),
               std::move(swept.triangles),
               std::move(swept.strip_of_vertex),
               std::move(swept.pose_of_vertex),
               std::move(swept.curvature_per_mm),
               {},
               {}};
  if (design) measure(scene.cut, *design, part);
  Coloring coloring = coloring_of(color, part, scene.cut);
  scene.scale = std::move(coloring.scale);
  scene.cut.values = std::move(coloring.values);
  // To be seen: twice the blade's width, and no less than a hundredth of a large part.
  const double diagonal = (program.design.bbox_mm[1] - program.design.bbox_mm[0]).norm();
  scene.clamp_size_mm = std::max(2 * program.blade.width_mm, diagonal / 110);
  if (design) scene.design = design->mesh;
  add_caption(scene, program, strips, design != nullptr);
  const Verification& verified = program.verification;
  if (verified.status == VerificationStatus::kRefused && verified.deviation_mm.max > 0)
    scene.worst = Mark{verified.deviation_mm.at, "largest deviation"};
  if (!options.at_s) {
    const Ghosts ghosts = ghosts_of(scene.cut, part, options.ghost_step_mm);
    scene.blades = ghosts.blades;
    scene.clamps_a = ghosts.clamps_a;
    scene.clamps_b = ghosts.clamps_b;
    scene.blade_note = ghosts.note;
    if (ghosts.left_out) {
      scene.caption.push_back(text_of(PictureText::kBladesLeftOut));
    }
  }
  return scene;
}

Scene scene_of(const surface::DesignSurface& design) {
  Scene scene;
  scene.design = design.mesh;
  scene.title = design.file_name;
  const surface::Health& health = design.health;
  const Eigen::Vector3d size = health.bbox_mm[1] - health.bbox_mm[0];
  scene.caption.push_back(text_of(PictureText::kReadAs, size.x(), size.y(), size.z(), design.units));
  scene.caption.push_back(text_of(PictureText::kVertices, health.vertices, health.triangles));
  scene.caption.push_back(
      text_of(health.components == 1 ? PictureText::kOnePiece : PictureText::kPieces, health.components));
  scene.caption.push_back(health.blockers.empty() ? kSliceable
                                                  : "cannot be sliced: " + health.blockers.front());
  return scene;
}

std::vector<Polyline> block_edges(const std::vector<Block>& blocks) {
  std::vector<Polyline> edges;
  for (const Block& block : blocks) {
    const std::array<Eigen::Vector3d, 8> corners = block.corners();
    for (std::size_t i = 0; i < corners.size(); ++i) {
      for (const std::size_t axis : {1u, 2u, 4u}) {
        if (!(i & axis)) edges.push_back({{corners[i], corners[i | axis]}});
      }
    }
  }
  return edges;
}

void mark_refusal(Scene& scene, const std::vector<RefusedReason>& reasons) {
  if (scene.cut.triangles.empty()) {
    scene.verdict = "nothing is cut";
    scene.verdict_color = VerdictColor::kRed;
    std::erase(scene.caption, kSliceable);
  }
  if (reasons.empty()) return;
  const std::string& first = reasons.front().message;
  scene.caption.push_back(reasons.size() > 1
                              ? text_of(PictureText::kRefusedAndMore, first, reasons.size() - 1)
                              : text_of(PictureText::kRefused, first));
  const auto placed = std::find_if(reasons.begin(), reasons.end(),
                                   [](const RefusedReason& reason) { return reason.at.has_value(); });
  if (placed == reasons.end()) return;
  scene.worst = Mark{*placed->at, "what stands in the way"};
  if (placed != reasons.begin()) scene.caption.push_back(text_of(PictureText::kRinged, placed->message));
}

}  // namespace hotblade::pipeline::preview

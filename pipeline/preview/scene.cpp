#include "pipeline/preview/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "pipeline/command_error.hpp"
#include "pipeline/preview/cut_grid.hpp"

namespace hotblade::pipeline::preview {
namespace {

constexpr std::array<std::pair<Color, const char*>, 5> kColors{{{Color::kDeviation, "deviation"},
                                                                {Color::kStrip, "strip"},
                                                                {Color::kCurvature, "curvature"},
                                                                {Color::kMargin, "margin"},
                                                                {Color::kFeed, "feed"}}};
// Ghosts of the blade a strip: enough to read the motion, few enough to see the surface between them.
constexpr int kGhosts = 8;
constexpr int kLinePoints = 161;  // a blade of 1500 mm in steps under 10 mm

std::vector<int> chosen_strips(const Program& program, const SceneOptions& options) {
  std::vector<int> chosen;
  for (std::size_t i = 0; i < program.strips.size(); ++i) {
    if (options.strip.empty() || program.strips[i].id == options.strip) chosen.push_back(static_cast<int>(i));
  }
  if (chosen.empty()) {
    throw CommandError(Exit::kUsage, fmt::format("--strip: no such strip ({}, {} to {})", options.strip,
                                                 program.strips.front().id, program.strips.back().id));
  }
  if (options.at_s && chosen.size() > 1) {
    throw CommandError(
        Exit::kUsage,
        fmt::format("--at: time runs from each strip's start ({} strips): give --strip", chosen.size()));
  }
  return chosen;
}

Polyline line_of(const Frame& frame, const elastica::Elastica& curve) {
  Polyline line;
  for (const auto& point : elastica::sample(curve, kLinePoints))
    line.points.push_back(frame.point(point.x, point.y));
  return line;
}

// The blade from either clamp to the foam: within the foam the cut surface shows where it was.
void add_ghost(Scene& scene, const BladePose& pose) {
  const auto [s0, s1] = *pose.foam;
  scene.blades.push_back(line_of(pose.frame, elastica::segment(pose.blade, 0, s0)));
  scene.blades.push_back(line_of(pose.frame, elastica::segment(pose.blade, s1, pose.blade.length)));
  scene.clamps_a.push_back(pose.a);
  scene.clamps_b.push_back(pose.b);
}

void add_blade_at(Scene& scene, const Strip& strip, double at_s) {
  const double end = strip.poses.back().t;
  if (!(at_s >= strip.poses.front().t && at_s <= end)) {
    throw CommandError(Exit::kUsage, fmt::format("--at: outside the strip ({} s, {} to {} s)", at_s,
                                                 strip.poses.front().t, end));
  }
  const auto after = std::upper_bound(strip.poses.begin(), strip.poses.end(), at_s,
                                      [](double t, const BladePose& pose) { return t < pose.t; });
  const BladePose& pose = *(after - 1);
  scene.blade_now = line_of(pose.frame, pose.blade);
  scene.clamps_a.push_back(pose.a);
  scene.clamps_b.push_back(pose.b);
  scene.blade_note = fmt::format("blade at {:.2f} s, {}", pose.t, pose.phase);
}

// Ghosts at even steps of the blade's middle through the foam, the first and the last pose in it included.
void add_ghosts(Scene& scene, const Strip& strip) {
  std::vector<const BladePose*> cutting;
  std::vector<double> way{0};
  for (const BladePose& pose : strip.poses) {
    if (!pose.foam) continue;
    if (!cutting.empty())
      way.push_back(way.back() +
                    (pose.a.p + pose.b.p - cutting.back()->a.p - cutting.back()->b.p).norm() / 2);
    cutting.push_back(&pose);
  }
  if (cutting.empty()) return;
  for (int ghost = 0; ghost < kGhosts; ++ghost) {
    const double goal = way.back() * ghost / (kGhosts - 1);
    const auto found = std::lower_bound(way.begin(), way.end(), goal) - way.begin();
    const BladePose& pose = *cutting[std::min(static_cast<std::size_t>(found), cutting.size() - 1)];
    add_ghost(scene, pose);
  }
  scene.blade_note = fmt::format("blade every {:.0f} mm", way.back() / (kGhosts - 1));
}

void add_strip(Scene& scene, const Strip& strip, const SceneOptions& options) {
  for (const Rib& rib : strip.ribs) scene.ribs.push_back(line_of(rib.frame, rib.elastica));
  scene.stocks.push_back(strip.stock);
  if (options.at_s) {
    add_blade_at(scene, strip, *options.at_s);
  } else {
    add_ghosts(scene, strip);
  }
}

// A round number at or above x: 1, 1.5, 2, 3, 5 or 7.5 times a power of ten.
double round_up(double x) {
  if (!(x > 0)) return 1;
  const double decade = std::pow(10, std::floor(std::log10(x)));
  for (const double step : {1.0, 1.5, 2.0, 3.0, 5.0, 7.5}) {
    if (step * decade >= x * (1 - 1e-9)) return step * decade;
  }
  return 10 * decade;
}

ColorScale deviation_scale(const std::vector<double>& values, double tolerance_mm) {
  double most = 0;
  for (const double value : values) most = std::max(most, std::abs(value));
  // Beyond five tolerances all is equally wrong, and a wider scale would hide what is nearly right.
  const double range = round_up(std::clamp(most, 1.5 * tolerance_mm, 5 * tolerance_mm));
  return {"deviation, mm", -range, range, tolerance_mm};
}

ColorScale sequential_scale(const std::string& title, const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double top = *high > *low ? *high : *low + std::max(1e-3, std::abs(*low) * 1e-3);
  return {title, *low, top, std::nullopt};
}

void color_by(Scene& scene, Color color, CutGrid& grid, const Program& program,
              const surface::DesignSurface* design) {
  if (scene.cut.vertices.empty() || color == Color::kStrip) return;
  switch (color) {
    case Color::kDeviation:
      scene.cut.values = signed_deviation_mm(design->mesh, program.design.keep, scene.cut.vertices);
      scene.scale = deviation_scale(scene.cut.values, program.verification.tolerance_mm);
      return;
    case Color::kCurvature:
      scene.cut.values = std::move(grid.curvature_per_mm);
      scene.scale = sequential_scale("blade curvature, 1/mm", scene.cut.values);
      return;
    case Color::kMargin:
      scene.cut.values = std::move(grid.margin);
      scene.scale = sequential_scale("stability margin", scene.cut.values);
      return;
    case Color::kFeed:
      scene.cut.values = std::move(grid.feed_mm_s);
      scene.scale = sequential_scale("feed, mm/s", scene.cut.values);
      return;
    case Color::kStrip:
      return;
  }
}

Eigen::Vector3d mean_waste_direction(const CutSurface& cut, const std::string& keep) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const auto at = [&](int i) -> const Eigen::Vector3d& { return cut.vertices[static_cast<std::size_t>(i)]; };
  for (const auto& [a, b, c] : cut.triangles) sum += (at(b) - at(a)).cross(at(c) - at(a));
  if (sum.norm() == 0) return sum;
  sum.normalize();
  if (keep == "above") return sum.z() > 0 ? Eigen::Vector3d(-sum) : sum;
  return sum.z() < 0 ? Eigen::Vector3d(-sum) : sum;
}

std::string duration_text(double seconds) {
  const long whole = std::lround(seconds);
  return whole < 60 ? fmt::format("{} s", whole) : fmt::format("{} min {} s", whole / 60, whole % 60);
}

void add_caption(Scene& scene, const Program& program, const std::vector<int>& strips, bool has_design) {
  const Verification& verified = program.verification;
  double seconds = 0;
  std::size_t ribs = 0;
  for (const int index : strips) {
    const Strip& strip = program.strips[static_cast<std::size_t>(index)];
    seconds += strip.poses.back().t - strip.poses.front().t;
    ribs += strip.ribs.size();
    scene.strip_names.push_back(fmt::format("{}, blade {:g} mm", strip.id, strip.blade_length_mm));
  }
  scene.title = program.design.file;
  const Eigen::Vector3d size = program.design.bbox_mm[1] - program.design.bbox_mm[0];
  scene.caption.push_back(
      fmt::format("{:.0f} x {:.0f} x {:.0f} mm, {} kept", size.x(), size.y(), size.z(), program.design.keep));
  scene.caption.push_back(fmt::format("{} strip{}, {} ribs, {}", strips.size(), strips.size() == 1 ? "" : "s",
                                      ribs, duration_text(seconds)));
  scene.verdict = "verification " + verified.status;
  scene.verdict_good = verified.status == "passed";
  scene.caption.push_back(fmt::format("deviation max {:.2f}, p99 {:.2f} mm", verified.deviation_mm.max,
                                      verified.deviation_mm.p99));
  scene.caption.push_back(fmt::format("tolerance {:g} mm", verified.tolerance_mm));
  if (verified.uncut_mm2 > 0) scene.caption.push_back(fmt::format("uncut {:.0f} mm2", verified.uncut_mm2));
  for (const std::string& override : program.overrides) scene.caption.push_back("override: " + override);
  if (!scene.scale) {
    scene.caption.push_back(has_design ? "coloured by strip"
                                       : "coloured by strip: no design at hand to measure against");
  }
}

}  // namespace

std::string name_of(Color color) {
  for (const auto& [one, name] : kColors) {
    if (one == color) return name;
  }
  return "";
}

std::optional<Color> color_named(const std::string& name) {
  for (const auto& [color, one] : kColors) {
    if (one == name) return color;
  }
  return std::nullopt;
}

Scene scene_of(const Program& program, const surface::DesignSurface* design, const SceneOptions& options) {
  const Color color = options.color.value_or(design ? Color::kDeviation : Color::kStrip);
  if (color == Color::kDeviation && !design) {
    throw CommandError(Exit::kUsage,
                       "--color deviation: no design at hand to measure against: give --design");
  }
  const std::vector<int> strips = chosen_strips(program, options);
  Scene scene;
  for (const int index : strips) add_strip(scene, program.strips[static_cast<std::size_t>(index)], options);
  CutGrid grid = cut_grid(program, strips, options.at_s.value_or(std::numeric_limits<double>::infinity()));
  scene.cut = std::move(grid.surface);
  scene.clamp_size_mm = 2 * program.blade.width_mm;
  color_by(scene, color, grid, program, design);
  if (design) scene.design = design->mesh;
  scene.waste_direction = mean_waste_direction(scene.cut, program.design.keep);
  add_caption(scene, program, strips, design != nullptr);
  return scene;
}

Scene scene_of(const surface::DesignSurface& design) {
  Scene scene;
  scene.design = design.mesh;
  scene.title = design.file_name;
  const surface::Health& health = design.health;
  const Eigen::Vector3d size = health.bbox_mm[1] - health.bbox_mm[0];
  scene.caption.push_back(
      fmt::format("{:.0f} x {:.0f} x {:.0f} mm (read as {})", size.x(), size.y(), size.z(), design.units));
  scene.caption.push_back(fmt::format("{} vertices, {} triangles", health.vertices, health.triangles));
  scene.caption.push_back(fmt::format("{} piece{}", health.components, health.components == 1 ? "" : "s"));
  scene.caption.push_back(health.blockers.empty() ? "can be sliced"
                                                  : "cannot be sliced: " + health.blockers.front());
  return scene;
}

}  // namespace hotblade::pipeline::preview

#include "pipeline/report/viewer_scene.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

#include "pipeline/preview/colors.hpp"
#include "pipeline/preview/cut_values.hpp"
#include "pipeline/report/scene_packer.hpp"

namespace hotblade::pipeline {

namespace {

using Json = nlohmann::ordered_json;
using Numbers = std::vector<std::uint32_t>;
using Triangle = std::array<int, 3>;

// Vertices and triangles as they are drawn.
struct Shell {
  std::vector<Eigen::Vector3d> vertices, normals;
  std::vector<Triangle> triangles;
};

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

// Normals of the vertices, by the areas of their triangles; of a vertex without any, up.
std::vector<Eigen::Vector3d> normals_of(std::span<const Eigen::Vector3d> vertices,
                                        std::span<const Triangle> triangles) {
  std::vector<Eigen::Vector3d> normals(vertices.size(), Eigen::Vector3d::Zero());
  for (const auto& [a, b, c] : triangles) {
    const Eigen::Vector3d area = (vertices[at(b)] - vertices[at(a)]).cross(vertices[at(c)] - vertices[at(a)]);
    for (const int i : {a, b, c}) normals[at(i)] += area;
  }
  for (Eigen::Vector3d& n : normals) n = n.norm() > 0 ? n.normalized() : Eigen::Vector3d::UnitZ();
  return normals;
}

// The design by at most so many triangles: the vertices of one cell of a grid become its first one.
Shell design_shell(const surface::TriangleMesh& mesh, std::size_t most) {
  Shell shell{{mesh.vertices().begin(), mesh.vertices().end()},
              {},
              {mesh.triangles().begin(), mesh.triangles().end()}};
  shell.normals = normals_of(shell.vertices, shell.triangles);
  if (shell.triangles.size() <= most) return shell;
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles()) {
    area += 0.5 * (mesh.vertices()[at(b)] - mesh.vertices()[at(a)])
                      .cross(mesh.vertices()[at(c)] - mesh.vertices()[at(a)])
                      .norm();
  }
  // Two triangles a cell of the surface, were it flat and square to the grid.
  double cell_mm = std::sqrt(2 * area / static_cast<double>(most));
  Shell coarse;
  do {
    std::map<std::array<long, 3>, int> cells;
    std::vector<int> first(mesh.vertices().size());
    coarse = {};
    for (std::size_t i = 0; i < mesh.vertices().size(); ++i) {
      const Eigen::Vector3d cell = mesh.vertices()[i] / cell_mm;
      const std::array<long, 3> key{std::lround(cell.x()), std::lround(cell.y()), std::lround(cell.z())};
      const auto [place, fresh] = cells.try_emplace(key, static_cast<int>(coarse.vertices.size()));
      if (fresh) {
        coarse.vertices.push_back(shell.vertices[i]);
        coarse.normals.push_back(shell.normals[i]);
      }
      first[i] = place->second;
    }
    for (const auto& [a, b, c] : mesh.triangles()) {
      const Triangle t{first[at(a)], first[at(b)], first[at(c)]};
      if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) coarse.triangles.push_back(t);
    }
    cell_mm *= 1.25;
  } while (coarse.triangles.size() > most);
  return coarse;
}

// A row of the cut: the blade at one pose.
struct Row {
  int strip = 0, pose = 0;
  std::size_t first = 0, count = 0;  // vertices
};

std::vector<Row> rows_of(const preview::CutSurface& cut) {
  std::vector<Row> rows;
  for (std::size_t i = 0; i < cut.vertices.size(); ++i) {
    const int strip = cut.strip_of_vertex[i], pose = cut.pose_of_vertex[i];
    if (rows.empty() || rows.back().strip != strip || rows.back().pose != pose)
      rows.push_back({strip, pose, i, 0});
    ++rows.back().count;
  }
  return rows;
}

// Every `step` of `count`, and the last.
std::vector<std::size_t> every(std::size_t step, std::size_t count) {
  std::vector<std::size_t> list;
  for (std::size_t i = 0; i < count; i += step) list.push_back(i);
  if (list.back() + 1 != count) list.push_back(count - 1);
  return list;
}

// The cut as it is drawn: some of its rows, some points of each.
struct DrawnCut {
  std::vector<std::size_t> from;  // vertex of the scene's cut, for each that is drawn
  std::vector<Row> rows;          // of vertices that are drawn
  std::vector<std::size_t> done;  // triangles when the blade has come to a row
  std::vector<Triangle> triangles;
};

class Thinner {
 public:
  explicit Thinner(const preview::CutSurface& cut) : rows_(rows_of(cut)), used_(cut.vertices.size(), false) {
    for (const Triangle& t : cut.triangles) {
      for (const int i : t) used_[at(i)] = true;
    }
  }

  [[nodiscard]] DrawnCut thinned(std::size_t row_step, std::size_t column_step) const {
    DrawnCut out;
    for (std::size_t first = 0; first < rows_.size();) {
      std::size_t last = first;
      while (last < rows_.size() && rows_[last].strip == rows_[first].strip) ++last;
      add_strip(first, last, row_step, column_step, out);
      first = last;
    }
    return out;
  }

 private:
  // Rows [first, last) are a strip's.
  void add_strip(std::size_t first, std::size_t last, std::size_t row_step, std::size_t column_step,
                 DrawnCut& out) const {
    const std::vector<std::size_t> columns = every(column_step, rows_[first].count);
    bool begun = false;
    for (const std::size_t r : every(row_step, last - first)) {
      const Row& row = rows_[first + r];
      const std::size_t before = out.from.size() - (begun ? columns.size() : 0);
      out.rows.push_back({row.strip, row.pose, out.from.size(), columns.size()});
      for (const std::size_t c : columns) out.from.push_back(row.first + c);
      if (begun) {
        for (std::size_t c = 0; c + 1 < columns.size(); ++c) add_cell(before + c, columns.size(), out);
      }
      out.done.push_back(out.triangles.size());
      begun = true;
    }
  }

  // What was left out of the cut, beyond the design's border, stays out: a triangle is drawn where the cut
  // has its corners.
  void add_cell(std::size_t a, std::size_t columns, DrawnCut& out) const {
    const std::size_t b = a + 1, c = a + columns, d = c + 1;
    for (const auto& [p, q, r] : {std::array{a, b, d}, std::array{a, d, c}}) {
      if (used_[out.from[p]] && used_[out.from[q]] && used_[out.from[r]])
        out.triangles.push_back({static_cast<int>(p), static_cast<int>(q), static_cast<int>(r)});
    }
  }

  std::vector<Row> rows_;
  std::vector<bool> used_;
};

// The box that the positions' 65,535 steps divide.
struct Grid {
  Eigen::AlignedBox3d box;
  static constexpr double kSteps = 65535;

  [[nodiscard]] std::uint32_t step(const Eigen::Vector3d& p, int axis) const {
    const double size = box.sizes()[axis];
    return size > 0 ? static_cast<std::uint32_t>(
                          std::lround(std::clamp((p[axis] - box.min()[axis]) / size, 0.0, 1.0) * kSteps))
                    : 0;
  }
};

void add_places(ScenePacker& packer, const Grid& grid, const std::string& name,
                std::span<const Eigen::Vector3d> places) {
  for (int axis = 0; axis < 3; ++axis) {
    Numbers steps;
    steps.reserve(places.size());
    for (const Eigen::Vector3d& p : places) steps.push_back(grid.step(p, axis));
    packer.add(name + "_" + std::string(1, "xyz"[axis]), steps, 2, Follows::kBends);
  }
}

// Unit vectors on an octahedron's faces, unfolded into a square of 255 x 255 steps (Meyer et al. 2010, "On
// floating-point normal vectors").
void add_normals(ScenePacker& packer, const std::string& name, std::span<const Eigen::Vector3d> normals) {
  Numbers u, v;
  for (const Eigen::Vector3d& n : normals) {
    const double sum = n.cwiseAbs().sum();
    Eigen::Vector2d p = n.head<2>() / sum;
    if (n.z() < 0)
      p = {(1 - std::abs(p.y())) * (p.x() >= 0 ? 1 : -1), (1 - std::abs(p.x())) * (p.y() >= 0 ? 1 : -1)};
    u.push_back(static_cast<std::uint32_t>(std::lround((p.x() + 1) * 127.5)));
    v.push_back(static_cast<std::uint32_t>(std::lround((p.y() + 1) * 127.5)));
  }
  packer.add(name + "_u", u, 1, Follows::kSteps);
  packer.add(name + "_v", v, 1, Follows::kSteps);
}

void add_triangles(ScenePacker& packer, const std::string& name, std::span<const Triangle> triangles) {
  Numbers corners;
  corners.reserve(3 * triangles.size());
  for (const Triangle& t : triangles) {
    for (const int i : t) corners.push_back(static_cast<std::uint32_t>(i));
  }
  packer.add(name, corners, 4, Follows::kSteps);
}

// Adds the points from `first` on to `last` that a line needs to stay within `near_mm` of all of them
// (Douglas and Peucker 1973), `first` and `last` themselves aside.
void add_needed(std::span<const Eigen::Vector3d> line, std::size_t first, std::size_t last, double near_mm,
                std::vector<Eigen::Vector3d>& out) {
  const Eigen::Vector3d from = line[first], way = line[last] - from;
  const double squared = way.squaredNorm();
  double most = 0;
  std::size_t farthest = first;
  for (std::size_t i = first + 1; i < last; ++i) {
    const Eigen::Vector3d d = line[i] - from;
    const double along = squared > 0 ? std::clamp(d.dot(way) / squared, 0.0, 1.0) : 0;
    if (const double away = (d - along * way).norm(); away > most) {
      most = away;
      farthest = i;
    }
  }
  if (most <= near_mm) return;
  add_needed(line, first, farthest, near_mm, out);
  out.push_back(line[farthest]);
  add_needed(line, farthest, last, near_mm, out);
}

std::vector<Eigen::Vector3d> needed(const preview::Polyline& line, double near_mm) {
  if (line.points.size() < 3) return line.points;
  std::vector<Eigen::Vector3d> out{line.points.front()};
  add_needed(line.points, 0, line.points.size() - 1, near_mm, out);
  out.push_back(line.points.back());
  return out;
}

std::vector<preview::Polyline> borders_of(const surface::TriangleMesh& mesh) {
  std::vector<preview::Polyline> borders;
  for (const std::vector<int>& loop : mesh.border_loops()) {
    preview::Polyline& line = borders.emplace_back();
    for (const int corner : loop)
      line.points.push_back(mesh.vertices()[at(surface::vertex_at(mesh, corner))]);
    line.points.push_back(line.points.front());
  }
  return borders;
}

// The place of a value on the scale's key, 0 to 1. Where the scale is wide, what lies within the tolerance
// keeps three tenths of each half, as on the pictures' key.
class KeyPlace {
 public:
  explicit KeyPlace(const preview::ColorScale& scale) : scale_(scale) {
    constexpr double kInside = 0.3;
    if (scale.tolerance) inside_ = std::max(kInside, *scale.tolerance / scale.high);
  }
  [[nodiscard]] double of(double value) const {
    if (!scale_.tolerance) return std::clamp((value - scale_.low) / (scale_.high - scale_.low), 0.0, 1.0);
    const double size = std::abs(value), tolerance = *scale_.tolerance;
    const double share = size <= tolerance ? inside_ * size / tolerance
                                           : inside_ + (1 - inside_) * (size - tolerance) /
                                                           std::max(scale_.high - tolerance, 1e-9);
    return std::clamp(0.5 * (1 + std::copysign(share, value)), 0.0, 1.0);
  }
  [[nodiscard]] double value(double place) const {
    if (!scale_.tolerance) return scale_.low + place * (scale_.high - scale_.low);
    const double half = std::abs(2 * place - 1), tolerance = *scale_.tolerance;
    const double size = half <= inside_
                            ? half / inside_ * tolerance
                            : tolerance + (half - inside_) / (1 - inside_) * (scale_.high - tolerance);
    return std::copysign(size, 2 * place - 1);
  }

 private:
  preview::ColorScale scale_;
  double inside_ = 1;
};

Json ticks_of(const preview::ColorScale& scale, const KeyPlace& place) {
  Json ticks = Json::array();
  const auto tick = [&](double value, const std::string& words) {
    ticks.push_back({{"at", place.of(value)}, {"words", words}});
  };
  if (scale.tolerance) {
    for (const double value : {-scale.high, -*scale.tolerance, 0.0, *scale.tolerance, scale.high})
      tick(value, value == 0 ? "0" : fmt::format("{:+g}", value));
    return ticks;
  }
  const long marks = std::lround((scale.high - scale.low) / scale.step);
  for (long mark = 0; mark <= marks; ++mark) {
    const double value = std::round(scale.low / scale.step + static_cast<double>(mark)) * scale.step;
    tick(value, fmt::format("{:.4g}", value));
  }
  return ticks;
}

std::string hex(const preview::Rgb& color) {
  const auto byte = [](double share) { return static_cast<int>(std::lround(255 * share)); };
  return fmt::format("#{:02x}{:02x}{:02x}", byte(color[0]), byte(color[1]), byte(color[2]));
}

constexpr std::array<std::pair<preview::Color, const char*>, 5> kColors{
    {{preview::Color::kDeviation, "deviation"},
     {preview::Color::kStrip, "strip"},
     {preview::Color::kCurvature, "curvature"},
     {preview::Color::kMargin, "margin"},
     {preview::Color::kFeed, "feed"}}};

// The colours of a scale by place on its key, and the key's place of each vertex, in 255 steps.
Json add_coloring(ScenePacker& packer, const std::string& name, const preview::Coloring& coloring,
                  const DrawnCut& cut) {
  Json json{{"name", name}};
  if (!coloring.scale) return json;
  const KeyPlace place(*coloring.scale);
  Numbers places, colors;
  for (const std::size_t vertex : cut.from)
    places.push_back(static_cast<std::uint32_t>(std::lround(255 * place.of(coloring.values[vertex]))));
  for (int i = 0; i < 256; ++i) {
    for (const double share : preview::color_at(*coloring.scale, place.value(i / 255.0)))
      colors.push_back(static_cast<std::uint32_t>(std::lround(255 * share)));
  }
  packer.add(name, places, 1, Follows::kSteps);
  packer.add(name + "_colors", colors, 1, Follows::kAlone);
  json["title"] = coloring.scale->title;
  json["ticks"] = ticks_of(*coloring.scale, place);
  if (coloring.scale->tolerance) json["tolerance"] = *coloring.scale->tolerance;
  if (coloring.scale->limit) json["limit"] = *coloring.scale->limit;
  return json;
}

Json triple(const Eigen::Vector3d& v) {
  return Json::array({v.x(), v.y(), v.z()});
}

// All that a scene's text is made of but the cut and the design.
class Lines {
 public:
  Lines(const preview::Scene& scene, double near_mm) {
    add("borders", borders_of(scene.design), near_mm);
    add("ribs", scene.ribs, near_mm);
    add("blades", scene.blades, near_mm);
    add("blocks", preview::block_edges(scene.blocks), near_mm);
  }
  void extend(Eigen::AlignedBox3d& box) const {
    for (const Eigen::Vector3d& p : points_) box.extend(p);
  }
  void pack(ScenePacker& packer, const Grid& grid, Json& header) const {
    add_places(packer, grid, "line", points_);
    packer.add("line_points", counts_, 2, Follows::kAlone);
    header["lines"] = kinds_;
  }

 private:
  void add(const char* kind, const std::vector<preview::Polyline>& lines, double near_mm) {
    kinds_[kind] = lines.size();
    for (const preview::Polyline& line : lines) {
      // A border of more points than a number of two bytes says is one of a design of millions of triangles.
      std::vector<Eigen::Vector3d> points = needed(line, near_mm);
      constexpr std::size_t kMost = 65535;
      if (points.size() > kMost) points.resize(kMost);
      counts_.push_back(static_cast<std::uint32_t>(points.size()));
      points_.insert(points_.end(), points.begin(), points.end());
    }
  }

  Json kinds_;
  Numbers counts_;
  std::vector<Eigen::Vector3d> points_;
};

class SceneText {
 public:
  SceneText(const preview::Scene& scene, const Program& program, const ViewerLimits& limits)
      : scene_(scene), program_(program), limits_(limits), thinner_(scene.cut) {
    design_ = design_shell(scene.design, limits.triangles / 4);
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& p : design_.vertices) box.extend(p);
    for (const Eigen::Vector3d& p : scene.cut.vertices) box.extend(p);
    diagonal_mm_ = box.isEmpty() ? 1 : box.diagonal().norm();
    constexpr double kLineSteps = 4000;  // what a line may be off: less than a pixel of the whole view
    lines_.emplace(scene, diagonal_mm_ / kLineSteps);
    lines_->extend(box);
    for (const auto* clamps : {&scene.clamps_a, &scene.clamps_b}) {
      for (const Pose& clamp : *clamps) box.extend(clamp.p);
    }
    grid_.box = box.isEmpty() ? Eigen::AlignedBox3d(Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones()) : box;
    cut_normals_ = normals_of(scene.cut.vertices, scene.cut.triangles);
    if (scene.cut.vertices.empty()) return;
    for (const auto& [color, name] : kColors)
      colorings_.push_back(preview::coloring_of(color, program, scene.cut));
  }

  // The finest that fits.
  [[nodiscard]] ViewerScene fitted() const {
    std::size_t row_step = 1, column_step = 1;
    for (;;) {
      const DrawnCut cut = scene_.cut.vertices.empty() ? DrawnCut{} : thinner_.thinned(row_step, column_step);
      const std::size_t triangles = cut.triangles.size() + design_.triangles.size();
      // The coarsest that still shows a strip: steps beyond are those of limits that nothing fits.
      constexpr std::size_t kCoarsest = 32;
      if (triangles <= limits_.triangles || row_step >= kCoarsest) {
        std::string text = base64(packed(cut, row_step, column_step));
        if (text.size() <= limits_.text_bytes || row_step >= kCoarsest)
          return {std::move(text), triangles, row_step, column_step,
                  design_.triangles.size() < scene_.design.triangles().size()};
      }
      // Rows are as far apart as the points of a row: first half of these go, then half of those.
      ++(row_step <= column_step ? row_step : column_step);
    }
  }

 private:
  [[nodiscard]] std::string packed(const DrawnCut& cut, std::size_t row_step, std::size_t column_step) const {
    ScenePacker packer;
    Json header;
    header["box"] = {triple(grid_.box.min()), triple(grid_.box.sizes())};
    header["verdict"] = scene_.verdict;
    header["eye"] = triple(scene_.waste_direction);
    header["steps"] = {row_step, column_step};
    header["apart_mm"] = apart_mm();
    header["design_triangles"] = scene_.design.triangles().size();
    add_design(packer);
    add_cut(packer, cut);
    header["colors"] = Json::array();
    for (std::size_t i = 0; i < colorings_.size(); ++i)
      header["colors"].push_back(add_coloring(packer, kColors[i].second, colorings_[i], cut));
    header["strips"] = strips();
    lines_->pack(packer, grid_, header);
    add_clamps(packer);
    header["marks"] = marks();
    return packer.packed(std::move(header));
  }

  // So far the design is drawn behind the cut, as in the pictures: half a band and a bit, and all that the
  // cut is off, but no more than a fiftieth of the scene.
  [[nodiscard]] double apart_mm() const {
    double apart = 1;
    for (const double mm : scene_.cut.deviation_mm) apart = std::max(apart, std::abs(mm));
    return std::min(3 * apart, diagonal_mm_ / 50);
  }

  void add_design(ScenePacker& packer) const {
    add_places(packer, grid_, "design", design_.vertices);
    add_normals(packer, "design_normal", design_.normals);
    add_triangles(packer, "design_corners", design_.triangles);
  }

  void add_cut(ScenePacker& packer, const DrawnCut& cut) const {
    std::vector<Eigen::Vector3d> places, normals;
    for (const std::size_t vertex : cut.from) {
      places.push_back(scene_.cut.vertices[vertex]);
      normals.push_back(cut_normals_[vertex]);
    }
    add_places(packer, grid_, "cut", places);
    add_normals(packer, "cut_normal", normals);
    add_triangles(packer, "cut_corners", cut.triangles);
    Numbers done, first, strip, time;
    for (std::size_t i = 0; i < cut.rows.size(); ++i) {
      const Row& row = cut.rows[i];
      done.push_back(static_cast<std::uint32_t>(cut.done[i]));
      first.push_back(static_cast<std::uint32_t>(row.first));
      strip.push_back(static_cast<std::uint32_t>(row.strip));
      constexpr double kTicksPerSecond = 10;
      const double t = program_.strips[at(row.strip)].poses[at(row.pose)].t;
      time.push_back(static_cast<std::uint32_t>(std::lround(kTicksPerSecond * t)));
    }
    packer.add("row_done", done, 4, Follows::kBends);
    packer.add("row_first", first, 4, Follows::kBends);
    packer.add("row_strip", strip, 2, Follows::kSteps);
    packer.add("row_tenths", time, 4, Follows::kBends);
  }

  void add_clamps(ScenePacker& packer) const {
    for (const auto& [name, clamps] :
         {std::pair{"clamp_a", &scene_.clamps_a}, {"clamp_b", &scene_.clamps_b}}) {
      std::vector<Eigen::Vector3d> places;
      for (const Pose& clamp : *clamps) places.push_back(clamp.p);
      add_places(packer, grid_, name, places);
    }
  }

  [[nodiscard]] Json strips() const {
    Json list = Json::array();
    for (std::size_t i = 0; i < program_.strips.size(); ++i) {
      const Strip& strip = program_.strips[i];
      list.push_back({{"id", strip.id},
                      {"color", hex(preview::strip_color(static_cast<int>(i)))},
                      {"middle", triple(strip.block.frame.origin +
                                        0.5 * (strip.block.corners()[7] - strip.block.corners()[0]))}});
    }
    return list;
  }

  [[nodiscard]] Json marks() const {
    Json list = Json::array();
    if (scene_.worst) {
      list.push_back({{"at", triple(scene_.worst->at)}, {"words", scene_.worst->words}});
    } else if (program_.verification.deviation_mm.max > 0 && !scene_.cut.vertices.empty()) {
      list.push_back({{"at", triple(program_.verification.deviation_mm.at)}, {"words", "largest deviation"}});
    }
    return list;
  }

  const preview::Scene& scene_;
  const Program& program_;
  const ViewerLimits& limits_;
  Thinner thinner_;
  Shell design_;
  std::vector<Eigen::Vector3d> cut_normals_;
  std::vector<preview::Coloring> colorings_;
  std::optional<Lines> lines_;
  Grid grid_;
  double diagonal_mm_ = 1;
};

}  // namespace

std::optional<Viewer> viewer_named(const std::string& name) {
  constexpr std::array<std::pair<Viewer, const char*>, 3> kViewers{
      {{Viewer::kFull, "full"}, {Viewer::kLight, "light"}, {Viewer::kNone, "none"}}};
  for (const auto& [viewer, one] : kViewers) {
    if (one == name) return viewer;
  }
  return std::nullopt;
}

ViewerLimits limits_of(Viewer viewer) {
  switch (viewer) {
    case Viewer::kFull:
      return {};
    case Viewer::kLight:
      return {40000, 250000};
    case Viewer::kNone:
      break;
  }
  return {0, 0};
}

ViewerScene viewer_scene(const preview::Scene& scene, const Program& program, const ViewerLimits& limits) {
  return SceneText(scene, program, limits).fitted();
}

std::string base64(const std::string& bytes) {
  std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');
  const int n =
      EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                      reinterpret_cast<const unsigned char*>(bytes.data()), static_cast<int>(bytes.size()));
  text.resize(static_cast<std::size_t>(n));
  return text;
}

}  // namespace hotblade::pipeline

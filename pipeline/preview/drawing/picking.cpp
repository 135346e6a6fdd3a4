#include "pipeline/preview/drawing/picking.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <vector>

namespace hotblade::pipeline::preview {
namespace {

// How near a click has to come, pixels: lines are thin, and ribs lie near each other.
constexpr double kBladeReach = 7, kRibReach = 4;
// Lines are drawn on the surface they lie on, or half a band off it: not hidden within this share of the
// depth of the scene.
constexpr double kDepthSlack = 0.02;

struct Hit {
  double depth = std::numeric_limits<double>::infinity();
  std::size_t triangle = 0;
};

// The nearest of the first `count` triangles under the pixel that the clip plane leaves.
template <class Keeps>
Hit nearest_triangle(std::span<const Eigen::Vector3d> vertices, std::span<const std::array<int, 3>> triangles,
                     std::size_t count, const Sight& sight, const Eigen::Vector2d& pixel,
                     const Keeps& keeps) {
  std::vector<Eigen::Vector3d> seen;
  seen.reserve(vertices.size());
  for (const Eigen::Vector3d& vertex : vertices) seen.push_back(sight.pixel(vertex));
  Hit best;
  for (std::size_t t = 0; t < count; ++t) {
    std::array<Eigen::Vector3d, 3> p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = seen[static_cast<std::size_t>(triangles[t][i])];
    const auto area = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
      return (a.x() - pixel.x()) * (b.y() - pixel.y()) - (a.y() - pixel.y()) * (b.x() - pixel.x());
    };
    const Eigen::Vector3d w(area(p[1], p[2]), area(p[2], p[0]), area(p[0], p[1]));
    if (w.minCoeff() < 0 && w.maxCoeff() > 0) continue;
    const double sum = w.sum();
    if (sum == 0) continue;
    const double depth = (w.x() * p[0].z() + w.y() * p[1].z() + w.z() * p[2].z()) / sum;
    if (depth >= best.depth) continue;
    Eigen::Vector3d place = Eigen::Vector3d::Zero();
    for (int i = 0; i < 3; ++i)
      place += w[i] / sum * vertices[static_cast<std::size_t>(triangles[t][static_cast<std::size_t>(i)])];
    if (keeps(place)) best = {depth, t};
  }
  return best;
}

// Squared distance in pixels of the line's nearest visible place; infinite: none.
template <class Keeps>
double line_distance_squared(const Polyline& line, const Sight& sight, const Eigen::Vector2d& pixel,
                             double deepest, const Keeps& keeps) {
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < line.points.size(); ++i) {
    const Eigen::Vector3d a = sight.pixel(line.points[i]), b = sight.pixel(line.points[i + 1]);
    const Eigen::Vector2d along = (b - a).head<2>();
    const double length = along.squaredNorm();
    const double share = length > 0 ? std::clamp((pixel - a.head<2>()).dot(along) / length, 0.0, 1.0) : 0;
    const Eigen::Vector3d nearest = a + share * (b - a);
    const Eigen::Vector3d place = line.points[i] + share * (line.points[i + 1] - line.points[i]);
    if (nearest.z() <= deepest && keeps(place))
      best = std::min(best, (nearest.head<2>() - pixel).squaredNorm());
  }
  return best;
}

// The nearest of the lines within reach; none: -1.
template <class Keeps>
int nearest_line(const std::vector<Polyline>& lines, const Sight& sight, const Eigen::Vector2d& pixel,
                 double reach, double deepest, const Keeps& keeps) {
  int found = -1;
  double best = reach * reach;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const double distance = line_distance_squared(lines[i], sight, pixel, deepest, keeps);
    if (distance > best) continue;
    best = distance;
    found = static_cast<int>(i);
  }
  return found;
}

Selection rib_selection(const Program& program, int line) {
  for (std::size_t strip = 0; strip < program.strips.size(); ++strip) {
    const int ribs = static_cast<int>(program.strips[strip].ribs.size());
    if (line < ribs) return {Part::kRib, static_cast<int>(strip), line};
    line -= ribs;
  }
  return {};
}

Picked picked_surface(const ViewModel& model, const Hit& hit) {
  const CutSurface& cut = model.scene.cut;
  const auto vertex = static_cast<std::size_t>(cut.triangles[hit.triangle][0]);
  return {{Part::kStrip, cut.strip_of_vertex[vertex], -1}, cut.pose_of_vertex[vertex]};
}

}  // namespace

Eigen::Vector3d Sight::pixel(const Eigen::Vector3d& place) const {
  const Eigen::Vector4d seen = to_view * place.homogeneous();
  return {(seen.x() / seen.w() + 1) / 2 * size.width, (seen.y() / seen.w() + 1) / 2 * size.height,
          seen.z() / seen.w()};
}

double clip_offset_mm(const ViewModel& model, const ClipPlane& clip) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& vertex : model.scene.design.vertices()) box.extend(vertex);
  for (const Eigen::Vector3d& vertex : model.scene.cut.vertices) box.extend(vertex);
  if (box.isEmpty()) return 0;
  return box.min()[clip.axis] + clip.share * box.sizes()[clip.axis];
}

std::size_t shown_triangles(const ViewModel& model, const ViewState& state) {
  if (!state.cut_so_far) return model.scene.cut.triangles.size();
  const auto after = std::upper_bound(model.triangle_s.begin(), model.triangle_s.end(), state.time_s);
  return static_cast<std::size_t>(after - model.triangle_s.begin());
}

Picked pick(const ViewModel& model, const ViewState& state, const std::vector<Polyline>& ghosts,
            const std::vector<std::array<int, 2>>& pose_of_ghost, const Sight& sight,
            const Eigen::Vector2d& pixel) {
  if (model.program.strips.empty()) return {};
  const double offset = state.clip.axis < 0 ? 0 : clip_offset_mm(model, state.clip);
  const auto keeps = [&](const Eigen::Vector3d& place) {
    if (state.clip.axis < 0) return true;
    const double beyond = place[state.clip.axis] - offset;
    return state.clip.keeps_low ? beyond <= 0 : beyond >= 0;
  };
  const auto always = [](const Eigen::Vector3d&) { return true; };
  const CutSurface& cut = model.scene.cut;
  Hit hit, design;
  if (state.shows(Layer::kCut)) {
    hit = nearest_triangle(cut.vertices, cut.triangles, shown_triangles(model, state), sight, pixel, keeps);
  }
  if (state.shows(Layer::kDesign)) {
    const auto& mesh = model.scene.design;
    design =
        nearest_triangle(mesh.vertices(), mesh.triangles(), mesh.triangles().size(), sight, pixel, keeps);
  }
  const double deepest = std::min(hit.depth, design.depth) + kDepthSlack;
  if (state.shows(Layer::kBlade)) {
    const Moment now = moment_at(model.facts, state.time_s);
    const BladePose& pose = pose_at(model, now);
    if (nearest_line({line_of(pose.frame, pose.blade)}, sight, pixel, kBladeReach, deepest, always) == 0)
      return {{Part::kPose, now.strip, now.pose}, now.pose};
  }
  if (state.shows(Layer::kGhosts)) {
    const int ghost = nearest_line(ghosts, sight, pixel, kRibReach, deepest, always);
    if (ghost >= 0) {
      const auto [strip, pose] = pose_of_ghost[static_cast<std::size_t>(ghost)];
      return {{Part::kPose, strip, pose}, pose};
    }
  }
  if (state.shows(Layer::kRibs)) {
    const int rib = nearest_line(model.scene.ribs, sight, pixel, kRibReach, deepest, keeps);
    if (rib >= 0) return {rib_selection(model.program, rib), -1};
  }
  const bool design_hides = design.depth + kDepthSlack < hit.depth;
  if (hit.depth == std::numeric_limits<double>::infinity() || design_hides) return {};
  return picked_surface(model, hit);
}

}  // namespace hotblade::pipeline::preview

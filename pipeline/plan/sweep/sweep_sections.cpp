#include "pipeline/plan/sweep/sweep_sections.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace hotblade::pipeline {

namespace {

using Eigen::Vector3d;

// The end sections lie this far inside; two more follow, as the border's corners are met there.
constexpr std::array<double, 3> kEndInsets_mm{0.05, 2.5, 7};

double angle_at(const Vector3d& p, const Vector3d& q, const Vector3d& r) {
  const Vector3d a = q - p, b = r - p;
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// A vertex of the moved surface in the frame's coordinates.
struct MovedVertex {
  Vector3d at;   // x, y, along the sweep
  Vector3d own;  // the same of the design's point
  double along;  // component of the normal along the sweep
};

MovedVertex moved(const Vector3d& point, const Vector3d& normal, const SweepFrame& frame,
                  const SweepSectionOptions& options) {
  const auto in_frame = [&](const Vector3d& d) -> Vector3d {
    return {d.dot(frame.x), d.dot(frame.y), d.dot(frame.sweep)};
  };
  const Vector3d own = in_frame(point - frame.centre), n = in_frame(normal);
  const auto band = [&](double across) {
    return 0.5 * (options.kerf_mm + options.width_mm * std::abs(across));
  };
  Vector3d at = own + band(n.z()) * n;
  if (options.sag) {
    const SweepSag::Value sag = options.sag->at(at.z(), at.x());
    // The width stands along the planes' normal, turned by the twist away from the curve's left.
    const double left = n.y() * std::cos(sag.theta) - n.x() * std::sin(sag.theta);
    at = own + band(n.z() - sag.twist_rad * left) * n - Vector3d(0, 0, sag.droop_mm);
  }
  return {at, own, n.z()};
}

std::vector<double> section_offsets(double first, double last, int count) {
  std::vector<double> offsets;
  const double extent = last - first;
  for (const double inset : kEndInsets_mm) {
    if (inset < 0.25 * extent) {
      offsets.push_back(first + inset);
      offsets.push_back(last - inset);
    }
  }
  if (offsets.empty()) offsets = {0.5 * (first + last)};
  for (int i = 1; i < count; ++i) offsets.push_back(first + extent * i / count);
  std::sort(offsets.begin(), offsets.end());
  return offsets;
}

// Samples of one section on their way: one for each cell of a grid, the nearest to its middle, and all points
// of the border.
class Thinned {
 public:
  explicit Thinned(double cell_mm) : cell_mm_(cell_mm) {}

  void add(const SweepSample& sample) {
    // Grids of designs start at round numbers: a shift by none keeps their points off the cells' edges, where
    // rounding would decide between neighbours.
    constexpr double kShift = 0.3719;
    const Eigen::Vector2d place = (sample.q / cell_mm_).array() + kShift;
    const Eigen::Vector2d cell = place.array().floor();
    const double away = (place - cell - Eigen::Vector2d::Constant(0.5)).squaredNorm();
    const auto [at, fresh] =
        cells_.try_emplace({static_cast<long>(cell.x()), static_cast<long>(cell.y())}, away, sample);
    if (!fresh && away < at->second.first) at->second = {away, sample};
  }
  void add_border(const SweepSample& sample) { border_.push_back(sample); }

  [[nodiscard]] std::vector<SweepSample> samples() const {
    std::vector<SweepSample> all = border_;
    for (const auto& [cell, sample] : cells_) all.push_back(sample.second);
    std::sort(all.begin(), all.end(), [](const SweepSample& a, const SweepSample& b) {
      return std::pair(a.q.x(), a.q.y()) < std::pair(b.q.x(), b.q.y());
    });
    return all;
  }

 private:
  double cell_mm_;
  std::map<std::pair<long, long>, std::pair<double, SweepSample>> cells_;
  std::vector<SweepSample> border_;
};

// The point of an edge in the plane at an offset, which lies between its ends.
SweepSample crossing(const MovedVertex& a, const MovedVertex& b, double offset) {
  const double t = std::clamp((offset - a.at.z()) / (b.at.z() - a.at.z()), 0.0, 1.0);
  const double along = std::min(1.0, std::abs(a.along + t * (b.along - a.along)));
  return {(a.at + t * (b.at - a.at)).head<2>(), std::sqrt(1 - along * along)};
}

std::vector<std::pair<int, int>> border_edges(const surface::TriangleMesh& mesh) {
  std::vector<std::pair<int, int>> border;
  for (const int corner : mesh.border())
    border.push_back(std::minmax(vertex_at(mesh, corner), vertex_at(mesh, surface::next_corner(corner))));
  std::sort(border.begin(), border.end());
  return border;
}

// Where two edges of the border meet and turn by more than this, a fit is farthest off soon.
std::vector<int> corners_of(const std::vector<Vector3d>& points,
                            const std::vector<std::pair<int, int>>& border) {
  constexpr double kSharp_rad = 0.5;
  std::map<int, std::vector<int>> beside;
  for (const auto& [a, b] : border) {
    beside[a].push_back(b);
    beside[b].push_back(a);
  }
  const auto at = [&](int i) -> const Vector3d& { return points[static_cast<std::size_t>(i)]; };
  std::vector<int> corners;
  for (const auto& [v, next] : beside) {
    if (next.size() != 2) continue;
    if (std::numbers::pi - angle_at(at(v), at(next[0]), at(next[1])) > kSharp_rad) corners.push_back(v);
  }
  return corners;
}

class Slicer {
 public:
  Slicer(const WasteSurface& surface, const SweepFrame& frame, const SweepSectionOptions& options)
      : surface_(surface), options_(options) {
    vertices_.reserve(surface.points.size());
    for (std::size_t i = 0; i < surface.points.size(); ++i)
      vertices_.push_back(moved(surface.points[i], surface.normals[i], frame, options));
    data_.frame = frame;
  }

  SweepData run() {
    if (!measure()) return data_;
    offsets_ = section_offsets(first_, last_, options_.count);
    for (const double offset : options_.extra_mm) {
      if (offset > first_ && offset < last_) offsets_.push_back(offset);
    }
    add_corners();
    std::sort(offsets_.begin(), offsets_.end());
    offsets_.erase(std::unique(offsets_.begin(), offsets_.end()), offsets_.end());
    thinned_.assign(offsets_.size(), Thinned(options_.sample_mm));
    for (std::size_t t = 0; t < surface_.triangles.size(); ++t) {
      if (in_window(t)) cut(t);
    }
    for (std::size_t k = 0; k < offsets_.size(); ++k) {
      std::vector<SweepSample> samples = thinned_[k].samples();
      if (!samples.empty()) data_.sections.push_back({offsets_[k], std::move(samples)});
    }
    return std::move(data_);
  }

 private:
  [[nodiscard]] const MovedVertex& vertex(std::size_t triangle, std::size_t corner) const {
    return vertices_[static_cast<std::size_t>(surface_.triangles[triangle][corner % 3])];
  }

  // Sections close to each corner, on both sides of it. A border that is all corners is met often enough.
  void add_corners() {
    constexpr std::size_t kMostCorners = 12;
    constexpr double kBesideMm = 0.5;
    if (surface_.corners.size() > kMostCorners) return;
    for (const int corner : surface_.corners) {
      const Vector3d& at = vertices_[static_cast<std::size_t>(corner)].at;
      if (at.x() < options_.window.low_mm || at.x() > options_.window.high_mm) continue;
      for (const double offset : {at.z() - kBesideMm, at.z() + kBesideMm}) {
        if (offset > first_ && offset < last_) offsets_.push_back(offset);
      }
    }
  }

  // Triangles that reach into the window; cut() drops the points outside.
  [[nodiscard]] bool in_window(std::size_t triangle) const {
    double low = vertex(triangle, 0).at.x(), high = low;
    for (const std::size_t c : {1U, 2U}) {
      low = std::min(low, vertex(triangle, c).at.x());
      high = std::max(high, vertex(triangle, c).at.x());
    }
    return high >= options_.window.low_mm && low <= options_.window.high_mm;
  }

  // Extents of what lies in the window; false where nothing does.
  bool measure() {
    const SweepWindow& w = options_.window;
    constexpr double kInf = std::numeric_limits<double>::infinity();
    first_ = kInf;
    last_ = -kInf;
    data_.low.setConstant(kInf);
    data_.high.setConstant(-kInf);
    double along = 0;
    for (std::size_t t = 0; t < surface_.triangles.size(); ++t) {
      if (!in_window(t)) continue;
      for (const std::size_t c : {0U, 1U, 2U}) {
        const MovedVertex& v = vertex(t, c);
        const double offset = std::clamp(v.at.z(), w.first_mm, w.last_mm);
        first_ = std::min(first_, offset);
        last_ = std::max(last_, offset);
        const Vector3d inside(std::clamp(v.own.x(), w.low_mm, w.high_mm), v.own.y(),
                              std::clamp(v.own.z(), w.first_mm, w.last_mm));
        data_.low = data_.low.cwiseMin(inside);
        data_.high = data_.high.cwiseMax(inside);
        if (v.at.z() >= w.first_mm && v.at.z() <= w.last_mm) along = std::max(along, std::abs(v.along));
      }
    }
    data_.steepest_rad = std::asin(std::min(1.0, along));
    return last_ > first_;
  }

  [[nodiscard]] bool on_border(int a, int b) const {
    return std::binary_search(surface_.border.begin(), surface_.border.end(),
                              std::pair<int, int>(std::minmax(a, b)));
  }

  void cut(std::size_t triangle) {
    const std::array<double, 3> z{vertex(triangle, 0).at.z(), vertex(triangle, 1).at.z(),
                                  vertex(triangle, 2).at.z()};
    const auto [low, high] = std::minmax({z[0], z[1], z[2]});
    const auto from = std::lower_bound(offsets_.begin(), offsets_.end(), low);
    for (auto at = from; at != offsets_.end() && *at < high; ++at)
      cut(triangle, *at, thinned_[static_cast<std::size_t>(at - offsets_.begin())]);
  }

  void cut(std::size_t triangle, double offset, Thinned& section) const {
    std::array<SweepSample, 2> ends;
    std::size_t found = 0;
    for (std::size_t c = 0; c < 3 && found < 2; ++c) {
      const MovedVertex &a = vertex(triangle, c), &b = vertex(triangle, c + 1);
      if ((a.at.z() <= offset) == (b.at.z() <= offset)) continue;
      const auto& corners = surface_.triangles[triangle];
      // From the lower to the higher end, so that both faces of an edge find the same point.
      ends[found] = a.at.z() < b.at.z() ? crossing(a, b, offset) : crossing(b, a, offset);
      if (on_border(corners[c], corners[(c + 1) % 3]) && inside(ends[found])) section.add_border(ends[found]);
      ++found;
    }
    if (found < 2) return;
    for (const double edge : {options_.window.low_mm, options_.window.high_mm}) {
      const double from = ends[0].q.x() - edge, to = ends[1].q.x() - edge;
      if (from * to < 0) section.add_border(between(ends[0], ends[1], from / (from - to)));
    }
    const double length = (ends[1].q - ends[0].q).norm();
    const int pieces = std::max(1, static_cast<int>(std::ceil(2 * length / options_.sample_mm)));
    for (int i = 0; i <= pieces; ++i) {
      const SweepSample sample = between(ends[0], ends[1], static_cast<double>(i) / pieces);
      if (inside(sample)) section.add(sample);
    }
  }

  static SweepSample between(const SweepSample& a, const SweepSample& b, double t) {
    return {a.q + t * (b.q - a.q), a.cosine + t * (b.cosine - a.cosine)};
  }

  [[nodiscard]] bool inside(const SweepSample& sample) const {
    return sample.q.x() >= options_.window.low_mm && sample.q.x() <= options_.window.high_mm;
  }

  const WasteSurface& surface_;
  SweepSectionOptions options_;
  std::vector<MovedVertex> vertices_;
  std::vector<double> offsets_;
  std::vector<Thinned> thinned_;
  double first_ = 0, last_ = 0;
  SweepData data_;
};

}  // namespace

WasteSurface waste_surface(const surface::TriangleMesh& mesh, double side) {
  const auto vertices = mesh.vertices();
  const auto triangles = mesh.triangles();
  WasteSurface surface{{vertices.begin(), vertices.end()},
                       std::vector<Vector3d>(vertices.size(), Vector3d::Zero()),
                       {triangles.begin(), triangles.end()},
                       border_edges(mesh),
                       {}};
  surface.corners = corners_of(surface.points, surface.border);
  for (const auto& t : triangles) {
    const auto corner = [&](std::size_t c) -> const Vector3d& {
      return vertices[static_cast<std::size_t>(t[c % 3])];
    };
    const Vector3d normal = side * (corner(1) - corner(0)).cross(corner(2) - corner(0)).stableNormalized();
    for (std::size_t c = 0; c < 3; ++c)
      surface.normals[static_cast<std::size_t>(t[c])] +=
          angle_at(corner(c), corner(c + 1), corner(c + 2)) * normal;
  }
  for (Vector3d& n : surface.normals) n.stableNormalize();
  return surface;
}

SweepFrame sweep_frame(const WasteSurface& surface, const Vector3d& planes_normal, const Vector3d& centre) {
  Vector3d mean = Vector3d::Zero();
  for (const auto& t : surface.triangles) {
    const auto at = [](const std::vector<Vector3d>& all, int i) -> const Vector3d& {
      return all[static_cast<std::size_t>(i)];
    };
    const Vector3d& p = at(surface.points, t[0]);
    const double area = (at(surface.points, t[1]) - p).cross(at(surface.points, t[2]) - p).norm();
    mean += area * (at(surface.normals, t[0]) + at(surface.normals, t[1]) + at(surface.normals, t[2]));
  }
  SweepFrame frame;
  frame.centre = centre;
  frame.sweep = planes_normal.normalized();
  Vector3d y = mean - mean.dot(frame.sweep) * frame.sweep;
  constexpr double kNoSide = 1e-9;
  if (!(y.norm() > kNoSide * mean.norm())) y = frame.sweep.unitOrthogonal();
  frame.y = y.normalized();
  frame.x = frame.y.cross(frame.sweep);
  return frame;
}

SweepData sweep_sections(const WasteSurface& surface, const SweepFrame& frame,
                         const SweepSectionOptions& options) {
  return Slicer(surface, frame, options).run();
}

}  // namespace hotblade::pipeline

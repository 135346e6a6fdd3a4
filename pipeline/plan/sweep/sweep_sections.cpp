#include "pipeline/plan/sweep/sweep_sections.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>

#include "gpu/backend/stop.hpp"
#include "pipeline/plan/sweep/moved_surface.hpp"
#include "pipeline/plan/sweep/section_cells.hpp"
#include "surface/read/blocks.hpp"

namespace hotblade::pipeline {

namespace {

using Eigen::Vector3d;

// The end sections lie this far inside; two more follow, as the border's corners are met there.
constexpr std::array<double, 3> kEndInsets_mm{0.05, 2.5, 7};
// Half a usual blade's width: what it passes over at once.
constexpr double kBendOver_mm = 4;

double angle_at(const Vector3d& p, const Vector3d& q, const Vector3d& r) {
  const Vector3d a = q - p, b = r - p;
  return std::atan2(a.cross(b).norm(), a.dot(b));
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

// A point of a section, in its plane and in space.
struct SectionPoint {
  SweepSample sample;
  Vector3d world;
};

// The point of an edge in the plane at an offset, which lies between its ends.
SectionPoint crossing(const RibAxes& axes, const MovedVertex& a, const MovedVertex& b, double offset) {
  const double t = std::clamp(axes.planes.crossing(a.world, a.at.z(), b.world, b.at.z(), offset), 0.0, 1.0);
  const Vector3d world = a.world + t * (b.world - a.world);
  const Frame plane = axes.plane(offset);
  const Vector3d d = world - plane.origin;
  return {{{d.dot(plane.x), d.dot(plane.y)}, cosine_of(a.along + t * (b.along - a.along)), false}, world};
}

SectionPoint between(const SectionPoint& a, const SectionPoint& b, double t) {
  return {{a.sample.q + t * (b.sample.q - a.sample.q),
           a.sample.cosine + t * (b.sample.cosine - a.sample.cosine), false},
          a.world + t * (b.world - a.world)};
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
  Slicer(const MovedSurface& moved, const SweepSectionOptions& options)
      : moved_(moved),
        surface_(moved.surface()),
        axes_(moved.axes()),
        options_(options),
        data_(moved.extents()) {}

  SweepData run() {
    if (moved_.empty() || (options_.if_followable && !data_.followable())) return std::move(data_);
    offsets_ = section_offsets(data_.first_mm, data_.last_mm, options_.count);
    for (const double offset : options_.extra_mm) add(offset);
    add_corners();
    std::sort(offsets_.begin(), offsets_.end());
    offsets_.erase(std::unique(offsets_.begin(), offsets_.end()), offsets_.end());
    runs_.resize(options_.gap_mm ? offsets_.size() : 0);
    const std::vector<std::vector<int>> met = met_by_sections();
    std::vector<SweepSection> sections(offsets_.size());
    surface::for_blocks(offsets_.size(), 1, [&](std::size_t k, std::size_t) {
      gpu::stop_point();
      sections[k] = {offsets_[k], section_of(met[k], k)};
    });
    for (SweepSection& section : sections) {
      if (!section.samples.empty()) data_.sections.push_back(std::move(section));
    }
    add_border();
    for (std::size_t k = 0; k < runs_.size(); ++k) find_gap(offsets_[k], runs_[k]);
    return std::move(data_);
  }

 private:
  using Triangle = MovedSurface::Triangle;

  void add(double offset) {
    if (offset > data_.first_mm && offset < data_.last_mm) offsets_.push_back(offset);
  }

  [[nodiscard]] bool inside(const Vector3d& p) const {
    return std::all_of(moved_.seams().begin(), moved_.seams().end(),
                       [&](const SweepSeam& seam) { return behind(seam, p) >= 0; });
  }

  // Sections close to each corner, on both sides of it. A border that is all corners is met often enough.
  void add_corners() {
    constexpr std::size_t kMostCorners = 12;
    constexpr double kBesideMm = 0.5;
    if (surface_.corners.size() > kMostCorners) return;
    for (const int corner : surface_.corners) {
      const MovedVertex& v = moved_.vertex(corner);
      if (!moved_.behind().all(corner)) continue;
      for (const double offset : {v.at.z() - kBesideMm, v.at.z() + kBesideMm}) add(offset);
    }
  }

  void add_border() {
    std::vector<int> points;
    for (const auto& [a, b] : surface_.border) points.insert(points.end(), {a, b});
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    for (const int i : points) {
      const MovedVertex& v = moved_.vertex(i);
      if (moved_.behind().all(i)) data_.border.emplace_back(v.at.z(), v.at.head<2>());
    }
  }

  [[nodiscard]] bool on_border(int a, int b) const {
    return std::binary_search(surface_.border.begin(), surface_.border.end(),
                              std::pair<int, int>(std::minmax(a, b)));
  }

  // The triangles that each section meets, or whose edges it may run along where gaps are looked for;
  // ascending.
  [[nodiscard]] std::vector<std::vector<int>> met_by_sections() const {
    const double near = options_.gap_mm.value_or(0);
    std::vector<std::vector<int>> met(offsets_.size());
    for (std::size_t t = 0; t < surface_.triangles.size(); ++t) {
      gpu::stop_point();
      if (!moved_.behind().in_reach(surface_.triangles[t])) continue;
      const auto [low, high] = extent(t);
      const auto from = std::lower_bound(offsets_.begin(), offsets_.end(), low - near);
      for (auto at = from; at != offsets_.end() && *at <= high + near; ++at)
        met[static_cast<std::size_t>(at - offsets_.begin())].push_back(static_cast<int>(t));
    }
    return met;
  }

  // Of a triangle, along the sweep.
  [[nodiscard]] std::pair<double, double> extent(std::size_t t) const {
    const auto among = [](double a, double b, double c) { return std::pair(std::minmax({a, b, c})); };
    if (axes_.planes.turns()) {
      const Triangle corners = moved_.triangle(t);
      return among(corners[0].at.z(), corners[1].at.z(), corners[2].at.z());
    }
    const auto& at = surface_.triangles[t];
    const auto offset = [&](std::size_t c) { return moved_.vertex(at[c]).at.z(); };
    return among(offset(0), offset(1), offset(2));
  }

  // Samples of a section of these triangles.
  [[nodiscard]] std::vector<SweepSample> section_of(const std::vector<int>& met, std::size_t k) {
    SectionCells cells(options_.sample_mm);
    for (const int i : met) {
      const auto t = static_cast<std::size_t>(i);
      const Triangle corners = moved_.triangle(t);
      if (options_.gap_mm) add_edges(corners, k);
      cut(corners, surface_.triangles[t], k, cells);
    }
    return cells.samples();
  }

  // Edges that run along a section's plane, nearer to it than a gap is wide, are no gap: rounding and the
  // blade's droop put them on this side of it or on that.
  void add_edges(const Triangle& corners, std::size_t k) {
    const double near = *options_.gap_mm, offset = offsets_[k];
    for (std::size_t c = 0; c < 3; ++c) {
      const MovedVertex &a = corners[c], &b = corners[(c + 1) % 3];
      const bool in_plane = std::abs(a.at.z() - offset) <= near && std::abs(b.at.z() - offset) <= near;
      if (in_plane) add_run({{a.at.head<2>(), 1, false}, a.world}, {{b.at.head<2>(), 1, false}, b.world}, k);
    }
  }

  void add_run(const SectionPoint& a, const SectionPoint& b, std::size_t k) {
    if (const auto run = share_behind(a, b, options_.gap_behind_mm))
      runs_[k].emplace_back(
          std::minmax({between(a, b, run->first).sample.q.x(), between(a, b, run->second).sample.q.x()}));
  }

  void cut(const Triangle& corners, const std::array<int, 3>& indices, std::size_t k, SectionCells& section) {
    const double offset = offsets_[k];
    std::array<SectionPoint, 2> ends;
    std::size_t found = 0;
    for (std::size_t c = 0; c < 3 && found < 2; ++c) {
      const MovedVertex &a = corners[c], &b = corners[(c + 1) % 3];
      if ((a.at.z() <= offset) == (b.at.z() <= offset)) continue;
      // From the lower to the higher end, so that both faces of an edge find the same point.
      ends[found] = a.at.z() < b.at.z() ? crossing(axes_, a, b, offset) : crossing(axes_, b, a, offset);
      if (on_border(indices[c], indices[(c + 1) % 3]) && inside(ends[found].world))
        section.add_border(ends[found].sample);
      ++found;
    }
    if (found == 2) add_between(ends[0], ends[1], k, section);
  }

  // The share of a piece of a section that lies behind all seams by so much.
  [[nodiscard]] std::optional<std::pair<double, double>> share_behind(const SectionPoint& a,
                                                                      const SectionPoint& b,
                                                                      double mm) const {
    double first = 0, last = 1;
    for (const SweepSeam& seam : moved_.seams()) {
      const double from = behind(seam, a.world) - mm, to = behind(seam, b.world) - mm;
      if (from < 0 && to < 0) return std::nullopt;
      if (from < 0) first = std::max(first, from / (from - to));
      if (to < 0) last = std::min(last, from / (from - to));
    }
    if (first > last) return std::nullopt;
    return std::pair(first, last);
  }

  // What of a piece of a section lies behind the seams, and where it meets them.
  void add_between(const SectionPoint& a, const SectionPoint& b, std::size_t k, SectionCells& section) {
    if (options_.gap_mm) add_run(a, b, k);
    const auto share = share_behind(a, b, 0);
    if (!share) return;
    const auto [first, last] = *share;
    for (const double end : {first, last}) {
      if (end == 0 || end == 1) continue;
      SweepSample sample = between(a, b, end).sample;
      sample.at_seam = true;
      section.add_border(sample);
    }
    const double length = (b.sample.q - a.sample.q).norm();
    const int pieces = std::max(1, static_cast<int>(std::ceil(2 * length / options_.sample_mm)));
    for (int i = 0; i <= pieces; ++i) {
      const double t = static_cast<double>(i) / pieces;
      if (t >= first && t <= last) section.add(between(a, b, t).sample);
    }
  }

  // What no run of a section covers, between its ends.
  void find_gap(double offset, std::vector<std::pair<double, double>>& runs) {
    std::sort(runs.begin(), runs.end());
    for (std::size_t i = 1; i < runs.size(); ++i) {
      const SweepGap gap{offset, runs[i - 1].second, runs[i].first};
      if (gap.width_mm() >= *options_.gap_mm && (!data_.gap || gap.width_mm() > data_.gap->width_mm()))
        data_.gap = gap;
      runs[i].second = std::max(runs[i].second, runs[i - 1].second);
    }
  }

  const MovedSurface& moved_;
  const WasteSurface& surface_;
  const RibAxes& axes_;
  const SweepSectionOptions& options_;
  std::vector<double> offsets_;
  std::vector<std::vector<std::pair<double, double>>>
      runs_;  // in x, of each section, where gaps are looked for
  SweepData data_;
};

}  // namespace

WasteSurface waste_surface(const surface::TriangleMesh& mesh, double side) {
  const auto vertices = mesh.vertices();
  const auto triangles = mesh.triangles();
  WasteSurface surface{{vertices.begin(), vertices.end()},
                       std::vector<Vector3d>(vertices.size(), Vector3d::Zero()),
                       {},
                       {triangles.begin(), triangles.end()},
                       border_edges(mesh),
                       {}};
  surface.corners = corners_of(surface.points, surface.border);
  // Each corner's share is found beside the others', and added in one order.
  const auto shares_of = [&](const std::array<int, 3>& t) {
    const auto corner = [&](std::size_t c) -> const Vector3d& {
      return vertices[static_cast<std::size_t>(t[c % 3])];
    };
    const Vector3d normal = side * (corner(1) - corner(0)).cross(corner(2) - corner(0)).stableNormalized();
    std::array<Vector3d, 3> shares;
    for (std::size_t c = 0; c < 3; ++c)
      shares[c] = angle_at(corner(c), corner(c + 1), corner(c + 2)) * normal;
    return shares;
  };
  constexpr std::size_t kBlock = 1 << 12, kAtOnce = 1 << 16;
  std::vector<std::array<Vector3d, 3>> shares(std::min(kAtOnce, triangles.size()));
  for (std::size_t from = 0; from < triangles.size(); from += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, triangles.size() - from);
    surface::for_blocks(count, kBlock, [&](std::size_t first, std::size_t last) {
      gpu::stop_point();
      for (std::size_t i = first; i < last; ++i) shares[i] = shares_of(triangles[from + i]);
    });
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t c = 0; c < 3; ++c)
        surface.normals[static_cast<std::size_t>(triangles[from + i][c])] += shares[i][c];
    }
  }
  for (Vector3d& n : surface.normals) n.stableNormalize();
  surface.bends =
      surface_bends(surface.points, surface.normals, surface.triangles, surface.border, kBendOver_mm);
  return surface;
}

bool lies_behind(const std::vector<SweepSeam>& seams, const Vector3d& p) {
  return std::all_of(seams.begin(), seams.end(),
                     [&](const SweepSeam& seam) { return seam.normal.dot(p) < seam.at_mm; });
}

WasteSurface part_of(const WasteSurface& surface, const std::vector<SweepSeam>& seams, double reach_mm) {
  WasteSurface part;
  const BehindSeams near(seams, surface.points.size(), reach_mm,
                         [&](std::size_t i) -> const Vector3d& { return surface.points[i]; });
  // Counted first: vectors of millions would be copied again and again as they grow.
  std::vector<int> index(surface.points.size(), -1);
  std::size_t points = 0, triangles = 0;
  for (const auto& t : surface.triangles) {
    gpu::stop_point();
    if (!near.in_reach(t)) continue;
    ++triangles;
    for (const int v : t) {
      int& i = index[static_cast<std::size_t>(v)];
      if (i < 0) i = static_cast<int>(points++);
    }
  }
  part.points.resize(points);
  part.normals.resize(points);
  part.bends.resize(points);
  for (std::size_t v = 0; v < index.size(); ++v) {
    gpu::stop_point();
    if (index[v] < 0) continue;
    part.points[static_cast<std::size_t>(index[v])] = surface.points[v];
    part.normals[static_cast<std::size_t>(index[v])] = surface.normals[v];
    part.bends[static_cast<std::size_t>(index[v])] = surface.bends[v];
  }
  part.triangles.reserve(triangles);
  const auto at = [&](int v) { return index[static_cast<std::size_t>(v)]; };
  for (const auto& t : surface.triangles) {
    gpu::stop_point();
    if (near.in_reach(t)) part.triangles.push_back({at(t[0]), at(t[1]), at(t[2])});
  }
  for (const auto& [a, b] : surface.border) {
    if (at(a) >= 0 && at(b) >= 0) part.border.push_back(std::minmax(at(a), at(b)));
  }
  std::sort(part.border.begin(), part.border.end());
  for (const int corner : surface.corners) {
    if (at(corner) >= 0) part.corners.push_back(at(corner));
  }
  std::sort(part.corners.begin(), part.corners.end());
  if (surface.few) part.few = std::make_shared<WasteSurface>(part_of(*surface.few, seams, reach_mm));
  return part;
}

namespace {

// The normals at a triangle's corners, summed and weighed by its area.
template <typename Take>
void for_leaning(const WasteSurface& surface, const Take& take) {
  for (const auto& t : surface.triangles) {
    gpu::stop_point();
    const auto at = [](const std::vector<Vector3d>& all, int i) -> const Vector3d& {
      return all[static_cast<std::size_t>(i)];
    };
    const Vector3d& p = at(surface.points, t[0]);
    const double area = (at(surface.points, t[1]) - p).cross(at(surface.points, t[2]) - p).norm();
    take(p, area * (at(surface.normals, t[0]) + at(surface.normals, t[1]) + at(surface.normals, t[2])));
  }
}

// `mean_in(first, second)` is what the surface leans to by two directions square to the sweep, `whole` the
// size of what it is the sum of.
template <typename Mean>
RibAxes axes_by(const surface::PlaneFamily& planes, const Mean& mean_in) {
  RibAxes axes;
  axes.planes = planes;
  axes.sweep = planes.normal(0);
  const Vector3d u = axes.sweep.unitOrthogonal(), v = axes.sweep.cross(u);
  const Vector3d first = planes.turns() ? planes.axis().cross(axes.sweep).normalized() : u,
                 second = planes.turns() ? axes.sweep.cross(first) : v;
  const auto [mean, whole] = mean_in(first, second);
  constexpr double kNoSide = 1e-9;
  axes.y = first;
  if (mean.norm() > kNoSide * whole) axes.y = (mean.x() * first + mean.y() * second).normalized();
  axes.x = axes.y.cross(axes.sweep);
  return axes;
}

}  // namespace

SurfaceLean lean_of(const WasteSurface& surface) {
  SurfaceLean lean;
  for_leaning(surface, [&](const Vector3d& /*at*/, const Vector3d& n) {
    lean.sum += n;
    lean.whole += n.norm();
  });
  return lean;
}

RibAxes parallel_axes(const SurfaceLean& lean, const surface::PlaneFamily& planes) {
  return axes_by(planes, [&](const Vector3d& first, const Vector3d& second) {
    return std::pair(Eigen::Vector2d(lean.sum.dot(first), lean.sum.dot(second)), lean.whole);
  });
}

RibAxes sweep_axes(const WasteSurface& surface, const surface::PlaneFamily& planes) {
  if (!planes.turns()) return parallel_axes(lean_of(surface), planes);
  return axes_by(planes, [&](const Vector3d& first, const Vector3d& second) {
    std::pair mean(Eigen::Vector2d(0, 0), 0.0);
    for_leaning(surface, [&](const Vector3d& at, const Vector3d& n) {
      mean.first += Eigen::Vector2d(n.dot(planes.turned_to(first, at)), n.dot(planes.turned_to(second, at)));
      mean.second += n.norm();
    });
    return mean;
  });
}

SweepData sweep_sections(const WasteSurface& surface, const RibAxes& axes,
                         const SweepSectionOptions& options) {
  return sweep_sections(MovedSurface(surface, axes, options), options);
}

SweepData sweep_sections(const MovedSurface& moved, const SweepSectionOptions& options) {
  return Slicer(moved, options).run();
}

}  // namespace hotblade::pipeline

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
#include "pipeline/plan/sweep/section_cells.hpp"
#include "surface/read/blocks.hpp"

namespace hotblade::pipeline {

namespace {

using Eigen::Vector3d;

// The end sections lie this far inside; two more follow, as the border's corners are met there.
constexpr std::array<double, 3> kEndInsets_mm{0.05, 2.5, 7};

double angle_at(const Vector3d& p, const Vector3d& q, const Vector3d& r) {
  const Vector3d a = q - p, b = r - p;
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// A vertex of the moved surface.
struct MovedVertex {
  Vector3d at;           // x, y in its plane, and its plane's offset
  Vector3d world;        // the same point in space
  Vector3d own, own_at;  // the design's point, in space and as `at`
  double along = 0;      // component of the normal along the sweep
  double turn = 0;       // in the plane between the normal and y: 1 less the angle's cosine
};

Vector3d in_planes(const RibAxes& axes, const Vector3d& p) {
  const double offset = axes.planes.offset(p);
  const Frame plane = axes.plane(offset);
  const Vector3d d = p - plane.origin;
  return {d.dot(plane.x), d.dot(plane.y), offset};
}

MovedVertex moved(const Vector3d& point, const Vector3d& normal, const RibAxes& axes,
                  const SweepSectionOptions& options) {
  MovedVertex v;
  v.own = point;
  v.own_at = in_planes(axes, point);
  const Frame plane = axes.plane(v.own_at.z());
  const Vector3d n(normal.dot(plane.x), normal.dot(plane.y), normal.dot(axes.planes.normal(v.own_at.z())));
  double kerf_mm = options.kerf_mm;
  const auto band = [&](double across) { return 0.5 * (kerf_mm + options.width_mm * std::abs(across)); };
  v.along = n.z();
  const double in_plane = n.head<2>().norm();
  v.turn = in_plane > 0 ? 1 - n.y() / in_plane : 0;
  if (options.bands) kerf_mm = options.bands->band_mm(point + band(n.z()) * normal);
  v.world = point + band(n.z()) * normal;
  v.at = in_planes(axes, v.world);
  if (options.sag) {
    const SweepSag::Value sag = options.sag->at(v.at.z(), v.at.x());
    // The width stands along the planes' normal, turned by the twist away from the curve's left.
    const double left = n.y() * std::cos(sag.theta) - n.x() * std::sin(sag.theta);
    v.world = point + band(n.z() - sag.twist_rad * left) * normal - sag.droop_mm * axes.sweep;
    v.at = in_planes(axes, v.world);
  }
  return v;
}

MovedVertex between(const MovedVertex& a, const MovedVertex& b, double t) {
  return {a.at + t * (b.at - a.at),          a.world + t * (b.world - a.world),
          a.own + t * (b.own - a.own),       a.own_at + t * (b.own_at - a.own_at),
          a.along + t * (b.along - a.along), a.turn + t * (b.turn - a.turn)};
}

double behind(const SweepSeam& seam, const Vector3d& p) {
  return seam.at_mm - seam.normal.dot(p);
}

// For every vertex the seams that it lies behind, or before by no more than `reach_mm`: a bit each.
class BehindSeams {
 public:
  template <typename At>
  BehindSeams(const std::vector<SweepSeam>& seams, std::size_t vertices, double reach_mm, const At& at)
      : of_(vertices, 0) {
    // Each is of a split of its own, and no part is split so often.
    constexpr std::size_t kMost = 63;
    if (seams.size() > kMost) throw std::logic_error("BehindSeams: more seams than bits");
    all_ = (std::uint64_t{1} << seams.size()) - 1;
    for (std::size_t i = 0; i < vertices; ++i) {
      for (std::size_t k = 0; k < seams.size(); ++k)
        of_[i] |= static_cast<std::uint64_t>(behind(seams[k], at(i)) >= -reach_mm) << k;
    }
  }

  [[nodiscard]] bool all(int v) const { return of_[static_cast<std::size_t>(v)] == all_; }
  // Whether a part of a triangle may lie behind all of them.
  [[nodiscard]] bool in_reach(const std::array<int, 3>& t) const {
    return (of_[static_cast<std::size_t>(t[0])] | of_[static_cast<std::size_t>(t[1])] |
            of_[static_cast<std::size_t>(t[2])]) == all_;
  }

 private:
  std::uint64_t all_ = 0;
  std::vector<std::uint64_t> of_;
};

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

// Of a slope by its sine.
double cosine_of(double along) {
  const double sine = std::min(1.0, std::abs(along));
  return std::sqrt(1 - sine * sine);
}

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
  Slicer(const WasteSurface& surface, const RibAxes& axes, const SweepSectionOptions& options)
      : surface_(surface), axes_(axes), options_(options) {
    constexpr std::size_t kVertices = 1 << 12;
    vertices_.resize(surface.points.size());
    surface::for_blocks(vertices_.size(), kVertices, [&](std::size_t first, std::size_t last) {
      gpu::stop_point();
      for (std::size_t i = first; i < last; ++i)
        vertices_[i] = moved(surface.points[i], surface.normals[i], axes, options);
    });
    data_.axes = axes;
    behind_.emplace(options_.seams, vertices_.size(), 0,
                    [&](std::size_t i) -> const Vector3d& { return vertices_[i].world; });
  }

  SweepData run() {
    if (!measure() || (options_.if_followable && !data_.followable())) return std::move(data_);
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
  using Triangle = std::array<MovedVertex, 3>;

  // Its corners; a triangle that the planes are cut open at lies whole at their end.
  [[nodiscard]] Triangle triangle(std::size_t t) const {
    Triangle corners;
    for (std::size_t c = 0; c < 3; ++c)
      corners[c] = vertices_[static_cast<std::size_t>(surface_.triangles[t][c])];
    const double half_turn = std::numbers::pi * axes_.planes.radius_mm();
    const auto [low, high] = std::minmax({corners[0].at.z(), corners[1].at.z(), corners[2].at.z()});
    if (half_turn > 0 && high - low > half_turn) {
      for (MovedVertex& v : corners) {
        if (v.at.z() < 0) v.at.z() += 2 * half_turn;
      }
    }
    return corners;
  }

  void add(double offset) {
    if (offset > data_.first_mm && offset < data_.last_mm) offsets_.push_back(offset);
  }

  [[nodiscard]] bool inside(const Vector3d& p) const {
    return std::all_of(options_.seams.begin(), options_.seams.end(),
                       [&](const SweepSeam& seam) { return behind(seam, p) >= 0; });
  }

  // Sections close to each corner, on both sides of it. A border that is all corners is met often enough.
  void add_corners() {
    constexpr std::size_t kMostCorners = 12;
    constexpr double kBesideMm = 0.5;
    if (surface_.corners.size() > kMostCorners) return;
    for (const int corner : surface_.corners) {
      const MovedVertex& v = vertices_[static_cast<std::size_t>(corner)];
      if (!behind_->all(corner)) continue;
      for (const double offset : {v.at.z() - kBesideMm, v.at.z() + kBesideMm}) add(offset);
    }
  }

  void add_border() {
    std::vector<int> points;
    for (const auto& [a, b] : surface_.border) points.insert(points.end(), {a, b});
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    for (const int i : points) {
      const MovedVertex& v = vertices_[static_cast<std::size_t>(i)];
      if (behind_->all(i)) data_.border.emplace_back(v.at.z(), v.at.head<2>());
    }
  }

  // What of a triangle lies behind all seams.
  [[nodiscard]] std::vector<MovedVertex> clipped(std::size_t t) const {
    const Triangle corners = triangle(t);
    std::vector<MovedVertex> polygon(corners.begin(), corners.end());
    for (const SweepSeam& seam : options_.seams) {
      std::vector<MovedVertex> next;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const MovedVertex &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double from = behind(seam, a.world), to = behind(seam, b.world);
        if (from >= 0) next.push_back(a);
        if ((from >= 0) != (to >= 0)) next.push_back(between(a, b, from / (from - to)));
      }
      polygon = std::move(next);
    }
    return polygon;
  }

  // Extents of what lies behind the seams; false where nothing does.
  bool measure() {
    constexpr double kInf = std::numeric_limits<double>::infinity();
    data_.first_mm = kInf;
    data_.last_mm = -kInf;
    data_.low.setConstant(kInf);
    data_.high.setConstant(-kInf);
    std::vector<bool> seen(vertices_.size(), false);
    std::vector<Vector3d> own;
    for (std::size_t t = 0; t < surface_.triangles.size(); ++t) {
      gpu::stop_point();
      const auto& corners = surface_.triangles[t];
      if (!behind_->in_reach(corners)) continue;
      const bool whole = !axes_.planes.closed() &&
                         std::all_of(corners.begin(), corners.end(), [&](int c) { return behind_->all(c); });
      if (!whole) {
        for (const MovedVertex& v : clipped(t)) extend(v, own);
        continue;
      }
      for (const int c : corners) {
        const auto i = static_cast<std::size_t>(c);
        if (!seen[i]) extend(vertices_[i], own);
        seen[i] = true;
      }
    }
    if (!(data_.last_mm > data_.first_mm)) return false;
    // A few bad facets of a file turn normals anyhow: what they come to is seen when the cut is verified.
    const auto most = [](std::vector<double>& values) {
      constexpr double kShare = 0.98;
      const auto at =
          values.begin() + static_cast<std::ptrdiff_t>(kShare * static_cast<double>(values.size() - 1));
      std::nth_element(values.begin(), at, values.end());
      return *at;
    };
    data_.steepest_rad = std::asin(std::min(1.0, most(steeps_)));
    data_.turn_rad = std::acos(std::clamp(1 - most(turns_), -1.0, 1.0));
    measure_size(own);
    find_seams();
    return true;
  }

  void extend(const MovedVertex& v, std::vector<Vector3d>& own) {
    data_.first_mm = std::min(data_.first_mm, v.at.z());
    data_.last_mm = std::max(data_.last_mm, v.at.z());
    data_.low = data_.low.cwiseMin(v.own_at.head<2>());
    data_.high = data_.high.cwiseMax(v.own_at.head<2>());
    steeps_.push_back(std::abs(v.along));
    turns_.push_back(v.turn);
    own.push_back(v.own);
  }

  void measure_size(const std::vector<Vector3d>& own) {
    const double middle = 0.5 * (data_.first_mm + data_.last_mm);
    const Frame plane = axes_.plane(middle);
    const Vector3d sweep = axes_.planes.normal(middle);
    for (const Vector3d& p : own) data_.box.extend(Vector3d(p.dot(plane.x), p.dot(plane.y), p.dot(sweep)));
  }

  // Seams that lie along the planes end the sweep.
  void find_seams() {
    constexpr double kAlong = 0.99;
    for (const SweepSeam& seam : options_.seams) {
      data_.seam_first |= seam.normal.dot(axes_.planes.normal(data_.first_mm)) < -kAlong;
      data_.seam_last |= seam.normal.dot(axes_.planes.normal(data_.last_mm)) > kAlong;
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
      if (!behind_->in_reach(surface_.triangles[t])) continue;
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
      const Triangle corners = triangle(t);
      return among(corners[0].at.z(), corners[1].at.z(), corners[2].at.z());
    }
    const auto& at = surface_.triangles[t];
    const auto offset = [&](std::size_t c) { return vertices_[static_cast<std::size_t>(at[c])].at.z(); };
    return among(offset(0), offset(1), offset(2));
  }

  // Samples of a section of these triangles.
  [[nodiscard]] std::vector<SweepSample> section_of(const std::vector<int>& met, std::size_t k) {
    SectionCells cells(options_.sample_mm);
    for (const int i : met) {
      const auto t = static_cast<std::size_t>(i);
      const Triangle corners = triangle(t);
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
    for (const SweepSeam& seam : options_.seams) {
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

  const WasteSurface& surface_;
  const RibAxes& axes_;
  SweepSectionOptions options_;
  std::vector<MovedVertex> vertices_;
  std::optional<BehindSeams> behind_;  // of these, as the blade passes them
  std::vector<double> offsets_;
  std::vector<std::vector<std::pair<double, double>>>
      runs_;                            // in x, of each section, where gaps are looked for
  std::vector<double> steeps_, turns_;  // sines of slopes and MovedVertex::turn of all that is measured
  SweepData data_;
};

}  // namespace

FormedPoint formed_point(const Vector3d& point, const Vector3d& normal, const RibAxes& axes,
                         const SweepSectionOptions& options) {
  const MovedVertex v = moved(point, normal, axes, options);
  return {v.at.z(), {v.at.head<2>(), cosine_of(v.along), false}};
}

WasteSurface waste_surface(const surface::TriangleMesh& mesh, double side) {
  const auto vertices = mesh.vertices();
  const auto triangles = mesh.triangles();
  WasteSurface surface{{vertices.begin(), vertices.end()},
                       std::vector<Vector3d>(vertices.size(), Vector3d::Zero()),
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
  return surface;
}

WasteSurface part_of(const WasteSurface& surface, const std::vector<SweepSeam>& seams, double reach_mm) {
  WasteSurface part;
  std::vector<int> index(surface.points.size(), -1);
  const auto taken = [&](int v) {
    int& i = index[static_cast<std::size_t>(v)];
    if (i >= 0) return i;
    i = static_cast<int>(part.points.size());
    part.points.push_back(surface.points[static_cast<std::size_t>(v)]);
    part.normals.push_back(surface.normals[static_cast<std::size_t>(v)]);
    return i;
  };
  const BehindSeams near(seams, surface.points.size(), reach_mm,
                         [&](std::size_t i) -> const Vector3d& { return surface.points[i]; });
  for (const auto& t : surface.triangles) {
    gpu::stop_point();
    if (near.in_reach(t)) part.triangles.push_back({taken(t[0]), taken(t[1]), taken(t[2])});
  }
  const auto at = [&](int v) { return index[static_cast<std::size_t>(v)]; };
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

RibAxes sweep_axes(const WasteSurface& surface, const surface::PlaneFamily& planes) {
  RibAxes axes;
  axes.planes = planes;
  axes.sweep = planes.normal(0);
  const Vector3d u = axes.sweep.unitOrthogonal(), v = axes.sweep.cross(u);
  const Vector3d first = planes.turns() ? planes.axis().cross(axes.sweep).normalized() : u,
                 second = planes.turns() ? axes.sweep.cross(first) : v;
  Eigen::Vector2d mean(0, 0);
  double whole = 0;
  for (const auto& t : surface.triangles) {
    gpu::stop_point();
    const auto at = [](const std::vector<Vector3d>& all, int i) -> const Vector3d& {
      return all[static_cast<std::size_t>(i)];
    };
    const Vector3d& p = at(surface.points, t[0]);
    const double area = (at(surface.points, t[1]) - p).cross(at(surface.points, t[2]) - p).norm();
    const Vector3d n =
        area * (at(surface.normals, t[0]) + at(surface.normals, t[1]) + at(surface.normals, t[2]));
    const double offset = planes.turns() ? planes.offset(p) : 0;
    mean += Eigen::Vector2d(n.dot(planes.turned(first, offset)), n.dot(planes.turned(second, offset)));
    whole += n.norm();
  }
  constexpr double kNoSide = 1e-9;
  axes.y = first;
  if (mean.norm() > kNoSide * whole) axes.y = (mean.x() * first + mean.y() * second).normalized();
  axes.x = axes.y.cross(axes.sweep);
  return axes;
}

SweepData sweep_sections(const WasteSurface& surface, const RibAxes& axes,
                         const SweepSectionOptions& options) {
  return Slicer(surface, axes, options).run();
}

}  // namespace hotblade::pipeline

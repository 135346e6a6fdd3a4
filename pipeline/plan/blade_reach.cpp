#include "pipeline/plan/blade_reach.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "gpu/backend/stop.hpp"
#include "gpu/mesh/mesh_distance.hpp"

namespace hotblade::pipeline {

namespace {

using Eigen::Vector3d;

// The longest that a curve's chord tells of.
double longest_half_mm(const CutLimits& limits) {
  return 0.5 * std::numbers::pi / limits.curvature_per_mm;
}

// A design round a place.
class Surroundings {
 public:
  // What lies within `around_mm` of the place can be asked about.
  Surroundings(const surface::TriangleMesh& mesh, const Vector3d& place, double around_mm,
               const CutLimits& limits)
      : vertices_(mesh.vertices()), limits_(limits) {
    constexpr double kAllowed = 4;  // tolerances and spacings beyond a ring's radius
    const double reach = around_mm + 1.1 * longest_half_mm(limits) + kAllowed * limits.tolerance_mm;
    const auto near = [&](const std::array<int, 3>& t) {
      Eigen::AlignedBox3d box(at(t[0]));
      box.extend(at(t[1]));
      box.extend(at(t[2]));
      return box.exteriorDistance(place) <= reach;
    };
    const auto triangles = mesh.triangles();
    for (const auto& t : triangles) {
      if (!near(t)) continue;
      const Vector3d &a = at(t[0]), &b = at(t[1]), &c = at(t[2]);
      pieces_.push_back({t, (a + b + c) / 3, std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()}), 0});
    }
    for (const Piece& piece : pieces_) longest_ = std::max(longest_, piece.longest);
    // In columns along x, by y in each: most lengths asked about are short beside `reach`.
    constexpr double kColumns = 32;
    column_mm_ = std::max(longest_, 2 * reach / kColumns);
    for (Piece& piece : pieces_) piece.column = column_of(piece.middle.x());
    std::sort(pieces_.begin(), pieces_.end(),
              [](const Piece& a, const Piece& b) { return a.key() < b.key(); });
    constexpr double kFew = 6;  // in a length that is asked about
    for (const double half : ladder())
      if (half > kFew * longest_) few_.emplace(half, spread_pieces(half / kFew));
    std::vector<std::array<int, 3>> edges;  // as triangles without width
    for (const int corner : mesh.border()) {
      const auto& t = triangles[static_cast<std::size_t>(corner) / 3];
      const std::size_t k = static_cast<std::size_t>(corner) % 3;
      if (near(t)) edges.push_back({t[k], t[(k + 1) % 3], t[k]});
    }
    if (!edges.empty()) border_.emplace(vertices_, edges);
  }

  [[nodiscard]] bool may_tell(const Vector3d& p, double half_mm) const {
    return half_mm < most_half_mm(p) && half_mm <= longest_half_mm(limits_);
  }

  // Whether no two samples of the surface, whose spacing is this, are as a and b would have to be: `doubt_mm`
  // more than these are off P, and within it of their distance from it. Two of the few that are looked at
  // first are as good as any.
  [[nodiscard]] bool lacks(const Vector3d& p, double half_mm, double spacing_mm, double doubt_mm) const {
    const double k = limits_.curvature_per_mm, t = limits_.tolerance_mm;
    const double chord = 2 / k * std::sin(0.5 * k * half_mm),
                 allowed = k * half_mm * half_mm + 4 * t + 2 * doubt_mm;
    const Ring ring{p, chord - 2 * t - doubt_mm, half_mm + 2 * t + doubt_mm};
    const auto few = few_.find(half_mm);
    std::vector<Vector3d> points;
    visit(few == few_.end() ? pieces_ : few->second, ring, [&](const Piece& piece) {
      if (ring.holds(piece.middle)) points.push_back(piece.middle - p);
      return true;
    });
    if (has_two(points, allowed)) return false;
    std::optional<std::vector<Vector3d>> samples = samples_in(ring, spacing_mm);
    return samples && !has_two(*samples, allowed);
  }

  // By samples that are a small part of what is allowed for anyway apart, with all of their doubt.
  [[nodiscard]] bool proved(const Vector3d& p, double half_mm) const {
    constexpr double kOfTolerance = 0.3, kOfLength = 1.0 / 40;
    const double spacing = std::max(kOfTolerance * limits_.tolerance_mm, kOfLength * half_mm);
    return lacks(p, half_mm, spacing, spacing);
  }

  // As few samples tell, as if they were all.
  [[nodiscard]] bool seems(const Vector3d& p, double half_mm) const {
    constexpr double kOfTolerance = 0.5, kOfLength = 1.0 / 12;
    return lacks(p, half_mm, std::max(kOfTolerance * limits_.tolerance_mm, kOfLength * half_mm), 0);
  }

  // Half lengths that are asked about.
  [[nodiscard]] std::vector<double> ladder() const {
    // Over the root of four of these a circle of the blade's radius rises by two tolerances: nothing is told
    // of much shorter lengths.
    const double unit = std::sqrt(limits_.tolerance_mm / limits_.curvature_per_mm);
    constexpr double kStep = 1.25;
    std::vector<double> halves;
    double half = unit;
    while (half < longest_half_mm(limits_)) {
      halves.push_back(half);
      half *= kStep;
    }
    return halves;
  }

  // Lengths from here on a blade may leave the design.
  [[nodiscard]] double most_half_mm(const Vector3d& p) const {
    return border_mm(p) - 2 * limits_.tolerance_mm;
  }

 private:
  [[nodiscard]] const Vector3d& at(int v) const { return vertices_[static_cast<std::size_t>(v)]; }

  [[nodiscard]] double border_mm(const Vector3d& p) const {
    return border_ ? border_->query(std::span(&p, 1)).front().distance
                   : std::numeric_limits<double>::infinity();
  }

  // What is as far as this from a place.
  struct Ring {
    Vector3d place;
    double from_mm, to_mm;
    [[nodiscard]] bool holds(const Vector3d& q) const {
      const double d = (q - place).norm();
      return d >= from_mm && d <= to_mm;
    }
  };
  struct Piece;

  // Calls each(piece) for all that may have a point in a ring, until that is false; whether it never was.
  template <typename Each>
  bool visit(const std::vector<Piece>& pieces, const Ring& ring, const Each& each) const {
    const double farthest = ring.to_mm + longest_, y = ring.place.y();
    const long last = column_of(ring.place.x() + farthest);
    for (long column = column_of(ring.place.x() - farthest); column <= last; ++column) {
      auto next = std::lower_bound(pieces.begin(), pieces.end(), std::pair(column, y - farthest),
                                   [](const Piece& piece, const auto& key) { return piece.key() < key; });
      for (; next != pieces.end() && next->key() <= std::pair(column, y + farthest); ++next) {
        if (!each(*next)) return false;
      }
    }
    return true;
  }

  // Samples of the surface in a ring, as seen from its place; no point of the surface there is farther from
  // one than the spacing. None where a facet would take thousands: a design says nothing of lengths that are
  // small beside its facets.
  [[nodiscard]] std::optional<std::vector<Vector3d>> samples_in(const Ring& ring, double spacing_mm) const {
    std::vector<Vector3d> points;
    const bool all = visit(pieces_, ring,
                           [&](const Piece& piece) { return add_samples(piece, ring, spacing_mm, points); });
    if (!all) return std::nullopt;
    return points;
  }

  // Whether two of these, as seen from the place, lie opposite each other but for so much.
  [[nodiscard]] static bool has_two(std::vector<Vector3d>& points, double allowed_mm) {
    const auto by_x = [](const Vector3d& a, const Vector3d& b) { return a.x() < b.x(); };
    std::sort(points.begin(), points.end(), by_x);
    return std::any_of(points.begin(), points.end(), [&](const Vector3d& a) {
      auto b = std::lower_bound(points.begin(), points.end(), Vector3d(-a.x() - allowed_mm, 0, 0), by_x);
      for (; b != points.end() && b->x() <= -a.x() + allowed_mm; ++b)
        if ((a + *b).squaredNorm() <= allowed_mm * allowed_mm) return true;
      return false;
    });
  }

  struct Piece {
    std::array<int, 3> corners;
    Vector3d middle;
    double longest;   // edge: no point of the triangle is farther from its middle
    long column = 0;  // of the middle
    [[nodiscard]] std::pair<long, double> key() const { return {column, middle.y()}; }
  };

  // One piece in each cell: their middles show most often that a blade may follow so far.
  [[nodiscard]] std::vector<Piece> spread_pieces(double cell_mm) const {
    std::set<std::array<long, 3>> taken;
    std::vector<Piece> spread;
    for (const Piece& piece : pieces_) {
      const Vector3d cell = piece.middle / cell_mm;
      if (taken.insert({std::lround(cell.x()), std::lround(cell.y()), std::lround(cell.z())}).second)
        spread.push_back(piece);
    }
    return spread;
  }

  [[nodiscard]] long column_of(double x) const { return std::lround(x / column_mm_); }

  // Those of a piece; whether they are not too many.
  [[nodiscard]] bool add_samples(const Piece& piece, const Ring& ring, double spacing_mm,
                                 std::vector<Vector3d>& points) const {
    const double off = (piece.middle - ring.place).norm();
    if (off > ring.to_mm + piece.longest || off < ring.from_mm - piece.longest) return true;
    const Vector3d a = at(piece.corners[0]), b = at(piece.corners[1]) - a, c = at(piece.corners[2]) - a;
    constexpr double kMostParts = 64;  // of an edge
    if (piece.longest > kMostParts * spacing_mm) return false;
    const int parts = std::max(1, static_cast<int>(std::ceil(piece.longest / spacing_mm)));
    for (int i = 0; i <= parts; ++i) {
      for (int j = 0; i + j <= parts; ++j) {
        const Vector3d q = a + b * i / parts + c * j / parts;
        if (ring.holds(q)) points.push_back(q - ring.place);
      }
    }
    return true;
  }

  std::span<const Vector3d> vertices_;
  CutLimits limits_;
  std::vector<Piece> pieces_;                   // by their columns
  std::map<double, std::vector<Piece>> few_{};  // of them, for half lengths that take many
  double longest_ = 0, column_mm_ = 1;
  std::optional<gpu::MeshDistance> border_;
};

// Of the vertices near a place one in each cell of a grid, the nearest to it.
std::vector<Vector3d> spread_vertices(std::span<const Vector3d> vertices, const Vector3d& place,
                                      double around_mm) {
  constexpr double kAcross = 40;  // cells
  std::map<std::array<long, 3>, Vector3d> cells;
  for (const Vector3d& v : vertices) {
    if ((v - place).norm() > around_mm) continue;
    const Vector3d cell = (v - place) * kAcross / (2 * around_mm);
    const std::array<long, 3> key{std::lround(cell.x()), std::lround(cell.y()), std::lround(cell.z())};
    const auto [own, is_new] = cells.try_emplace(key, v);
    if (!is_new && (v - place).norm() < (own->second - place).norm()) own->second = v;
  }
  std::vector<Vector3d> spread;
  spread.reserve(cells.size());
  for (const auto& [key, v] : cells) spread.push_back(v);
  return spread;
}

}  // namespace

bool no_blade_follows(const surface::TriangleMesh& mesh, const Vector3d& p, double half_mm,
                      const CutLimits& limits) {
  const Surroundings around(mesh, p, 0, limits);
  return around.may_tell(p, half_mm) && around.proved(p, half_mm);
}

std::optional<BladeReach> shortest_reach(const surface::TriangleMesh& mesh, const Vector3d& place,
                                         double around_mm, const CutLimits& limits) {
  constexpr std::size_t kMostProofs = 12;
  const std::vector<Vector3d> places = spread_vertices(mesh.vertices(), place, around_mm);
  const Surroundings around(mesh, place, around_mm, limits);
  const std::vector<double> ladder = around.ladder();
  std::vector<double> most(places.size()), seeming(places.size(), std::numeric_limits<double>::infinity());
  tbb::parallel_for(std::size_t{0}, places.size(),
                    [&](std::size_t i) { most[i] = around.most_half_mm(places[i]); });
  gpu::stop_point();
  // Places that blades seem to follow least come first, among them those nearest to the one that is asked:
  // longer ways, which take more samples, are not looked at once there are enough.
  std::vector<std::size_t> first;
  for (const double half : ladder) {
    if (first.size() >= kMostProofs) break;
    tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t i) {
      if (!std::isfinite(seeming[i]) && half < most[i] && around.seems(places[i], half)) seeming[i] = half;
    });
    gpu::stop_point();
    for (std::size_t i = 0; i < places.size(); ++i)
      if (seeming[i] == half) first.push_back(i);
  }
  std::stable_sort(first.begin(), first.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(seeming[a], (places[a] - place).norm()) <
           std::pair(seeming[b], (places[b] - place).norm());
  });
  if (first.size() > kMostProofs) first.resize(kMostProofs);
  std::vector<double> halves(first.size(), std::numeric_limits<double>::infinity());
  tbb::parallel_for(std::size_t{0}, first.size(), [&](std::size_t k) {
    const std::size_t i = first[k];
    for (const double half : ladder) {
      if (!(half < most[i])) break;
      if (half < seeming[i] || !around.proved(places[i], half)) continue;
      halves[k] = half;
      break;
    }
  });
  gpu::stop_point();
  const auto shortest = std::min_element(halves.begin(), halves.end());
  if (shortest == halves.end() || !std::isfinite(*shortest)) return std::nullopt;
  const std::size_t i = first[static_cast<std::size_t>(shortest - halves.begin())];
  return BladeReach{*shortest, places[i]};
}

}  // namespace hotblade::pipeline

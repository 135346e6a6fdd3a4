#include "surface/slice/smooth_faces.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include "surface/slice/face_turn.hpp"
#include "surface/slice/fold_limits.hpp"

namespace hotblade::surface {
namespace {

using Eigen::Vector3d;

// Creases that fade out inside a surface, as those of a groin vault do towards its crown, led on along the
// mesh's edges until they meet.
class Bridges {
 public:
  Bridges(const TriangleMesh& mesh, const Creases& creases) : mesh_(mesh) {
    const std::size_t count = mesh.vertices().size();
    beside_.resize(count);
    for (int corner = 0; corner < static_cast<int>(3 * mesh.triangles().size()); ++corner) {
      const int from = vertex_at(mesh, corner), to = vertex_at(mesh, next_corner(corner));
      const int other = mesh.beyond(corner);
      if (other == TriangleMesh::kNone || other > corner) {
        beside_[static_cast<std::size_t>(from)].push_back({to, corner});
        beside_[static_cast<std::size_t>(to)].push_back({from, corner});
      }
    }
    stops_.assign(count, false);
    for (const int corner : mesh.border()) {
      stops_[static_cast<std::size_t>(vertex_at(mesh, corner))] = true;
      stops_[static_cast<std::size_t>(vertex_at(mesh, next_corner(corner)))] = true;
    }
    for (const int face : creases.bands)
      for (const int v : mesh.triangles()[static_cast<std::size_t>(face)])
        stops_[static_cast<std::size_t>(v)] = true;
    creases_.resize(count);
    for (const int corner : creases.edges) {
      const int from = vertex_at(mesh, corner), to = vertex_at(mesh, next_corner(corner));
      creases_[static_cast<std::size_t>(from)].push_back({to, corner});
      creases_[static_cast<std::size_t>(to)].push_back({from, corner});
    }
  }

  // Corners of the edges that join creases. All are led on at once, an edge at a time, so that they meet
  // halfway.
  [[nodiscard]] std::vector<int> run() const {
    std::vector<Way> ways;
    std::vector<int> ends;  // where they begin
    for (int v = 0; v < static_cast<int>(creases_.size()); ++v) {
      if (creases_[static_cast<std::size_t>(v)].size() == 1 && !stops_[static_cast<std::size_t>(v)]) {
        ways.push_back(on_from(v));
        ends.push_back(v);
      }
    }
    struct Visit {
      std::size_t way = 0, steps = 0;
    };
    std::map<int, Visit> visited;
    std::vector<std::size_t> met(ways.size(), 0);  // steps until a way meets something
    std::size_t longest = 0;
    for (const Way& way : ways) longest = std::max(longest, way.size());
    for (std::size_t step = 0; step < longest; ++step) {
      for (std::size_t w = 0; w < ways.size(); ++w) {
        if (met[w] > 0 || step >= ways[w].size()) continue;
        const int to = ways[w][step].to;
        const auto [before, fresh] = visited.try_emplace(to, Visit{w, step + 1});
        if (fresh && !ends_at(to)) continue;
        met[w] = step + 1;
        if (!fresh && met[before->second.way] == 0) met[before->second.way] = before->second.steps;
      }
    }
    // An end that two others lead to, as hips do to their ridge's, is open no more, unless others meet it on
    // its way.
    std::map<int, int> meet_at;
    const auto end_of = [&](std::size_t w) { return ways[w][met[w] - 1].to; };
    for (std::size_t w = 0; w < ways.size(); ++w)
      if (met[w] > 0) ++meet_at[end_of(w)];
    for (std::size_t w = 0; w < ways.size(); ++w) {
      if (met[w] == 0) continue;
      const auto others = [&](int v) {
        const auto at = meet_at.find(v);
        return at == meet_at.end() ? 0 : at->second - (end_of(w) == v ? 1 : 0);
      };
      const auto met_at = ways[w].begin() + static_cast<std::ptrdiff_t>(met[w]);
      if (others(ends[w]) < 2 ||
          std::any_of(ways[w].begin(), met_at, [&](const Step& step) { return others(step.to) > 0; }))
        continue;
      --meet_at[end_of(w)];
      met[w] = 0;
    }
    std::vector<int> found;
    for (std::size_t w = 0; w < ways.size(); ++w)
      for (std::size_t step = 0; step < met[w]; ++step) found.push_back(ways[w][step].corner);
    return found;
  }

 private:
  struct Step {
    int to = 0, corner = 0;  // the edge by one of its corners
  };
  using Way = std::vector<Step>;

  [[nodiscard]] const Vector3d& at(int v) const { return mesh_.vertices()[static_cast<std::size_t>(v)]; }
  [[nodiscard]] bool ends_at(int v) const {
    return stops_[static_cast<std::size_t>(v)] || !creases_[static_cast<std::size_t>(v)].empty();
  }

  // Whether the surface still folds at an edge: by more than at the others of its two triangles.
  [[nodiscard]] bool folds_at(int corner) const {
    constexpr double kSharper = 2, kLeast_rad = 1e-3;  // far over the rounding of a flat place
    const auto fold = [&](int c) {
      const int other = mesh_.beyond(c);
      return other == TriangleMesh::kNone ? 0.0 : turn_between(mesh_, c / 3, other / 3);
    };
    double beside = kLeast_rad;
    for (const int own : {corner, mesh_.beyond(corner)}) {
      if (own == TriangleMesh::kNone) return false;
      for (int c = next_corner(own); c != own; c = next_corner(c)) beside = std::max(beside, fold(c));
    }
    return fold(corner) > kSharper * beside;
  }

  // Straight on from a crease's end as long as the surface folds there, and from there for as long as the
  // crease itself is: what faded farther back is another one.
  [[nodiscard]] Way on_from(int end) const {
    constexpr int kLook = 3;        // edges that tell the crease's direction
    constexpr double kAhead = 0.7;  // cosine: edges within 45 degrees of it
    constexpr double kBend = 0.5;   // of what an edge on the way turns the direction by
    double length = 0;
    int before = end, v = creases_[static_cast<std::size_t>(end)].front().to, back = v, edges = 1;
    length += (at(v) - at(end)).norm();
    while (creases_[static_cast<std::size_t>(v)].size() == 2 && v != end) {
      const auto& two = creases_[static_cast<std::size_t>(v)];
      const int next = two[0].to == before ? two[1].to : two[0].to;
      length += (at(next) - at(v)).norm();
      before = std::exchange(v, next);
      if (++edges <= kLook) back = v;
    }
    Vector3d along = (at(end) - at(back)).stableNormalized();
    Way way;
    double gone = 0;
    const std::size_t edges_in_all = mesh_.triangles().size() * 3;  // a way around a ring would go on
    for (v = end; gone < length && way.size() < edges_in_all;) {
      Step best;
      double ahead = kAhead;
      for (const Step& step : beside_[static_cast<std::size_t>(v)]) {
        const double cosine = along.dot((at(step.to) - at(v)).stableNormalized());
        if (cosine <= ahead) continue;
        ahead = cosine;
        best = step;
      }
      if (!(ahead > kAhead)) break;
      if (gone > 0 || !folds_at(best.corner)) gone += (at(best.to) - at(v)).norm();
      along = (along + kBend * (at(best.to) - at(v)).stableNormalized()).stableNormalized();
      way.push_back(best);
      v = best.to;
      if (ends_at(v)) break;
    }
    return way;
  }

  const TriangleMesh& mesh_;
  std::vector<std::vector<Step>> beside_, creases_;  // of each vertex: its edges, those that are creases
  std::vector<bool> stops_;                          // vertices on a border or at a band
};

// Numbers of the pieces that hang together without the edges that are cut; -1 where it is of none.
struct Pieces {
  std::vector<int> of_triangle;
  int count = 0;
};

Pieces pieces(const TriangleMesh& mesh, const std::vector<bool>& cut, const std::vector<int>& left_out) {
  constexpr int kOpen = -2, kNone = -1;
  Pieces found{std::vector<int>(mesh.triangles().size(), kOpen), 0};
  for (const int face : left_out) found.of_triangle[static_cast<std::size_t>(face)] = kNone;
  std::vector<int> open;
  for (std::size_t seed = 0; seed < found.of_triangle.size(); ++seed) {
    if (found.of_triangle[seed] != kOpen) continue;
    open.assign(1, static_cast<int>(seed));
    found.of_triangle[seed] = found.count;
    while (!open.empty()) {
      const int face = open.back();
      open.pop_back();
      for (int corner = 3 * face; corner < 3 * face + 3; ++corner) {
        const int other = mesh.beyond(corner);
        if (other == TriangleMesh::kNone || cut[static_cast<std::size_t>(corner)]) continue;
        int& piece = found.of_triangle[static_cast<std::size_t>(other / 3)];
        if (piece != kOpen) continue;
        piece = found.count;
        open.push_back(other / 3);
      }
    }
    ++found.count;
  }
  return found;
}

// Takes narrow pieces that bands surround away, as those are where bands meet: their triangles are of none.
// Returns those that are left, numbered by their first triangles.
Pieces without_slivers(const TriangleMesh& mesh, Pieces parted) {
  struct Extent {
    double area2_mm2 = 0, beside_mm = 0, banded_mm = 0;  // twice the area; along others; along bands
  };
  std::vector<Extent> extents(static_cast<std::size_t>(parted.count));
  const auto piece_at = [&](int corner) { return parted.of_triangle[static_cast<std::size_t>(corner / 3)]; };
  for (int corner = 0; corner < static_cast<int>(3 * mesh.triangles().size()); ++corner) {
    if (piece_at(corner) < 0) continue;
    Extent& extent = extents[static_cast<std::size_t>(piece_at(corner))];
    if (corner % 3 == 0) extent.area2_mm2 += across_face(mesh, corner / 3).norm();
    const int beyond = mesh.beyond(corner);
    if (beyond == TriangleMesh::kNone || piece_at(beyond) == piece_at(corner)) continue;
    const auto at = [&](int c) { return mesh.vertices()[static_cast<std::size_t>(vertex_at(mesh, c))]; };
    const double length_mm = (at(next_corner(corner)) - at(corner)).norm();
    extent.beside_mm += length_mm;
    if (piece_at(beyond) < 0) extent.banded_mm += length_mm;
  }
  std::vector<int> number(extents.size(), -1);
  Pieces left{std::move(parted.of_triangle), 0};
  for (int& piece : left.of_triangle) {
    if (piece < 0) continue;
    const auto old = static_cast<std::size_t>(piece);
    const Extent& extent = extents[old];
    if (2 * extent.banded_mm > extent.beside_mm && extent.area2_mm2 <= kMostBandMm * extent.beside_mm) {
      piece = -1;
      continue;
    }
    if (number[old] < 0) number[old] = left.count++;
    piece = number[old];
  }
  return left;
}

// Triangles at a border that fold away from the rest by what is no smooth surface's, and end so soon that
// what goes straight on is off by a tolerance at most: triangulations leave such slivers at a hull, of
// points nearly in line. Off these there may be others.
std::vector<int> hull_slivers(const TriangleMesh& mesh, const CreaseLimits& limits) {
  const double least_rad = FoldLimits(limits).least_rad();
  std::vector<bool> gone(mesh.triangles().size(), false);
  const auto beyond = [&](int corner) {
    const int other = mesh.beyond(corner);
    return other == TriangleMesh::kNone || gone[static_cast<std::size_t>(other / 3)] ? TriangleMesh::kNone
                                                                                     : other / 3;
  };
  const auto at = [&](int corner) -> const Vector3d& {
    return mesh.vertices()[static_cast<std::size_t>(vertex_at(mesh, corner))];
  };
  // How far a triangle that has one edge of the rest goes from it.
  const auto reach_mm = [&](int corner) {
    const Vector3d edge = at(next_corner(corner)) - at(corner),
                   out = at(next_corner(next_corner(corner))) - at(corner);
    return (out - std::clamp(out.dot(edge) / edge.squaredNorm(), 0.0, 1.0) * edge).norm();
  };
  const auto is_sliver = [&](int face) {
    double end_mm = 0, beside_mm = 0, off_mm = 0, fold = 0;  // its longest edges at the border and at others
    int beside = 0;
    for (int corner = 3 * face; corner < 3 * face + 3; ++corner) {
      const int other = beyond(corner);
      double& longest_mm = other == TriangleMesh::kNone ? end_mm : beside_mm;
      longest_mm = std::max(longest_mm, (at(next_corner(corner)) - at(corner)).norm());
      if (other == TriangleMesh::kNone) continue;
      ++beside;
      off_mm = reach_mm(corner);
      fold = std::max(fold, turn_between(mesh, face, other));
    }
    // Between two edges of the rest and a longer one it is nowhere farther from them than it is high.
    if (beside == 2) off_mm = across_face(mesh, face).norm() / end_mm;
    return (beside == 1 || (beside == 2 && end_mm >= beside_mm)) && fold > least_rad &&
           off_mm * std::sin(std::min(fold, 0.5 * std::numbers::pi)) <= limits.tolerance_mm;
  };
  std::vector<int> open, slivers;
  for (const int corner : mesh.border()) open.push_back(corner / 3);
  while (!open.empty()) {
    const int face = open.back();
    open.pop_back();
    if (gone[static_cast<std::size_t>(face)] || !is_sliver(face)) continue;
    for (int corner = 3 * face; corner < 3 * face + 3; ++corner)
      if (const int other = beyond(corner); other != TriangleMesh::kNone) open.push_back(other);
    gone[static_cast<std::size_t>(face)] = true;
    slivers.push_back(face);
  }
  std::sort(slivers.begin(), slivers.end());
  return slivers;
}

}  // namespace

TriangleMesh mesh_of(const TriangleMesh& mesh, const std::vector<int>& triangles) {
  TriangleSoup soup;
  std::vector<int> vertices;
  for (const int f : triangles) {
    const auto& t = mesh.triangles()[static_cast<std::size_t>(f)];
    vertices.insert(vertices.end(), t.begin(), t.end());
  }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  const auto number = [&](int v) {
    return static_cast<int>(std::lower_bound(vertices.begin(), vertices.end(), v) - vertices.begin());
  };
  for (const int v : vertices) soup.vertices.push_back(mesh.vertices()[static_cast<std::size_t>(v)]);
  for (const int f : triangles) {
    const auto& t = mesh.triangles()[static_cast<std::size_t>(f)];
    soup.triangles.push_back({number(t[0]), number(t[1]), number(t[2])});
  }
  return TriangleMesh(std::move(soup));
}

std::vector<int> connected_parts(const TriangleMesh& mesh) {
  return pieces(mesh, std::vector<bool>(3 * mesh.triangles().size(), false), {}).of_triangle;
}

std::vector<TriangleMesh> smooth_faces(const TriangleMesh& mesh, const CreaseLimits& limits,
                                       std::vector<int>* face_of_triangle) {
  if (const std::vector<int> slivers = hull_slivers(mesh, limits); !slivers.empty()) {
    std::vector<int> all(mesh.triangles().size()), rest, face_of_rest;
    std::iota(all.begin(), all.end(), 0);
    std::set_difference(all.begin(), all.end(), slivers.begin(), slivers.end(), std::back_inserter(rest));
    if (!rest.empty()) {
      std::vector<TriangleMesh> faces = smooth_faces(mesh_of(mesh, rest), limits, &face_of_rest);
      if (face_of_triangle) {
        face_of_triangle->assign(all.size(), -1);
        for (std::size_t i = 0; i < rest.size(); ++i)
          (*face_of_triangle)[static_cast<std::size_t>(rest[i])] = face_of_rest[i];
      }
      return faces;
    }
  }
  if (face_of_triangle) face_of_triangle->assign(mesh.triangles().size(), 0);
  const Creases found = creases(mesh, limits);
  if (found.empty()) return {mesh};
  std::vector<bool> cut(3 * mesh.triangles().size(), false);
  const int before = pieces(mesh, cut, {}).count;
  const auto cut_at = [&](int corner) {
    cut[static_cast<std::size_t>(corner)] = true;
    if (const int other = mesh.beyond(corner); other != TriangleMesh::kNone)
      cut[static_cast<std::size_t>(other)] = true;
  };
  for (const int corner : found.edges) cut_at(corner);
  for (const int corner : Bridges(mesh, found).run()) cut_at(corner);
  Pieces parted = pieces(mesh, cut, found.bands);
  if (!found.bands.empty()) parted = without_slivers(mesh, std::move(parted));
  if (parted.count <= before) return {mesh};
  if (face_of_triangle) *face_of_triangle = parted.of_triangle;
  std::vector<std::vector<int>> triangles(static_cast<std::size_t>(parted.count));
  for (std::size_t f = 0; f < parted.of_triangle.size(); ++f) {
    if (const int piece = parted.of_triangle[f]; piece >= 0)
      triangles[static_cast<std::size_t>(piece)].push_back(static_cast<int>(f));
  }
  std::vector<TriangleMesh> faces;
  faces.reserve(triangles.size());
  for (const std::vector<int>& own : triangles) faces.push_back(mesh_of(mesh, own));
  return faces;
}

}  // namespace hotblade::surface

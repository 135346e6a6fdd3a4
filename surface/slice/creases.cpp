#include "surface/slice/creases.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "surface/read/blocks.hpp"
#include "surface/read/half_edges.hpp"

namespace hotblade::surface {
namespace {

using Eigen::Vector3d;

// A walk ends here: no strip's seam is farther from another crease that would matter.
constexpr double kFarMm = 400;
// Tolerances that the chords of a mesh may be off its smooth surface, as those of coarse shells are.
constexpr double kChords = 4;
// A surface keeps its direction as long as it turns by less than this share of the fold.
constexpr double kKept = 0.25;
// More facets within kFarMm than any design has that a walk should see through.
constexpr int kMostFacets = 10'000;

// Square to the face, as long as twice its area.
Vector3d across_face(const TriangleMesh& mesh, int face) {
  const auto& [a, b, c] = mesh.triangles()[static_cast<std::size_t>(face)];
  const auto at = [&](int v) -> const Vector3d& { return mesh.vertices()[static_cast<std::size_t>(v)]; };
  return (at(b) - at(a)).cross(at(c) - at(a));
}

double turn_between(const TriangleMesh& mesh, int face, int other) {
  const Vector3d m = across_face(mesh, face).stableNormalized(),
                 n = across_face(mesh, other).stableNormalized();
  return std::atan2(m.cross(n).norm(), m.dot(n));
}

class Creases {
 public:
  Creases(const TriangleMesh& mesh, const CreaseLimits& limits) : mesh_(mesh), limits_(limits) {
    // A fold is rounded off within the tolerance where the cosine of half of it is above this.
    const double half = 1 / (1 + 2 * limits_.tolerance_mm / limits_.least_radius_mm);
    constexpr double kMargin = 1e-9;  // far over the rounding of a cosine, and of no fold that matters
    // What folds less stands alone only if sides are seen through for longer than walks are.
    const double alone = std::cos(std::min(wide_rad_mm() / kFarMm, std::numbers::pi));
    flat_ = 2 * half * half - 1;
    if (limits_.shallow) flat_ = std::max(flat_, alone);
    flat_ += kMargin;
  }

  [[nodiscard]] std::vector<int> run() const {
    const std::size_t triangles = mesh_.triangles().size();
    std::vector<std::vector<int>> found((triangles + kBlock - 1) / kBlock);
    for_blocks(triangles, kBlock, [&](std::size_t from, std::size_t to) {
      for (auto face = static_cast<int>(from); face < static_cast<int>(to); ++face)
        look(face, found[from / kBlock]);
    });
    std::vector<int> all;
    for (const std::vector<int>& own : found) all.insert(all.end(), own.begin(), own.end());
    return all;
  }

 private:
  [[nodiscard]] const Vector3d& at(int corner) const {
    return mesh_.vertices()[static_cast<std::size_t>(vertex_at(mesh_, corner))];
  }
  // Adds the creases between a face and those of higher numbers.
  void look(int face, std::vector<int>& found) const {
    const HalfEdges& half_edges = mesh_.half_edges();
    const Vector3d own = across(face);
    HalfEdges::Halfedge h = half_edges.first(face);
    for (int corner = 3 * face; corner < 3 * face + 3;
         ++corner, h = half_edges.mesh().next_halfedge_handle(h)) {
      const HalfEdges::Halfedge beyond = half_edges.across(h);
      if (!beyond.is_valid()) continue;
      const int other = half_edges.mesh().face_handle(beyond).idx();
      if (other > face && !surely_flat(own, across(other)) && is_crease(corner, half_edges.corner_of(beyond)))
        found.push_back(corner);
    }
  }
  [[nodiscard]] Vector3d across(int face) const { return across_face(mesh_, face); }
  [[nodiscard]] Vector3d normal(int face) const { return across(face).stableNormalized(); }

  // Told without a root or an angle of nearly all edges of a smooth surface: their fold rounds off.
  [[nodiscard]] bool surely_flat(const Vector3d& m, const Vector3d& n) const {
    const double cosine = m.dot(n), squares = m.squaredNorm() * n.squaredNorm();
    return flat_ > 0 && cosine > 0 && squares > kLeastSquares && cosine * cosine > flat_ * flat_ * squares;
  }

  [[nodiscard]] double turn(int face, int other) const { return turn_between(mesh_, face, other); }

  // A chord's height over an arc that turns by the fold: on less than this, divided by the fold, to both
  // sides an edge may stand for a bend. On more no elastica follows both: the best even function with three
  // coefficients misses what is straight but for a fold in its middle by a thirtieth of a side times the
  // fold, here a tolerance.
  [[nodiscard]] double wide_rad_mm() const { return 8 * kChords * limits_.tolerance_mm; }

  [[nodiscard]] bool is_crease(int corner, int other) const {
    const double fold = turn(corner / 3, other / 3), wide_mm = wide_rad_mm() / fold;
    // The arc that is tangent to both sides misses the edge by this; a fit shares it out to both sides.
    const double rounded_mm = 0.5 * limits_.least_radius_mm * (1 / std::cos(0.5 * fold) - 1);
    const bool rounds = !(rounded_mm > limits_.tolerance_mm);
    if (rounds && !(limits_.shallow && wide_mm < kFarMm)) return false;
    return kept_mm(corner, kKept * fold, wide_mm) > wide_mm &&
           kept_mm(other, kKept * fold, wide_mm) > wide_mm &&
           (!rounds || (stands_alone(corner, fold, wide_mm) && stands_alone(other, fold, wide_mm)));
  }

  // Whether the surface goes on for `wide_mm` from an edge, and nowhere until it ends, or as far as walks go,
  // folds at once by a share of what it does at the edge: those of coarse facets are many.
  [[nodiscard]] bool stands_alone(int corner, double fold, double wide_mm) const {
    bool alone = true;
    const Walk walked = walk(corner, [&](double passed_mm, int face, int next) {
      alone = turn(face, next) <= kKept * fold;
      return alone && passed_mm <= kFarMm;
    });
    return alone && walked.way_mm > wide_mm;
  }

  // How far the surface goes on from an edge into its triangle, square to it, and turns by less than
  // `most_rad`; followed to beyond `enough_mm` only. Infinity where the surface ends before it turns.
  [[nodiscard]] double kept_mm(int corner, double most_rad, double enough_mm) const {
    const Walk walked = walk(corner, [&](double passed_mm, int, int next) {
      return passed_mm <= std::min(enough_mm, kFarMm) && turn(corner / 3, next) <= most_rad;
    });
    return walked.to_border ? std::numeric_limits<double>::infinity() : walked.way_mm;
  }

  struct Walk {
    double way_mm = 0;
    bool to_border = false;
  };

  // Walks from an edge into its triangle, square to it, and straight on over edges for as long as `goes_on`,
  // asked at each of these with the way so far, the face before it and the one behind it, says so.
  template <typename GoesOn>
  [[nodiscard]] Walk walk(int corner, const GoesOn& goes_on) const {
    const Vector3d edge = at(next_corner(corner)) - at(corner);
    Vector3d from = at(corner) + 0.5 * edge, along = normal(corner / 3).cross(edge).stableNormalized();
    Walk walked;
    int entered = corner;
    for (int facet = 0; facet < kMostFacets; ++facet) {
      const auto [exit, way] = leaves(entered, from, along);
      if (exit == TriangleMesh::kNone) break;
      walked.way_mm += way;
      from += way * along;
      const int next = mesh_.beyond(exit);
      walked.to_border = next == TriangleMesh::kNone;
      if (walked.to_border || !goes_on(walked.way_mm, entered / 3, next / 3)) break;
      // Straight on over the edge: the same along it, and into the next triangle.
      const Vector3d over = (at(next_corner(next)) - at(next)).stableNormalized(),
                     inward = normal(next / 3).cross(over);
      const double share = std::clamp(along.dot(over), -1.0, 1.0);
      along = share * over + std::sqrt(1 - share * share) * inward;
      entered = next;
    }
    return walked;
  }

  struct Exit {
    int corner = TriangleMesh::kNone;
    double way_mm = 0;
  };

  // Where a line in a triangle, from a point of the edge `entered`, meets one of the other two edges.
  [[nodiscard]] Exit leaves(int entered, const Vector3d& from, const Vector3d& along) const {
    const Vector3d n = normal(entered / 3);
    Exit best;
    for (int corner = next_corner(entered); corner != entered; corner = next_corner(corner)) {
      const Vector3d edge = at(next_corner(corner)) - at(corner), out = edge.cross(n);
      const double speed = along.dot(out);
      if (!(speed > 0)) continue;
      const double way = std::max(0.0, (at(corner) - from).dot(out) / speed);
      if (best.corner == TriangleMesh::kNone || way < best.way_mm) best = {corner, way};
    }
    return best;
  }

  // Smaller products of squared areas may have lost digits.
  static constexpr double kLeastSquares = 1e-200;

  const TriangleMesh& mesh_;
  const CreaseLimits& limits_;
  double flat_ = 1;  // the cosine of a fold above which it rounds off
};

// Creases that fade out inside a surface, as those of a groin vault do towards its crown, led on along the
// mesh's edges until they meet.
class Bridges {
 public:
  Bridges(const TriangleMesh& mesh, const std::vector<int>& creases) : mesh_(mesh) {
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
    border_.assign(count, false);
    for (const int corner : mesh.border()) {
      border_[static_cast<std::size_t>(vertex_at(mesh, corner))] = true;
      border_[static_cast<std::size_t>(vertex_at(mesh, next_corner(corner)))] = true;
    }
    creases_.resize(count);
    for (const int corner : creases) {
      const int from = vertex_at(mesh, corner), to = vertex_at(mesh, next_corner(corner));
      creases_[static_cast<std::size_t>(from)].push_back({to, corner});
      creases_[static_cast<std::size_t>(to)].push_back({from, corner});
    }
  }

  // Corners of the edges that join creases. All are led on at once, an edge at a time, so that they meet
  // halfway.
  [[nodiscard]] std::vector<int> run() const {
    std::vector<Way> ways;
    for (int v = 0; v < static_cast<int>(creases_.size()); ++v) {
      if (creases_[static_cast<std::size_t>(v)].size() == 1 && !border_[static_cast<std::size_t>(v)])
        ways.push_back(on_from(v));
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
    return border_[static_cast<std::size_t>(v)] || !creases_[static_cast<std::size_t>(v)].empty();
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
  std::vector<bool> border_;
};

// Numbers of the pieces that hang together without the edges that are cut.
struct Pieces {
  std::vector<int> of_triangle;
  int count = 0;
};

Pieces pieces(const TriangleMesh& mesh, const std::vector<bool>& cut) {
  Pieces found{std::vector<int>(mesh.triangles().size(), -1), 0};
  std::vector<int> open;
  for (std::size_t seed = 0; seed < found.of_triangle.size(); ++seed) {
    if (found.of_triangle[seed] >= 0) continue;
    open.assign(1, static_cast<int>(seed));
    found.of_triangle[seed] = found.count;
    while (!open.empty()) {
      const int face = open.back();
      open.pop_back();
      for (int corner = 3 * face; corner < 3 * face + 3; ++corner) {
        const int other = mesh.beyond(corner);
        if (other == TriangleMesh::kNone || cut[static_cast<std::size_t>(corner)]) continue;
        int& piece = found.of_triangle[static_cast<std::size_t>(other / 3)];
        if (piece >= 0) continue;
        piece = found.count;
        open.push_back(other / 3);
      }
    }
    ++found.count;
  }
  return found;
}

TriangleMesh piece_of(const TriangleMesh& mesh, const std::vector<int>& triangles) {
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

}  // namespace

std::vector<int> creases(const TriangleMesh& mesh, const CreaseLimits& limits) {
  if (!(limits.tolerance_mm > 0) || !(limits.least_radius_mm > 0))
    throw std::logic_error("creases: limits have to be above 0");
  return Creases(mesh, limits).run();
}

std::vector<TriangleMesh> smooth_faces(const TriangleMesh& mesh, const CreaseLimits& limits,
                                       std::vector<int>* face_of_triangle) {
  if (face_of_triangle) face_of_triangle->assign(mesh.triangles().size(), 0);
  std::vector<int> found = creases(mesh, limits);
  if (found.empty()) return {mesh};
  const std::vector<int> bridges = Bridges(mesh, found).run();
  found.insert(found.end(), bridges.begin(), bridges.end());
  std::vector<bool> cut(3 * mesh.triangles().size(), false);
  const int before = pieces(mesh, cut).count;
  for (const int corner : found) {
    cut[static_cast<std::size_t>(corner)] = true;
    if (const int other = mesh.beyond(corner); other != TriangleMesh::kNone)
      cut[static_cast<std::size_t>(other)] = true;
  }
  const Pieces parted = pieces(mesh, cut);
  if (parted.count == before) return {mesh};
  if (face_of_triangle) *face_of_triangle = parted.of_triangle;
  std::vector<std::vector<int>> triangles(static_cast<std::size_t>(parted.count));
  for (std::size_t f = 0; f < parted.of_triangle.size(); ++f)
    triangles[static_cast<std::size_t>(parted.of_triangle[f])].push_back(static_cast<int>(f));
  std::vector<TriangleMesh> faces;
  faces.reserve(triangles.size());
  for (const std::vector<int>& own : triangles) faces.push_back(piece_of(mesh, own));
  return faces;
}

}  // namespace hotblade::surface

#include "surface/slice/crease_bands.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <unordered_set>
#include <utility>
#include <vector>

#include "surface/read/blocks.hpp"
#include "surface/read/half_edges.hpp"
#include "surface/slice/fold_limits.hpp"
#include "surface/slice/walks.hpp"

namespace hotblade::surface {
namespace {

using Eigen::Vector3d;

class Bands : private Walks {
 public:
  Bands(const TriangleMesh& mesh, const CreaseLimits& limits)
      : Walks(mesh), limits_(limits), folds_(limits), least_rad_(folds_.least_rad()) {}

  [[nodiscard]] Creases run() {
    find_sharp();
    if (narrow_.empty()) return {};
    add_narrow_pieces();
    find_sides();
    const std::vector<char> near_sides = triangles_near_sides();
    std::vector<Place> places;
    for (const int face : narrow_) {
      if (side(face) == kNoSide) {
        if (near_sides[static_cast<std::size_t>(face)]) places.push_back({face, true});
        continue;
      }
      for (int corner = 3 * face; corner < 3 * face + 3; ++corner) {
        const int beyond = mesh_.beyond(corner);
        if (beyond == TriangleMesh::kNone || !sharp(corner) || side(beyond / 3) == kNoSide) continue;
        // An edge of two narrow triangles is met from both.
        if (corner < beyond || side(beyond / 3) == beyond / 3)
          places.push_back({std::min(corner, beyond), false});
      }
    }
    constexpr std::size_t kPlaces = 256;
    for_blocks(places.size(), kPlaces, [&](std::size_t from, std::size_t to) {
      for (std::size_t i = from; i < to; ++i)
        places[i].fold = places[i].triangle ? of_band(places[i].at) : of_edge(places[i].at);
    });
    lead_on(places);
    Creases found;
    for (const Place& place : places)
      if (place.fold == Fold::kStands) (place.triangle ? found.bands : found.edges).push_back(place.at);
    return found;
  }

 private:
  // What a place is: no part of a crease, a part only where another leads there, as its sides meet further
  // folds too soon or it is too wide, or a part of one by itself.
  enum class Fold { kNone, kMeets, kStands };
  // A triangle, or an edge by its lower corner.
  struct Place {
    int at = 0;
    bool triangle = false;
    Fold fold = Fold::kNone;
  };

  static constexpr int kNoSide = -1;
  // Teeth that a fold cuts from cells differ, and corners where bands meet are farther from their sides:
  // places are led on to that are so many times as wide or as far off as others may be.
  static constexpr double kSpread = 1.5;

  // Finds the edges over which a surface bends more sharply than it may, and the narrow triangles at them.
  void find_sharp() {
    const std::size_t triangles = mesh_.triangles().size();
    sharp_.assign(3 * triangles, 0);
    std::vector<std::vector<int>> found((triangles + kBlock - 1) / kBlock);
    for_blocks(triangles, kBlock, [&](std::size_t from, std::size_t to) {
      for (auto face = static_cast<int>(from); face < static_cast<int>(to); ++face)
        if (look(face)) found[from / kBlock].push_back(face);
    });
    for (const std::vector<int>& own : found) narrow_.insert(narrow_.end(), own.begin(), own.end());
  }

  // Marks a triangle's sharp edges; whether it is narrow at one of these.
  [[nodiscard]] bool look(int face) {
    const HalfEdges& half_edges = mesh_.half_edges();
    const Vector3d own = across_face(mesh_, face);
    bool narrow = false;
    HalfEdges::Halfedge h = half_edges.first(face);
    for (int corner = 3 * face; corner < 3 * face + 3;
         ++corner, h = half_edges.mesh().next_halfedge_handle(h)) {
      const HalfEdges::Halfedge beyond = half_edges.across(h);
      if (!beyond.is_valid()) continue;
      const Vector3d beside = across_face(mesh_, half_edges.mesh().face_handle(beyond).idx());
      const double length2_mm2 = (at(next_corner(corner)) - at(corner)).squaredNorm();
      if (!bends_sharply(own, beside, length2_mm2)) continue;
      sharp_[static_cast<std::size_t>(corner)] = 1;
      narrow = narrow || own.squaredNorm() <= kMostBandMm * kMostBandMm * length2_mm2;
    }
    return narrow;
  }

  // Whether faces fold by what no blade rounds on so short a way: half as much as that is on the height of
  // the lower one, or by more than a side may turn. Told without a root or an angle of nearly all.
  [[nodiscard]] bool bends_sharply(const Vector3d& m, const Vector3d& n, double length2_mm2) const {
    constexpr double kLeastSquares = 1e-200;  // smaller ones may have lost digits
    const double cosine = m.dot(n), mm = m.squaredNorm(), nn = n.squaredNorm();
    if (!(cosine > 0)) return mm * nn > kLeastSquares;
    const double height2_mm2 = std::min(mm, nn) / length2_mm2, sharp = 0.5 * least_rad_ / kMostBandMm,
                 sine2 = std::min(height2_mm2 * sharp * sharp, most_sine2_);
    return mm * nn - cosine * cosine > mm * nn * sine2;
  }

  // Adds the triangles of pieces between sharp edges that are narrow as a whole: of a chamfer those as well
  // that have none of its long edges.
  void add_narrow_pieces() {
    std::vector<char> done(mesh_.triangles().size(), 0), narrow(mesh_.triangles().size(), 0);
    for (const int face : narrow_) narrow[static_cast<std::size_t>(face)] = 1;
    std::vector<int> piece;
    for (const int seed : narrow_) {
      if (done[static_cast<std::size_t>(seed)]) continue;
      piece.assign(1, seed);
      done[static_cast<std::size_t>(seed)] = 1;
      double area2_mm2 = 0, sharp_mm = 0;
      for (std::size_t i = 0; i < piece.size(); ++i) {
        area2_mm2 += across_face(mesh_, piece[i]).norm();
        for (int corner = 3 * piece[i]; corner < 3 * piece[i] + 3; ++corner) {
          if (sharp(corner)) sharp_mm += (at(next_corner(corner)) - at(corner)).norm();
          const int beyond = mesh_.beyond(corner);
          if (beyond == TriangleMesh::kNone || sharp(corner)) continue;
          char& seen = done[static_cast<std::size_t>(beyond / 3)];
          if (!seen) piece.push_back(beyond / 3);
          seen = 1;
        }
      }
      if (area2_mm2 > kMostBandMm * sharp_mm) continue;
      for (const int face : piece) narrow[static_cast<std::size_t>(face)] = 1;
    }
    narrow_.clear();
    for (std::size_t i = 0; i < narrow.size(); ++i)
      if (narrow[i]) narrow_.push_back(static_cast<int>(i));
  }

  // Leads sides on from the triangles that are not narrow, over edges that are not sharp, as far as they keep
  // their direction.
  void find_sides() {
    side_.resize(mesh_.triangles().size());
    for (std::size_t i = 0; i < side_.size(); ++i) side_[i] = static_cast<int>(i);
    for (const int face : narrow_) side_[static_cast<std::size_t>(face)] = kNoSide;
    std::vector<int> front, next;
    const auto lead_on = [&](int from, int to) {
      if (side(to) != kNoSide || turn(side(from), to) > FoldLimits::kKept * least_rad_) return;
      side_[static_cast<std::size_t>(to)] = side(from);
      next.push_back(to);
    };
    for (const int face : narrow_) {
      for (int corner = 3 * face; corner < 3 * face + 3; ++corner) {
        const int beyond = mesh_.beyond(corner);
        if (beyond != TriangleMesh::kNone && !sharp(corner) && side(beyond / 3) == beyond / 3)
          lead_on(beyond / 3, face);
      }
    }
    while (!next.empty()) {
      front.swap(next);
      next.clear();
      for (const int face : front) {
        for (int corner = 3 * face; corner < 3 * face + 3; ++corner) {
          const int beyond = mesh_.beyond(corner);
          if (beyond != TriangleMesh::kNone && !sharp(corner)) lead_on(face, beyond / 3);
        }
      }
    }
  }

  // Those of no side that may have one within the widest band, and some more: in noise there are few.
  [[nodiscard]] std::vector<char> triangles_near_sides() const {
    constexpr double kBeyondMm = 3 * kMostBandMm;  // as each is met by one way alone
    struct Way {
      int entered = 0;  // the corner by whose edge a way comes
      Vector3d at = Vector3d::Zero();
      double way_mm = 0;
    };
    std::vector<char> near(mesh_.triangles().size(), 0);
    std::vector<Way> open;
    const auto add = [&](const Way& way) {
      char& seen = near[static_cast<std::size_t>(way.entered / 3)];
      if (!seen) open.push_back(way);
      seen = 1;
    };
    for (const int face : narrow_) {
      if (side(face) != kNoSide) continue;
      for (int corner = 3 * face; corner < 3 * face + 3; ++corner) {
        const int beyond = mesh_.beyond(corner);
        if (beyond != TriangleMesh::kNone && side(beyond / 3) != kNoSide) add({corner, at(corner), 0});
      }
    }
    const std::size_t starts = open.size();  // each at all of its edge
    for (std::size_t i = 0; i < open.size(); ++i) {
      const Way way = open[i];
      for (int corner = next_corner(way.entered); corner != way.entered; corner = next_corner(corner)) {
        const int beyond = mesh_.beyond(corner);
        if (beyond == TriangleMesh::kNone || side(beyond / 3) != kNoSide) continue;
        const Vector3d to = nearest_on_edge(corner, way.at);
        const double way_mm = i < starts ? 0 : way.way_mm + (to - way.at).norm();
        if (way_mm <= kBeyondMm) add({beyond, to, way_mm});
      }
    }
    return near;
  }

  [[nodiscard]] Vector3d nearest_on_edge(int corner, const Vector3d& point) const {
    const Vector3d edge = at(next_corner(corner)) - at(corner);
    if (!(edge.squaredNorm() > 0)) return at(corner);
    return at(corner) + std::clamp((point - at(corner)).dot(edge) / edge.squaredNorm(), 0.0, 1.0) * edge;
  }

  // Takes places as well that meet others and touch what is a crease, and on from these.
  void lead_on(std::vector<Place>& places) const {
    const auto vertices = [&](const Place& place) {
      const auto& all = mesh_.triangles()[static_cast<std::size_t>(place.at / (place.triangle ? 1 : 3))];
      if (place.triangle) return std::vector<int>(all.begin(), all.end());
      return std::vector<int>{vertex_at(mesh_, place.at), vertex_at(mesh_, next_corner(place.at))};
    };
    std::vector<std::pair<int, std::size_t>> meet_at;  // a vertex, and a place there
    std::vector<std::size_t> open;
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (places[i].fold == Fold::kStands) open.push_back(i);
      if (places[i].fold != Fold::kMeets) continue;
      for (const int v : vertices(places[i])) meet_at.emplace_back(v, i);
    }
    std::sort(meet_at.begin(), meet_at.end());
    while (!open.empty()) {
      const std::size_t from = open.back();
      open.pop_back();
      for (const int v : vertices(places[from])) {
        auto next = std::lower_bound(meet_at.begin(), meet_at.end(), std::pair{v, std::size_t{0}});
        for (; next != meet_at.end() && next->first == v; ++next) {
          Place& place = places[next->second];
          if (place.fold == Fold::kMeets) open.push_back(next->second);
          place.fold = Fold::kStands;
        }
      }
    }
  }

  // Whether both sides of a fold meet at an edge.
  [[nodiscard]] Fold of_edge(int corner) const {
    const int beyond = mesh_.beyond(corner), a = side(corner / 3), b = side(beyond / 3);
    if (a == b) return Fold::kNone;
    const double fold = turn(a, b);
    if (!folds_.counts(fold) || turn(corner / 3, beyond / 3) < 0.5 * fold) return Fold::kNone;
    const Vector3d axis = axis_of(a, b), apart = centroid(a) - centroid(b);
    return std::min(keeps(a, axis, apart, fold, 0), keeps(b, axis, -apart, fold, 0));
  }

  struct Beside {
    int side = 0;
    double off_mm = 0;
    Vector3d at = Vector3d::Zero();  // where it is nearest
  };

  // What a triangle between sides is in its middle and halfway to its neighbours of that kind, at least.
  [[nodiscard]] Fold of_band(int face) const {
    Fold least = at_point(face, centroid(face));
    for (int corner = 3 * face; corner < 3 * face + 3 && least != Fold::kNone; ++corner) {
      const int beyond = mesh_.beyond(corner);
      if (beyond != TriangleMesh::kNone && side(beyond / 3) == kNoSide)
        least = std::min(least, at_point(face, 0.5 * (at(corner) + at(next_corner(corner)))));
    }
    return least;
  }

  [[nodiscard]] Fold at_point(int face, const Vector3d& point) const {
    std::vector<Beside> sides = sides_near(face, point);
    if (sides.size() < 2) return Fold::kNone;
    std::sort(sides.begin(), sides.end(), [](const Beside& p, const Beside& q) {
      return std::pair{p.off_mm, p.side} < std::pair{q.off_mm, q.side};
    });
    const Beside nearest = sides.front();
    const double most_mm = kSpread * kMostBandMm - nearest.off_mm;  // to the other side
    if (nearest.off_mm > most_mm) return Fold::kNone;
    std::erase_if(sides, [&](const Beside& other) { return other.off_mm > most_mm; });
    const auto turned = [&](const Beside& other) { return turn(nearest.side, other.side); };
    const Beside beyond = *std::max_element(
        sides.begin(), sides.end(), [&](const Beside& p, const Beside& q) { return turned(p) < turned(q); });
    const double fold = turned(beyond);
    if (!folds_.counts(fold)) return Fold::kNone;
    double off_mm = limits_.shallow ? 0 : std::numeric_limits<double>::infinity();
    for (const Beside& own : sides)
      off_mm = std::min(off_mm, std::abs(normal(own.side).dot(point - at(3 * own.side))));
    if (off_mm > kSpread * limits_.tolerance_mm) return Fold::kNone;
    // On both sides some place keeps its direction: what is nearest may be tilted itself, as a tooth is that
    // is hardly cut.
    const Vector3d axis = axis_of(nearest.side, beyond.side), apart = nearest.at - beyond.at;
    std::array<Fold, 2> kept{Fold::kNone, Fold::kNone};
    std::array<double, 2> off_sides_mm{-1, -1};
    for (const Beside& own : sides) {
      const std::size_t which = turned(own) < 0.5 * fold ? 0 : 1;
      if (off_sides_mm[which] < 0) off_sides_mm[which] = own.off_mm;
      if (kept[which] == Fold::kStands) continue;
      const double band_mm = (which == 0 ? beyond : nearest).off_mm + own.off_mm;
      kept[which] = std::max(kept[which], keeps(own.side, axis, which == 0 ? apart : -apart, fold, band_mm));
    }
    const bool alone = off_sides_mm[0] + off_sides_mm[1] <= kMostBandMm && off_mm <= limits_.tolerance_mm;
    return std::min({kept[0], kept[1], alone ? Fold::kStands : Fold::kMeets});
  }

  // Sides within the widest band of a point of a triangle, over triangles that are of none.
  [[nodiscard]] std::vector<Beside> sides_near(int face, const Vector3d& point) const {
    std::vector<Beside> found;
    std::vector<int> open{face};
    std::unordered_set<int> seen{face};
    while (!open.empty()) {
      const int from = open.back();
      open.pop_back();
      for (int corner = 3 * from; corner < 3 * from + 3; ++corner) {
        const int beyond = mesh_.beyond(corner);
        if (beyond == TriangleMesh::kNone) continue;
        const Vector3d near = nearest_on_edge(corner, point);
        const double off_mm = (point - near).norm();
        if (off_mm > kMostBandMm) continue;
        if (const int own = side(beyond / 3); own != kNoSide)
          found.push_back({own, off_mm, near});
        else if (seen.insert(beyond / 3).second)
          open.push_back(beyond / 3);
      }
    }
    return found;
  }

  [[nodiscard]] Vector3d axis_of(int a, int b) const { return normal(a).cross(normal(b)).stableNormalized(); }

  // Whether a side of a fold, square to its axis, keeps its direction for as long as it has to beside a
  // crease, and for half as much again as the band there is wide so closely that no more of the fold can lie
  // there. `outward` leads away from the other side.
  [[nodiscard]] Fold keeps(int from, const Vector3d& axis, const Vector3d& outward, double fold,
                           double band_mm) const {
    Vector3d along = normal(from).cross(axis).stableNormalized();
    if (along.dot(outward) < 0) along = -along;
    constexpr double kBesideBand = 0.05, kBands = 1.5;
    const double wide_mm = folds_.wide_mm(fold), end_mm = std::min(wide_mm, FoldLimits::kFarMm);
    bool meets = false;
    const auto goes_on_while = [&](bool straight, int next) {
      meets = !straight && side(next / 3) != next / 3;
      return straight;
    };
    const Walk walked = walk_from(from, along, [&](double passed_mm, int, int next) {
      const double most = passed_mm <= kBands * band_mm ? kBesideBand : FoldLimits::kKept;
      return passed_mm <= end_mm && goes_on_while(turn(from, next / 3) <= most * fold, next);
    });
    if (!walked.to_border && walked.way_mm <= wide_mm) return meets ? Fold::kMeets : Fold::kNone;
    if (!folds_.rounds_off(fold)) return Fold::kStands;
    // Such a fold stands alone, and its side is as long; it is led on to a border.
    const Walk far = walk_from(from, along, [&](double passed_mm, int exit, int next) {
      return passed_mm <= FoldLimits::kFarMm &&
             goes_on_while(turn(exit / 3, next / 3) <= FoldLimits::kKept * fold, next);
    });
    if (meets) return Fold::kMeets;
    if (!far.to_border && far.way_mm <= FoldLimits::kFarMm) return Fold::kNone;
    return far.way_mm > wide_mm ? Fold::kStands : Fold::kMeets;
  }

  [[nodiscard]] bool sharp(int corner) const { return sharp_[static_cast<std::size_t>(corner)] != 0; }
  [[nodiscard]] int side(int face) const { return side_[static_cast<std::size_t>(face)]; }

  const CreaseLimits& limits_;
  FoldLimits folds_;
  double least_rad_ = 0;
  double most_sine2_ = std::pow(std::sin(FoldLimits::kKept * least_rad_), 2);
  std::vector<std::uint8_t> sharp_;  // of each corner
  std::vector<int> narrow_;          // triangles that are narrow at a sharp edge
  std::vector<int> side_;            // of each triangle: the one that it is led on from
};

}  // namespace

Creases crease_bands(const TriangleMesh& mesh, const CreaseLimits& limits) {
  return Bands(mesh, limits).run();
}

}  // namespace hotblade::surface

#include "surface/slice/creases.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>

#include "surface/read/blocks.hpp"
#include "surface/read/half_edges.hpp"
#include "surface/slice/face_turn.hpp"

namespace hotblade::surface {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// A walk ends here: no strip's seam is farther from another crease that would matter.
constexpr double kFarMm = 400;
// Tolerances that the chords of a mesh may be off its smooth surface, as those of coarse shells are.
constexpr double kChords = 4;
// A surface keeps its direction as long as it turns by less than this share of the fold.
constexpr double kKept = 0.25;
// Strips go on past their faces by 4 mm, which is half of what they leave out between them.
constexpr double kMostBandMm = 8;
// More facets within kFarMm than any design has that a walk should see through.
constexpr int kMostFacets = 10'000;

// Ways over the triangles of a mesh.
class Walks {
 public:
  explicit Walks(const TriangleMesh& mesh) : mesh_(mesh) {}

  struct Walk {
    double way_mm = 0;
    bool to_border = false;
  };

  // Walks from an edge into its triangle, square to it, and straight on over edges for as long as `goes_on`,
  // asked at each of these with the way so far and its corners in the triangles before and behind it, says
  // so.
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
      if (walked.to_border || !goes_on(walked.way_mm, exit, next)) break;
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

 protected:
  [[nodiscard]] const Vector3d& at(int corner) const {
    return mesh_.vertices()[static_cast<std::size_t>(vertex_at(mesh_, corner))];
  }
  [[nodiscard]] Vector3d normal(int face) const { return across_face(mesh_, face).stableNormalized(); }

  const TriangleMesh& mesh_;
};

class Creases : private Walks {
 public:
  Creases(const TriangleMesh& mesh, const CreaseLimits& limits) : Walks(mesh), limits_(limits) {
    // A fold is rounded off within the tolerance where the cosine of half of it is above this.
    const double half = 1 / (1 + 2 * limits_.tolerance_mm / limits_.least_radius_mm);
    constexpr double kMargin = 1e-9;  // far over the rounding of a cosine, and of no fold that matters
    // What folds less stands alone only if sides are seen through for longer than walks are.
    const double alone = std::cos(std::min(wide_rad_mm() / kFarMm, std::numbers::pi));
    flat_ = 2 * half * half - 1;
    if (limits_.shallow) flat_ = std::max(flat_, alone);
    flat_ += kMargin;
    const double least_rad = limits_.shallow ? wide_rad_mm() / kFarMm : 2 * std::acos(half);
    sharp_per_mm_ = 0.5 * least_rad / kMostBandMm;
  }

  [[nodiscard]] std::vector<Crease> run() const {
    const std::size_t triangles = mesh_.triangles().size();
    std::vector<std::vector<Crease>> found((triangles + kBlock - 1) / kBlock);
    for_blocks(triangles, kBlock, [&](std::size_t from, std::size_t to) {
      for (auto face = static_cast<int>(from); face < static_cast<int>(to); ++face)
        look(face, found[from / kBlock]);
    });
    std::vector<Crease> all;
    for (const std::vector<Crease>& own : found) all.insert(all.end(), own.begin(), own.end());
    return all;
  }

 private:
  // Adds the creases between a face and those of higher numbers.
  void look(int face, std::vector<Crease>& found) const {
    const HalfEdges& half_edges = mesh_.half_edges();
    const Vector3d own = across(face);
    HalfEdges::Halfedge h = half_edges.first(face);
    for (int corner = 3 * face; corner < 3 * face + 3;
         ++corner, h = half_edges.mesh().next_halfedge_handle(h)) {
      const HalfEdges::Halfedge beyond = half_edges.across(h);
      if (!beyond.is_valid()) continue;
      const int other = half_edges.mesh().face_handle(beyond).idx();
      if (other < face) continue;
      const Vector3d beside = across(other);
      const int back = half_edges.corner_of(beyond);
      if (!surely_flat(own, beside) && is_crease(corner, back)) {
        found.push_back({corner});
      } else if (bends_sharply(own, beside, corner)) {
        if (const Crease banded = banded_crease(corner, back); banded.band_mm > 0) found.push_back(banded);
      }
    }
  }
  [[nodiscard]] Vector3d across(int face) const { return across_face(mesh_, face); }

  // Told without a root or an angle of nearly all edges of a smooth surface: their fold rounds off.
  [[nodiscard]] bool surely_flat(const Vector3d& m, const Vector3d& n) const {
    const double cosine = m.dot(n), squares = m.squaredNorm() * n.squaredNorm();
    return flat_ > 0 && cosine > 0 && squares > kLeastSquares && cosine * cosine > flat_ * flat_ * squares;
  }

  // Whether an edge may be in the middle of a band, which folds by what no blade rounds on so short a way:
  // half as much as that is on the height of the lower of both triangles; the other may be one of a large
  // plane. Told without a root or an angle.
  [[nodiscard]] bool bends_sharply(const Vector3d& m, const Vector3d& n, int corner) const {
    const double cosine = m.dot(n), mm = m.squaredNorm(), nn = n.squaredNorm();
    if (!(cosine > 0)) return mm * nn > kLeastSquares;
    const double height2_mm2 = std::min(mm, nn) / (at(next_corner(corner)) - at(corner)).squaredNorm();
    return mm * nn - cosine * cosine > mm * nn * height2_mm2 * sharp_per_mm_ * sharp_per_mm_;
  }

  [[nodiscard]] double turn(int face, int other) const { return turn_between(mesh_, face, other); }

  // A chord's height over an arc that turns by the fold: on less than this, divided by the fold, to both
  // sides an edge may stand for a bend. On more no elastica follows both: the best even function with three
  // coefficients misses what is straight but for a fold in its middle by a thirtieth of a side times the
  // fold, here a tolerance.
  [[nodiscard]] double wide_rad_mm() const { return 8 * kChords * limits_.tolerance_mm; }

  // Whether the least radius rounds a fold within the tolerance: the arc that is tangent to both sides misses
  // the edge by twice this; a fit shares it out to both sides.
  [[nodiscard]] bool rounds_off(double fold) const {
    return !(0.5 * limits_.least_radius_mm * (1 / std::cos(0.5 * fold) - 1) > limits_.tolerance_mm);
  }

  [[nodiscard]] bool is_crease(int corner, int other) const {
    const double fold = turn(corner / 3, other / 3), wide_mm = wide_rad_mm() / fold;
    const bool rounds = rounds_off(fold);
    if (rounds && !(limits_.shallow && wide_mm < kFarMm)) return false;
    return kept_mm(corner, kKept * fold, wide_mm) > wide_mm &&
           kept_mm(other, kKept * fold, wide_mm) > wide_mm &&
           (!rounds || (stands_alone(corner, fold, wide_mm) && stands_alone(other, fold, wide_mm)));
  }

  // By how much the surface turns over an edge that a walk leaves a triangle at; below 0 where it is hollow.
  [[nodiscard]] double signed_turn(int exit) const {
    const int face = exit / 3, next = mesh_.beyond(exit) / 3;
    const bool hollow = across(face).cross(across(next)).dot(at(next_corner(exit)) - at(exit)) < 0;
    return hollow ? -turn(face, next) : turn(face, next);
  }

  struct Bend {
    double at_mm = 0, turn = 0;
  };

  // Folds to a side of an edge, to where a band that reaches there misses its corner by more than the
  // tolerance. Those of a smooth surface beside a fold count for nothing. None where the surface folds back
  // by as much: that is no band.
  [[nodiscard]] std::optional<std::vector<Bend>> bends(int corner, double own) const {
    constexpr double kCounts = 0.05;
    std::vector<Bend> found;
    double sum = own;
    bool back = false;
    (void)walk(corner, [&](double passed_mm, int exit, int) {
      if (passed_mm > kMostBandMm || misses_corner(passed_mm, sum)) return false;
      const double bend = signed_turn(exit), share = bend / own;
      back = share < -1;
      if (share < -kCounts) return false;
      if (share > kCounts) found.push_back({passed_mm, bend});
      sum += bend;
      return true;
    });
    return back ? std::nullopt : std::optional(std::move(found));
  }

  // Whether any chamfer or fillet of a width is farther from the sides that meet in its corner than the
  // tolerance, where that is asked. None is nearer than the arc that is tangent to both.
  [[nodiscard]] bool misses_corner(double wide_mm, double fold) const {
    fold = std::abs(fold);
    return fold >= std::numbers::pi ||
           (!limits_.shallow && wide_mm * (1 - std::cos(0.5 * fold)) > limits_.tolerance_mm * fold);
  }

  // How far a band is from the sides that meet in its corner, in the plane square to it: of its points the
  // one that is as far from both. Its bends are in their order.
  [[nodiscard]] static double off_sides_mm(const std::vector<Bend>& band) {
    // From the first bend on, with the side before it along x: what its points are off that side and the
    // other.
    std::vector<Vector2d> points{Vector2d::Zero()};
    double turned = 0;
    for (std::size_t i = 0; i + 1 < band.size(); ++i) {
      turned += band[i].turn;
      points.push_back(points.back() +
                       (band[i + 1].at_mm - band[i].at_mm) * Vector2d(std::cos(turned), std::sin(turned)));
    }
    turned += band.back().turn;
    const Vector2d across(-std::sin(turned), std::cos(turned));
    double farthest = 0, before_near = 0, before_far = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double near = std::abs(points[i].y()), far = std::abs(across.dot(points[i] - points.back()));
      if (i > 0 && near >= far) {
        // Where both are the same, between this point and the one before.
        const double gained = near - before_near, lost = before_far - far;
        return before_near + gained * (before_far - before_near) / (gained + lost);
      }
      farthest = std::max(farthest, std::min(near, far));
      before_near = near;
      before_far = far;
    }
    return farthest;
  }

  // The crease in whose middle an edge is, where several edges share its fold out that would be one as one
  // alone; of no width otherwise.
  [[nodiscard]] Crease banded_crease(int corner, int other) const {
    constexpr double kMiddle = 1.1;  // that rounding parts no chamfer
    const double own = signed_turn(corner);
    const auto inward = bends(corner, own);
    if (!inward) return {};
    const auto outward = bends(other, own);
    if (!outward) return {};
    const std::array sides{*inward, *outward};
    std::array<std::size_t, 2> taken{};
    std::array<double, 2> beside{}, wide_mm{};
    for (;;) {
      // The next bend is the nearer one.
      const auto next_mm = [&](std::size_t side) {
        return taken[side] < sides[side].size() ? sides[side][taken[side]].at_mm
                                                : std::numeric_limits<double>::infinity();
      };
      const std::size_t side = next_mm(0) <= next_mm(1) ? 0 : 1;
      if (taken[side] == sides[side].size()) break;
      const Bend& bend = sides[side][taken[side]];
      const double both_mm = bend.at_mm + wide_mm[1 - side];
      if (both_mm > kMostBandMm || misses_corner(both_mm, own + beside[0] + beside[1] + bend.turn)) break;
      beside[side] += bend.turn;
      wide_mm[side] = bend.at_mm;
      ++taken[side];
    }
    const double fold = std::abs(own + beside[0] + beside[1]), band_mm = wide_mm[0] + wide_mm[1];
    const bool rounds = rounds_off(fold);
    if (!(band_mm > 0) || (rounds && !(limits_.shallow && wide_rad_mm() / fold < kFarMm))) return {};
    if (std::abs(beside[0] - beside[1]) > kMiddle * std::abs(own)) return {};
    std::vector<Bend> band{{0, own}};
    for (std::size_t i = 0; i < taken[0]; ++i) band.push_back({-sides[0][i].at_mm, sides[0][i].turn});
    for (std::size_t i = 0; i < taken[1]; ++i) band.push_back(sides[1][i]);
    std::sort(band.begin(), band.end(), [](const Bend& a, const Bend& b) { return a.at_mm < b.at_mm; });
    if (!limits_.shallow && !(off_sides_mm(band) <= limits_.tolerance_mm)) return {};
    for (std::size_t side = 0; side < 2; ++side) {
      const int from = side == 0 ? corner : other;
      if (!keeps_beyond(from, wide_mm[side], band_mm, fold)) return {};
      if (rounds && !stands_alone(from, fold, wide_rad_mm() / fold, wide_mm[side])) return {};
    }
    return {corner, band_mm, wide_mm[1]};
  }

  // Whether the surface, from so far from an edge on, keeps its direction for as long as it has to beside a
  // crease, and for half as much again as the band is wide so closely that no more of the fold can lie there.
  [[nodiscard]] bool keeps_beyond(int corner, double from_mm, double band_mm, double fold) const {
    constexpr double kBesideBand = 0.05, kBands = 1.5;
    const double end_mm = from_mm + wide_rad_mm() / fold;
    int from = TriangleMesh::kNone;
    const Walk walked = walk(corner, [&](double passed_mm, int exit, int next) {
      if (passed_mm <= from_mm) return true;
      if (from == TriangleMesh::kNone) from = exit / 3;
      const double most = passed_mm <= from_mm + kBands * band_mm ? kBesideBand : kKept;
      return passed_mm <= std::min(end_mm, kFarMm) && turn(from, next / 3) <= most * fold;
    });
    return walked.way_mm > end_mm || (walked.to_border && walked.way_mm > from_mm);
  }

  // Whether the surface goes on for `wide_mm` from where it is `from_mm` from an edge, and nowhere until it
  // ends, or as far as walks go, folds at once by a share of what it does at the edge: those of coarse facets
  // are many.
  [[nodiscard]] bool stands_alone(int corner, double fold, double wide_mm, double from_mm = 0) const {
    bool alone = true;
    const Walk walked = walk(corner, [&](double passed_mm, int exit, int next) {
      alone = passed_mm <= from_mm || turn(exit / 3, next / 3) <= kKept * fold;
      return alone && passed_mm <= kFarMm;
    });
    return alone && walked.way_mm > from_mm + wide_mm;
  }

  // How far the surface goes on from an edge into its triangle, square to it, and turns by less than
  // `most_rad`; followed to beyond `enough_mm` only. Infinity where the surface ends before it turns.
  [[nodiscard]] double kept_mm(int corner, double most_rad, double enough_mm) const {
    const Walk walked = walk(corner, [&](double passed_mm, int, int next) {
      return passed_mm <= std::min(enough_mm, kFarMm) && turn(corner / 3, next / 3) <= most_rad;
    });
    return walked.to_border ? std::numeric_limits<double>::infinity() : walked.way_mm;
  }

  // Smaller products of squared areas may have lost digits.
  static constexpr double kLeastSquares = 1e-200;

  const CreaseLimits& limits_;
  double flat_ = 1;          // the cosine of a fold above which it rounds off
  double sharp_per_mm_ = 0;  // what a band bends by at its middle
};

void check(const CreaseLimits& limits) {
  if (!(limits.tolerance_mm > 0) || !(limits.least_radius_mm > 0))
    throw std::logic_error("creases: limits have to be above 0");
}

}  // namespace

std::vector<Crease> creases(const TriangleMesh& mesh, const CreaseLimits& limits) {
  check(limits);
  return Creases(mesh, limits).run();
}

std::vector<Crease> with_bands(const TriangleMesh& mesh, const std::vector<Crease>& creases) {
  const Walks walks(mesh);
  std::map<int, double> band_mm;
  const auto add = [&](int corner, double wide_mm) {
    double& own = band_mm.try_emplace(corner, 0).first->second;
    own = std::max(own, wide_mm);
  };
  for (const Crease& crease : creases) {
    add(crease.corner, crease.band_mm);
    if (!(crease.band_mm > 0)) continue;
    for (const auto& [from, wide_mm] : {std::pair{crease.corner, crease.band_mm - crease.beyond_mm},
                                        std::pair{mesh.beyond(crease.corner), crease.beyond_mm}}) {
      const double end_mm = wide_mm * (1 + 1e-9);  // a difference is rounded
      (void)walks.walk(from, [&](double passed_mm, int exit, int next) {
        if (passed_mm > end_mm) return false;
        add(std::min(exit, next), crease.band_mm);
        return true;
      });
    }
  }
  std::vector<Crease> all;
  all.reserve(band_mm.size());
  for (const auto& [corner, wide_mm] : band_mm) all.push_back({corner, wide_mm, 0});
  return all;
}

}  // namespace hotblade::surface

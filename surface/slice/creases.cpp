#include "surface/slice/creases.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <utility>

#include "surface/read/blocks.hpp"
#include "surface/read/half_edges.hpp"
#include "surface/slice/crease_bands.hpp"
#include "surface/slice/fold_limits.hpp"
#include "surface/slice/walks.hpp"

namespace hotblade::surface {
namespace {

using Eigen::Vector3d;

// Edges that are creases by themselves.
class CreaseEdges : private Walks {
 public:
  CreaseEdges(const TriangleMesh& mesh, const CreaseLimits& limits) : Walks(mesh), folds_(limits) {
    constexpr double kMargin = 1e-9;  // far over the rounding of a cosine, and of no fold that matters
    flat_ = std::cos(folds_.least_rad()) + kMargin;
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
  // Adds the creases between a face and those of higher numbers.
  void look(int face, std::vector<int>& found) const {
    const HalfEdges& half_edges = mesh_.half_edges();
    const Vector3d own = across_face(mesh_, face);
    HalfEdges::Halfedge h = half_edges.first(face);
    for (int corner = 3 * face; corner < 3 * face + 3;
         ++corner, h = half_edges.mesh().next_halfedge_handle(h)) {
      const HalfEdges::Halfedge beyond = half_edges.across(h);
      if (!beyond.is_valid()) continue;
      const int other = half_edges.mesh().face_handle(beyond).idx();
      if (other < face) continue;
      if (!surely_flat(own, across_face(mesh_, other)) && is_crease(corner, half_edges.corner_of(beyond)))
        found.push_back(corner);
    }
  }

  // Told without a root or an angle of nearly all edges of a smooth surface: their fold rounds off.
  [[nodiscard]] bool surely_flat(const Vector3d& m, const Vector3d& n) const {
    constexpr double kLeastSquares = 1e-200;  // smaller products of squared areas may have lost digits
    const double cosine = m.dot(n), squares = m.squaredNorm() * n.squaredNorm();
    return flat_ > 0 && cosine > 0 && squares > kLeastSquares && cosine * cosine > flat_ * flat_ * squares;
  }

  [[nodiscard]] bool is_crease(int corner, int other) const {
    const double fold = turn(corner / 3, other / 3);
    if (!folds_.counts(fold)) return false;
    const double wide_mm = folds_.wide_mm(fold);
    return kept_mm(corner, fold, wide_mm) > wide_mm && kept_mm(other, fold, wide_mm) > wide_mm &&
           (!folds_.rounds_off(fold) ||
            (stands_alone(corner, fold, wide_mm) && stands_alone(other, fold, wide_mm)));
  }

  // Whether the surface goes on from an edge into its triangle for longer than `wide_mm`, with no other edge
  // on the way, as far as a walk goes, that folds like it.
  [[nodiscard]] bool stands_alone(int corner, double fold, double wide_mm) const {
    bool alone = true;
    const Walk walked = walk(corner, [&](double passed_mm, int exit, int next) {
      alone = turn(exit / 3, next / 3) <= FoldLimits::kKept * fold;
      return alone && passed_mm <= FoldLimits::kFarMm;
    });
    return alone && walked.way_mm > wide_mm;
  }

  // How far the surface goes on from an edge into its triangle, square to it, and keeps its direction;
  // followed to beyond `enough_mm` only. Infinity where the surface ends before it turns.
  [[nodiscard]] double kept_mm(int corner, double fold, double enough_mm) const {
    const Walk walked = walk(corner, [&](double passed_mm, int, int next) {
      return passed_mm <= std::min(enough_mm, FoldLimits::kFarMm) &&
             turn(corner / 3, next / 3) <= FoldLimits::kKept * fold;
    });
    return walked.to_border ? std::numeric_limits<double>::infinity() : walked.way_mm;
  }

  FoldLimits folds_;
  double flat_ = 1;  // the cosine of a fold above which it rounds off
};

}  // namespace

Creases creases(const TriangleMesh& mesh, const CreaseLimits& limits) {
  if (!(limits.tolerance_mm > 0) || !(limits.least_radius_mm > 0))
    throw std::logic_error("creases: limits have to be above 0");
  if (mesh.triangles().empty()) return {};
  // A plan asks for them at each of its steps.
  return mesh.half_edges().found_once<Creases>(
      {limits.tolerance_mm, limits.least_radius_mm, limits.shallow ? 1.0 : 0.0}, [&] {
        Creases found = crease_bands(mesh, limits);
        std::vector<int> edges = CreaseEdges(mesh, limits).run();
        edges.insert(edges.end(), found.edges.begin(), found.edges.end());
        std::sort(edges.begin(), edges.end());
        edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
        found.edges = std::move(edges);
        return found;
      });
}

}  // namespace hotblade::surface

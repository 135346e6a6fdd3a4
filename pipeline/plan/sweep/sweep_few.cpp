#include "pipeline/plan/sweep/sweep_few.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "gpu/backend/stop.hpp"
#include "pipeline/plan/direction/body_axes.hpp"
#include "surface/read/blocks.hpp"

namespace hotblade::pipeline {

namespace {

using Eigen::Vector3d;

// The points that stand for others.
class Stands {
 public:
  Stands(const WasteSurface& surface, const BodyAxes& body, double cell_mm)
      : rank_(surface.points.size(), kPlain), for_(surface.points.size()) {
    for (const auto& [a, b] : surface.border)
      rank_[static_cast<std::size_t>(a)] = rank_[static_cast<std::size_t>(b)] = kBorder;
    for (const int corner : surface.corners) rank_[static_cast<std::size_t>(corner)] = kCorner;
    std::vector<std::uint64_t> cells(surface.points.size());
    std::vector<double> off(surface.points.size());
    constexpr std::size_t kPoints = 1 << 12;
    surface::for_blocks(cells.size(), kPoints, [&](std::size_t first, std::size_t last) {
      gpu::stop_point();
      for (std::size_t i = first; i < last; ++i) {
        const Vector3d d = surface.points[i] - body.centre;
        for (const Vector3d& axis : body.axes) {
          const double at = axis.dot(d) / cell_mm, middle = std::round(at);
          // 21 bits an axis: a million cells to either side.
          cells[i] =
              cells[i] << 21 | (static_cast<std::uint64_t>(static_cast<std::int64_t>(middle)) & 0x1FFFFF);
          off[i] += (at - middle) * (at - middle);
        }
      }
    });
    std::unordered_map<std::uint64_t, std::pair<Key, int>> nearest;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const Key key{rank_[i], off[i]};
      const auto [at, fresh] = nearest.try_emplace(cells[i], key, static_cast<int>(i));
      if (!fresh && key < at->second.first) at->second = {key, static_cast<int>(i)};
    }
    for (std::size_t i = 0; i < cells.size(); ++i) for_[i] = nearest.at(cells[i]).second;
  }

  [[nodiscard]] int of(int v) const { return for_[static_cast<std::size_t>(v)]; }

 private:
  enum Rank { kCorner, kBorder, kPlain };
  using Key = std::pair<Rank, double>;
  std::vector<Rank> rank_;
  std::vector<int> for_;
};

}  // namespace

double cell_for(double least_radius_mm, double tolerance_mm) {
  constexpr double kOfTolerance = 0.1;
  return std::sqrt(8 * least_radius_mm * kOfTolerance * tolerance_mm);
}

std::shared_ptr<const WasteSurface> few_of(const WasteSurface& surface, const surface::TriangleMesh& mesh,
                                           double cell_mm) {
  // Of the triangles, and so many of them: less is cut sooner than it is thinned.
  constexpr std::size_t kFewer = 8, kDense = 50000;
  if (surface.triangles.size() < kDense || !(cell_mm > 0)) return nullptr;
  const Stands stands(surface, body_axes(mesh), cell_mm);
  std::vector<std::array<int, 3>> triangles;
  for (const auto& t : surface.triangles) {
    std::array<int, 3> few{stands.of(t[0]), stands.of(t[1]), stands.of(t[2])};
    if (few[0] == few[1] || few[1] == few[2] || few[2] == few[0]) continue;
    std::rotate(few.begin(), std::min_element(few.begin(), few.end()), few.end());
    triangles.push_back(few);
  }
  std::sort(triangles.begin(), triangles.end());
  triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
  if (kFewer * triangles.size() > surface.triangles.size()) return nullptr;
  auto few = std::make_shared<WasteSurface>();
  std::unordered_map<int, int> index;
  const auto taken = [&](int v) {
    const auto [at, fresh] = index.try_emplace(v, static_cast<int>(few->points.size()));
    if (fresh) {
      few->points.push_back(surface.points[static_cast<std::size_t>(v)]);
      few->normals.push_back(surface.normals[static_cast<std::size_t>(v)]);
      few->bends.push_back(surface.bends[static_cast<std::size_t>(v)]);
    }
    return at->second;
  };
  for (const auto& t : triangles) few->triangles.push_back({taken(t[0]), taken(t[1]), taken(t[2])});
  for (const auto& [a, b] : surface.border) {
    const auto from = index.find(stands.of(a)), to = index.find(stands.of(b));
    if (from == index.end() || to == index.end() || from == to) continue;
    few->border.push_back(std::minmax(from->second, to->second));
  }
  std::sort(few->border.begin(), few->border.end());
  few->border.erase(std::unique(few->border.begin(), few->border.end()), few->border.end());
  for (const int corner : surface.corners) {
    if (const auto at = index.find(stands.of(corner)); at != index.end()) few->corners.push_back(at->second);
  }
  std::sort(few->corners.begin(), few->corners.end());
  few->corners.erase(std::unique(few->corners.begin(), few->corners.end()), few->corners.end());
  return few;
}

}  // namespace hotblade::pipeline

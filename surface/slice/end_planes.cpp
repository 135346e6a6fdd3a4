#include "surface/slice/end_planes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace hotblade::surface {
namespace {

// Of a section's length: less is what ribs grow and shrink by anyway, and moves their ends by less than a
// millimetre on ribs of half a metre.
constexpr double kMissing = 0.002;
// Of the planes' distance: over it a surface bends as little as between two ribs.
constexpr double kFarthest = 0.2;

// Length that a plane cuts out of a triangle whose corners lie `h` above it.
double length_in(const std::array<Eigen::Vector3d, 3>& corner, const std::array<double, 3>& h) {
  std::array<Eigen::Vector3d, 2> ends{};
  std::size_t found = 0;
  for (std::size_t i = 0; i < 3 && found < 2; ++i) {
    const std::size_t j = (i + 1) % 3;
    if ((h[i] < 0) == (h[j] < 0)) continue;
    ends[found++] = corner[i] + h[i] / (h[i] - h[j]) * (corner[j] - corner[i]);
  }
  return found == 2 ? (ends[1] - ends[0]).norm() : 0;
}

}  // namespace

EndPlanes end_planes(const TriangleMesh& mesh, const PlaneFamily& planes, const SliceOptions& options) {
  std::vector<double> height;
  height.reserve(mesh.vertices().size());
  for (const Eigen::Vector3d& p : mesh.vertices()) height.push_back(planes.offset(p));
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const auto& t : mesh.triangles()) {
    for (const int v : t) {
      low = std::min(low, height[static_cast<std::size_t>(v)]);
      high = std::max(high, height[static_cast<std::size_t>(v)]);
    }
  }
  EndPlanes ends{{low + options.end_inset_mm, high - options.end_inset_mm}, {}};
  ends.taken = ends.at;
  std::vector<double> insets;
  const double farthest = std::min(kFarthest * options.spacing_mm, 0.5 * kFarthest * (high - low));
  for (double inset = options.end_inset_mm; inset > 0 && inset <= 2 * farthest; inset *= 2)
    insets.push_back(inset);
  if (insets.size() < 2) return ends;
  std::array<std::vector<double>, 2> length{std::vector<double>(insets.size()),
                                            std::vector<double>(insets.size())};
  for (const auto& t : mesh.triangles()) {
    std::array<double, 3> h{};
    for (std::size_t i = 0; i < 3; ++i) h[i] = height[static_cast<std::size_t>(t[i])];
    const auto [least, most] = std::minmax({h[0], h[1], h[2]});
    if (least - low > insets.back() && high - most > insets.back()) continue;
    const auto at = [&](std::size_t i) { return mesh.vertices()[static_cast<std::size_t>(t[i])]; };
    for (std::size_t k = 0; k < insets.size(); ++k) {
      for (std::size_t end = 0; end < 2; ++end) {
        const double plane = end == 0 ? low + insets[k] : high - insets[k];
        if (plane < least || plane > most) continue;
        length[end][k] += length_in({at(0), at(1), at(2)}, {h[0] - plane, h[1] - plane, h[2] - plane});
      }
    }
  }
  for (std::size_t end = 0; end < 2; ++end) {
    for (std::size_t k = 0; k + 1 < insets.size(); ++k) {
      if (length[end][k] < (1 - kMissing) * length[end][k + 1]) continue;
      ends.taken[end] = end == 0 ? low + insets[k] : high - insets[k];
      break;
    }
  }
  return ends;
}

void move_to_plane(SectionPiece& piece, const PlaneFamily& planes, double from_mm, double to_mm) {
  if (from_mm == to_mm) return;
  const Eigen::Vector3d sweep = planes.normal(from_mm);
  piece.length_mm = 0;
  for (std::size_t i = 0; i < piece.points.size(); ++i) {
    SectionPoint& q = piece.points[i];
    const double lean = q.normal.dot(sweep);
    // Steeper surfaces are not cut anyway; their tangent planes would lead far away.
    constexpr double kMostLean = 0.9;
    const Eigen::Vector3d along =
        std::abs(lean) < kMostLean ? Eigen::Vector3d((sweep - lean * q.normal) / (1 - lean * lean)) : sweep;
    const Eigen::Vector3d beyond = q.p + 2 * (to_mm - from_mm) * along;
    q.p += planes.crossing(q.p, from_mm, beyond, planes.offset(beyond), to_mm) * (beyond - q.p);
    if (i > 0) piece.length_mm += (q.p - piece.points[i - 1].p).norm();
  }
  if (piece.closed) piece.length_mm += (piece.points.front().p - piece.points.back().p).norm();
}

}  // namespace hotblade::surface

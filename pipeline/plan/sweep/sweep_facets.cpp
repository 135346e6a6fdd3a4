#include "pipeline/plan/sweep/sweep_facets.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace hotblade::pipeline {

namespace {

using Eigen::Vector3d;

// How far the quadratic surface over a facet goes to one side of it and to the other, mm.
double rise_mm(const WasteSurface& surface, const std::array<int, 3>& triangle) {
  double low = 0, high = 0, sum = 0;
  for (std::size_t c = 0; c < triangle.size(); ++c) {
    const auto a = static_cast<std::size_t>(triangle[c]), b = static_cast<std::size_t>(triangle[(c + 1) % 3]);
    // An arc whose ends' normals differ so rises by an eighth of it along the chord.
    const double edge =
        (surface.normals[b] - surface.normals[a]).dot(surface.points[b] - surface.points[a]) / 8;
    low = std::min(low, edge);
    high = std::max(high, edge);
    sum += edge;
  }
  // A quadratic function that is zero at the corners has four ninths of its edges' middles' sum in the
  // middle.
  const double middle = sum * 4 / 9;
  return std::max(high, middle) - std::min(low, middle);
}

}  // namespace

FacetRise smooth_over_facets(const WasteSurface& surface, std::span<const SweepSeam> seams) {
  std::vector<std::pair<double, double>> rises;  // with areas
  double all = 0;
  for (const auto& triangle : surface.triangles) {
    const auto at = [&](std::size_t c) -> const Vector3d& {
      return surface.points[static_cast<std::size_t>(triangle[c])];
    };
    const Vector3d middle = (at(0) + at(1) + at(2)) / 3;
    const bool inside = std::all_of(seams.begin(), seams.end(), [&](const SweepSeam& seam) {
      return seam.normal.dot(middle) <= seam.at_mm;
    });
    if (!inside) continue;
    const double area = (at(1) - at(0)).cross(at(2) - at(0)).norm() / 2;
    rises.emplace_back(rise_mm(surface, triangle), area);
    all += area;
  }
  std::sort(rises.begin(), rises.end());
  double passed = 0;
  for (const auto& [rise, area] : rises) {
    passed += area;
    if (passed >= all / 2) return {rise / 2, std::sqrt(2 * area)};
  }
  return {};
}

}  // namespace hotblade::pipeline

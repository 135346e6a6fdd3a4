#include "surface/slice/event_planes.hpp"

#include <algorithm>
#include <cstdint>

namespace hotblade::surface {
namespace {

std::vector<bool> border_vertices(const TriangleMesh& mesh) {
  std::vector<bool> border(mesh.vertices().size(), false);
  for (const int c : mesh.border())
    border[static_cast<std::size_t>(vertex_at(mesh, c))] =
        border[static_cast<std::size_t>(vertex_at(mesh, next_corner(c)))] = true;
  return border;
}

// Does a chain end at section k or begin at section k + 1, for each gap k?
std::vector<bool> gaps_with_ends(std::span<const RibNode> nodes, std::size_t planes) {
  std::vector<bool> gaps(planes - 1, false);
  for (const RibNode& n : nodes) {
    const auto k = static_cast<std::size_t>(n.section);
    if (n.next == RibNode::kNone && k + 1 < planes) gaps[k] = true;
    if (n.previous == RibNode::kNone && k > 0) gaps[k - 1] = true;
  }
  return gaps;
}

}  // namespace

std::vector<double> critical_heights(const TriangleMesh& mesh, const PlaneFamily& planes) {
  std::vector<double> height;
  height.reserve(mesh.vertices().size());
  for (const Eigen::Vector3d& p : mesh.vertices()) height.push_back(planes.offset(p));
  const auto below = [&](int a, int b) {
    const double ha = height[static_cast<std::size_t>(a)], hb = height[static_cast<std::size_t>(b)];
    return ha < hb || (ha == hb && a < b);
  };
  // How often the ring of neighbours passes through the vertex's height: twice for a regular vertex, once at
  // a border.
  std::vector<std::uint32_t> passes(mesh.vertices().size(), 0);
  std::vector<bool> used(mesh.vertices().size(), false);
  for (const auto& t : mesh.triangles()) {
    for (std::size_t i = 0; i < 3; ++i) {
      const int v = t[i], a = t[(i + 1) % 3], b = t[(i + 2) % 3];
      used[static_cast<std::size_t>(v)] = true;
      if (below(a, v) != below(b, v)) ++passes[static_cast<std::size_t>(v)];
    }
  }
  const std::vector<bool> border = border_vertices(mesh);
  std::vector<double> critical;
  for (std::size_t v = 0; v < height.size(); ++v) {
    if (used[v] && passes[v] != (border[v] ? 1U : 2U)) critical.push_back(height[v]);
  }
  std::sort(critical.begin(), critical.end());
  critical.erase(std::unique(critical.begin(), critical.end()), critical.end());
  return critical;
}

std::vector<double> with_event_planes(const TriangleMesh& mesh, const PlaneFamily& planes,
                                      std::span<const RibNode> nodes, const std::vector<double>& offsets,
                                      double inset_mm) {
  constexpr std::size_t kMostAGap = 4;
  const std::vector<bool> gaps = gaps_with_ends(nodes, offsets.size());
  if (std::find(gaps.begin(), gaps.end(), true) == gaps.end() || !(inset_mm > 0)) return offsets;
  const std::vector<double> critical = critical_heights(mesh, planes);
  std::vector<double> all;
  // Closer planes than this are one.
  const auto add = [&](double offset, double next) {
    if (offset - all.back() > 0.5 * inset_mm && next - offset > 0.5 * inset_mm) all.push_back(offset);
  };
  for (std::size_t k = 0; k < offsets.size(); ++k) {
    all.push_back(offsets[k]);
    if (k + 1 == offsets.size() || !gaps[k]) continue;
    const double next = offsets[k + 1];
    const auto from = std::lower_bound(critical.begin(), critical.end(), offsets[k]);
    const auto count = static_cast<std::size_t>(std::lower_bound(from, critical.end(), next) - from);
    const std::size_t taken = std::min(count, kMostAGap);
    for (std::size_t i = 0; i < taken; ++i) {
      const std::size_t at = taken < 2 ? 0 : i * (count - 1) / (taken - 1);
      const double h = *(from + static_cast<std::ptrdiff_t>(at));
      add(h - inset_mm, next);
      add(h + inset_mm, next);
    }
  }
  return all;
}

}  // namespace hotblade::surface

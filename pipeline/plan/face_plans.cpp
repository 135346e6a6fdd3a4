#include "pipeline/plan/face_plans.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <numeric>
#include <string>
#include <utility>

#include "gpu/backend/stop.hpp"
#include "gpu/mesh/mesh_distance.hpp"
#include "pipeline/verify/mesh_view.hpp"
#include "surface/slice/smooth_faces.hpp"

namespace hotblade::pipeline {

surface::DesignSurface face_of(const surface::DesignSurface& design, const surface::TriangleMesh& mesh) {
  surface::DesignSurface face;
  face.units = design.units;
  face.scale_to_mm = design.scale_to_mm;
  face.up = design.up;
  face.health.vertices = mesh.vertices().size();
  face.health.triangles = mesh.triangles().size();
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : mesh.vertices()) box.extend(p);
  face.health.bbox_mm = {box.min(), box.max()};
  face.health.area_mm2 = area_mm2(mesh);
  face.mesh = mesh;
  return face;
}

double area_mm2(const surface::TriangleMesh& mesh) {
  const MeshView view{mesh.vertices(), mesh.triangles()};
  double area = 0;
  for (std::size_t f = 0; f < mesh.triangles().size(); ++f) area += facet(view, static_cast<int>(f)).area();
  return area;
}

void largest_first(const std::vector<surface::TriangleMesh>& faces,
                   const std::function<bool(std::size_t)>& plan) {
  // Whoever is told that a face cannot be cut is not helped by strips for a hundredth of it.
  constexpr double kSmall = 0.01;
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < faces.size(); ++i) order.emplace_back(-area_mm2(faces[i]), i);
  std::sort(order.begin(), order.end());
  double least = 0;
  for (const auto& [area, i] : order) {
    if (-area < least) break;
    if (!plan(i)) least = std::max(least, kSmall * -area);
  }
}

std::vector<surface::TriangleMesh> parts_apart(const surface::TriangleMesh& mesh) {
  const std::vector<int> of = surface::connected_parts(mesh);
  const auto count = static_cast<std::size_t>(1 + *std::max_element(of.begin(), of.end()));
  if (count == 1) return {mesh};
  std::vector<std::vector<int>> triangles(count);
  for (std::size_t f = 0; f < of.size(); ++f)
    triangles[static_cast<std::size_t>(of[f])].push_back(static_cast<int>(f));
  struct Part {
    surface::TriangleMesh mesh;
    Eigen::AlignedBox3d box;
    gpu::MeshDistance distance;
    explicit Part(const surface::TriangleMesh& own) : mesh(own), distance(mesh.vertices(), mesh.triangles()) {
      for (const Eigen::Vector3d& p : mesh.vertices()) box.extend(p);
    }
    [[nodiscard]] bool near(const Part& other) const {
      if (box.exteriorDistance(other.box) > kTogetherMm) return false;
      std::vector<Eigen::Vector3d> close;
      for (const Eigen::Vector3d& p : other.mesh.vertices())
        if (box.exteriorDistance(p) <= kTogetherMm) close.push_back(p);
      const std::vector<gpu::Nearest> nearest = distance.query(close);
      return std::any_of(nearest.begin(), nearest.end(),
                         [](const gpu::Nearest& n) { return n.distance <= kTogetherMm; });
    }
  };
  std::vector<Part> parts;
  parts.reserve(count);
  for (const std::vector<int>& own : triangles) parts.emplace_back(surface::mesh_of(mesh, own));
  // Each part's group: the number of its first.
  std::vector<std::size_t> group(count);
  std::iota(group.begin(), group.end(), std::size_t{0});
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      gpu::stop_point();
      if (group[i] == group[j] || !(parts[i].near(parts[j]) || parts[j].near(parts[i]))) continue;
      const auto [first, second] = std::minmax(group[i], group[j]);
      std::replace(group.begin(), group.end(), second, first);
    }
  }
  std::vector<surface::TriangleMesh> apart;
  for (std::size_t i = 0; i < count; ++i) {
    if (group[i] != i) continue;
    std::vector<int> own;
    for (std::size_t f = 0; f < of.size(); ++f)
      if (group[static_cast<std::size_t>(of[f])] == i) own.push_back(static_cast<int>(f));
    if (own.size() == of.size()) return {mesh};
    apart.push_back(surface::mesh_of(mesh, own));
  }
  return apart;
}

bool may_share_a_block(const std::vector<surface::TriangleMesh>& parts, const StockSettings& stock) {
  const double reach =
      Eigen::Vector3d(stock.max_size_mm[0], stock.max_size_mm[1], stock.max_size_mm[2]).norm();
  std::vector<Eigen::AlignedBox3d> boxes(parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (const Eigen::Vector3d& p : parts[i].vertices()) boxes[i].extend(p);
    for (std::size_t j = 0; j < i; ++j)
      if (boxes[i].exteriorDistance(boxes[j]) < reach) return true;
  }
  return false;
}

void append(SweptPlan& whole, SweptPlan face) {
  const std::size_t before = whole.fits.size();
  const auto renamed = [&](const std::string& id) {
    constexpr std::size_t kLetter = 1;
    return fmt::format("S{:03}", before + std::stoul(id.substr(kLetter)));
  };
  if (before == 0) whole.planes = face.planes;
  for (StripPlan& strip : face.strips) {
    strip.id = renamed(strip.id);
    whole.strips.push_back(std::move(strip));
  }
  for (Refusal& refusal : face.refusals) {
    refusal.strip = renamed(refusal.strip);
    whole.refusals.push_back(std::move(refusal));
  }
  whole.parts += face.parts;
  whole.fits.insert(whole.fits.end(), face.fits.begin(), face.fits.end());
  whole.deviation_mm = std::max(whole.deviation_mm, face.deviation_mm);
  whole.sag_mm = std::max(whole.sag_mm, face.sag_mm);
}

}  // namespace hotblade::pipeline

#include "pipeline/plan/face_plans.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <string>
#include <utility>

#include "pipeline/verify/mesh_view.hpp"

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
  const MeshView view{mesh.vertices(), mesh.triangles()};
  for (std::size_t f = 0; f < mesh.triangles().size(); ++f)
    face.health.area_mm2 += facet(view, static_cast<int>(f)).area();
  face.mesh = mesh;
  return face;
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

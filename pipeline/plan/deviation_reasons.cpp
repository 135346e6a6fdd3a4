#include "pipeline/plan/deviation_reasons.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "gpu/mesh/mesh_distance.hpp"
#include "pipeline/plan/blade_reach.hpp"
#include "pipeline/sayings/saying.hpp"
#include "pipeline/verify/branch.hpp"
#include "pipeline/verify/design_faces.hpp"
#include "surface/slice/smooth_faces.hpp"

namespace hotblade::pipeline {

namespace {

// The smooth face that a place lies on: a strip forms one, and ends at its creases.
const surface::TriangleMesh& face_at(const std::vector<surface::TriangleMesh>& faces,
                                     const Eigen::Vector3d& place) {
  if (faces.size() == 1) return faces.front();
  std::vector<double> distances;
  distances.reserve(faces.size());
  for (const surface::TriangleMesh& face : faces)
    distances.push_back(
        gpu::MeshDistance(face.vertices(), face.triangles()).query(std::span(&place, 1)).front().distance);
  const auto nearest = std::min_element(distances.begin(), distances.end());
  return faces[static_cast<std::size_t>(nearest - distances.begin())];
}

// The rib of the refusal's strip that is nearest to its place.
void name_rib(const std::vector<Strip>& strips, Refusal& refusal) {
  if (!refusal.rib.empty() || !refusal.at) return;
  const auto strip =
      std::find_if(strips.begin(), strips.end(), [&](const Strip& s) { return s.id == refusal.strip; });
  if (strip != strips.end()) refusal.rib = nearest_rib(*strip, *refusal.at);
}

}  // namespace

Refusal deviation_refusal(const PlanResult& result, double tolerance_mm) {
  const VerifyReport& v = result.verification;
  Refusal refusal{"design", "", Limit::kDeviation, v.bound_mm, tolerance_mm};
  refusal.capped = v.capped;
  refusal.at = v.deviation.at;
  const auto number = static_cast<std::size_t>(
      std::max_element(v.strip_bound_mm.begin(), v.strip_bound_mm.end()) - v.strip_bound_mm.begin());
  if (number < result.strips.size()) {
    constexpr double kFarLess = 0.9;
    const double measured_mm = v.strip_max_mm[number];
    const double told_mm = number < v.strip_told_mm.size() ? v.strip_told_mm[number] : 0;
    refusal.strip = result.strips[number].id;
    refusal.at = v.strip_max_at[number];
    name_rib(result.program.strips, refusal);
    if (measured_mm < kFarLess * v.bound_mm) refusal.when = say(Saying::kMeasuredThere, {measured_mm});
    if (v.bound_mm - told_mm <= tolerance_mm) refusal.note = say(Saying::kByRegisters, {told_mm});
  }
  refusal.place = say(Saying::kAt, {refusal.at->x(), refusal.at->y(), refusal.at->z()});
  return refusal;
}

void explain_deviations(const surface::DesignSurface& design, const Settings& settings, PlanResult& result) {
  constexpr std::size_t kMost = 3;  // of the reasons that a report begins with
  constexpr double kAround_mm = 150;
  std::vector<Refusal*> unexplained;
  for (Refusal& refusal : result.refusals) {
    if (refusal.limit == Limit::kDeviation) name_rib(result.program.strips, refusal);
    if (refusal.limit == Limit::kDeviation && refusal.note.empty() && refusal.at &&
        unexplained.size() < kMost)
      unexplained.push_back(&refusal);
  }
  if (unexplained.empty()) return;
  const surface::CreaseLimits limits = crease_limits(settings, settings.blade);
  const std::vector<surface::TriangleMesh> faces = surface::smooth_faces(design.mesh, limits);
  // A cut on the inner side of the bend is sharper than the blade.
  const double half_band_mm = 0.5 * settings.blade.band_mm(settings.motion.feed_mm_s);
  const CutLimits cut{limits.tolerance_mm, 1 / (limits.least_radius_mm - half_band_mm)};
  for (Refusal* refusal : unexplained) {
    const std::optional<BladeReach> reach =
        shortest_reach(face_at(faces, *refusal->at), *refusal->at, kAround_mm, cut);
    refusal->note = reach ? say(Saying::kBladeReach, {reach->at.x(), reach->at.y(), reach->at.z(),
                                                      limits.least_radius_mm, std::ceil(reach->half_mm)})
                          : say(Saying::kNoBound, {result.decisions.size()});
  }
}

}  // namespace hotblade::pipeline

#include "pipeline/verify/budget.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "gpu/backend/stop.hpp"
#include "pipeline/verify/design_faces.hpp"
#include "surface/read/blocks.hpp"
#include "surface/slice/smooth_faces.hpp"

namespace hotblade::pipeline {

namespace {

// Registers count micrometres: half a count on each axis.
constexpr double kQuantisationMm = 0.5e-3 * 1.7320508075688772;

struct Side {
  Eigen::Vector3d normal{0, 0, 0};
  double height = 0;
};

}  // namespace

// Linear interpolation's error, and what a denser sampling of the same motion would move.
double interpolation_mm(const Program& program) {
  double worst = 0;
  for (const Strip& strip : program.strips) {
    for (std::size_t i = 2; i < strip.poses.size(); ++i) {
      const BladePose &p = strip.poses[i - 2], &q = strip.poses[i - 1], &r = strip.poses[i];
      if (q.phase != StripPhase::kCut) continue;
      for (const auto clamp : {&BladePose::a, &BladePose::b}) {
        const Eigen::Vector3d bend = (p.*clamp).p - 2 * (q.*clamp).p + (r.*clamp).p;
        worst = std::max(worst, bend.norm() / 8);
      }
    }
  }
  return worst;
}

double mesh_chord_mm(const surface::TriangleMesh& mesh, const surface::CreaseLimits& limits) {
  std::vector<int> face_of;
  const surface::Creases creases = surface::creases(mesh, limits);
  // Most designs have none, and are one face.
  if (creases.empty())
    face_of.assign(mesh.triangles().size(), 0);
  else
    (void)surface::smooth_faces(mesh, limits, &face_of);
  // Bands stand for corners also where they part nothing.
  for (const int face : creases.bands) face_of[static_cast<std::size_t>(face)] = -1;
  // The face of a corner, seen from the corner's edge.
  const auto side = [&](std::size_t corner) -> Side {
    const auto& t = mesh.triangles()[corner / 3];
    const auto at = [&](std::size_t i) { return mesh.vertices()[static_cast<std::size_t>(t[i % 3])]; };
    const Eigen::Vector3d a = at(corner % 3), b = at(corner % 3 + 1), c = at(corner % 3 + 2);
    const Eigen::Vector3d n = (b - a).cross(c - a);
    const double length = (b - a).norm();
    if (!(length > 0) || !(n.norm() > 0)) return {};
    return {n.normalized(), n.norm() / length};
  };
  // Where an arc that turns by `angle` over a chord of the mean face height rises by height * angle / 8.
  const auto add_chord = [&](int c, std::vector<double>& chords) {
    const int beyond = mesh.beyond(c);
    if (beyond < c) return;  // none, or met from the other face
    const int face = face_of[static_cast<std::size_t>(c / 3)];
    if (face < 0 || face != face_of[static_cast<std::size_t>(beyond / 3)]) return;
    if (std::binary_search(creases.edges.begin(), creases.edges.end(), c)) return;
    const Side p = side(static_cast<std::size_t>(c)), q = side(static_cast<std::size_t>(beyond));
    if (!(p.height > 0) || !(q.height > 0)) return;
    const double angle = std::atan2(p.normal.cross(q.normal).norm(), p.normal.dot(q.normal));
    chords.push_back(0.5 * (p.height + q.height) * angle / 8);
  };
  constexpr std::size_t kCorners = 3 << 14;
  const std::size_t corners = 3 * mesh.triangles().size();
  std::vector<std::vector<double>> of((corners + kCorners - 1) / kCorners);
  surface::for_blocks(corners, kCorners, [&](std::size_t first, std::size_t last) {
    gpu::stop_point();
    for (std::size_t c = first; c < last; ++c) add_chord(static_cast<int>(c), of[first / kCorners]);
  });
  std::vector<double> chords;
  for (const std::vector<double>& block : of) chords.insert(chords.end(), block.begin(), block.end());
  if (chords.empty()) return 0;
  const auto nth =
      chords.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(chords.size() - 1));
  std::nth_element(chords.begin(), nth, chords.end());
  return *nth;
}

std::vector<std::pair<std::string, double>> error_budget(const surface::DesignSurface& design,
                                                         const Program& program, const PoseErrors& errors) {
  double fit = 0;
  for (const Strip& strip : program.strips) {
    for (const Rib& rib : strip.ribs) fit = std::max(fit, rib.design_deviation_mm);
  }
  return {{"mesh", mesh_chord_mm(design.mesh, crease_limits(program.settings, program.blade))},
          {"fit", std::max(0.0, fit - errors.joint_fit_mm)},
          {kJointFitLine, std::min(fit, errors.joint_fit_mm)},
          {"between_ribs", std::max(0.0, program.verification.deviation_mm.max - fit)},
          {kInterpolationLine, interpolation_mm(program) + errors.off_plane_mm},
          {"quantisation", std::max(kQuantisationMm, errors.told_mm)},
          {kDroopLine, errors.droop_mm},
          {kInPlaneLine, errors.in_plane_mm},
          {kClampErrorLine, errors.clamp_mm}};
}

double budget_sum_mm(const std::vector<std::pair<std::string, double>>& budget_mm) {
  double sum = 0;
  for (const auto& entry : budget_mm) sum += entry.second;
  return sum;
}

}  // namespace hotblade::pipeline

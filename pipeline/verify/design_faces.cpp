#include "pipeline/verify/design_faces.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>

#include "elastica/curve/elastica.hpp"
#include "gpu/backend/stop.hpp"
#include "pipeline/verify/mesh_view.hpp"
#include "robot/blade/blade_section.hpp"
#include "surface/slice/smooth_faces.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kFeetAtOnce = 1024;

}  // namespace

surface::CreaseLimits crease_limits(const Settings& settings, const robot::Blade& blade) {
  return {settings.design.tolerance_mm, 1 / robot::max_curvature_per_mm(blade),
          settings.slice.shallow_folds == ShallowFolds::kParted};
}

DesignFaces::Face::Face(const surface::TriangleMesh& of, gpu::Backend backend)
    : mesh(of), border(of), to_face(of.vertices(), of.triangles(), backend) {}

DesignFaces::DesignFaces(const surface::TriangleMesh& design, const Program& program, gpu::Backend backend)
    : face_of_strip_(program.strips.size(), 0) {
  std::vector<int> face_of_triangle;
  for (const surface::TriangleMesh& mesh :
       surface::smooth_faces(design, crease_limits(program.settings, program.blade), &face_of_triangle))
    faces_.emplace_back(mesh, backend);
  if (faces_.size() > 1) assign(design, face_of_triangle, program);
}

void DesignFaces::assign(const surface::TriangleMesh& design, const std::vector<int>& face_of_triangle,
                         const Program& program) {
  const gpu::MeshDistance to_design(design.vertices(), design.triangles());
  for (std::size_t s = 0; s < program.strips.size(); ++s) {
    std::vector<Vector3d> points;
    for (const Rib& rib : program.strips[s].ribs) {
      // Ends may lie past a crease: the middle does not.
      constexpr int kSamples = 33, kEnds = 4;
      const std::vector<elastica::CurvePoint> curve = elastica::sample(rib.elastica, kSamples);
      for (int i = kEnds; i < kSamples - kEnds; ++i) {
        const elastica::CurvePoint& q = curve[static_cast<std::size_t>(i)];
        points.push_back(rib.frame.point(q.x, q.y));
      }
    }
    std::vector<std::size_t> votes(faces_.size(), 0);
    for (const gpu::Nearest& nearest : to_design.query(points)) {
      const int face = face_of_triangle[static_cast<std::size_t>(nearest.triangle)];
      if (face >= 0) ++votes[static_cast<std::size_t>(face)];
    }
    face_of_strip_[s] =
        static_cast<std::size_t>(std::max_element(votes.begin(), votes.end()) - votes.begin());
  }
}

DesignFaces::Foot DesignFaces::foot(const Face& face, const gpu::Nearest& nearest) {
  return {nearest.distance, nearest.point,
          facet({face.mesh.vertices(), face.mesh.triangles()}, nearest.triangle).normal(),
          face.border.holds(nearest)};
}

std::vector<DesignFaces::Foot> DesignFaces::feet(std::span<const Vector3d> points,
                                                 const std::function<int(std::size_t)>& strip_of) const {
  return find(points, strip_of, false);
}

std::vector<DesignFaces::Foot> DesignFaces::feet_and_sides(
    std::span<const Vector3d> points, const std::function<int(std::size_t)>& strip_of) const {
  return find(points, strip_of, true);
}

std::vector<DesignFaces::Foot> DesignFaces::find(std::span<const Vector3d> points,
                                                 const std::function<int(std::size_t)>& strip_of,
                                                 bool sides) const {
  std::vector<Foot> found(points.size());
  const auto ask = [&](const Face& face, std::span<const Vector3d> asked, const auto& number) {
    const std::vector<gpu::Nearest> nearest = face.to_face.query(asked);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, nearest.size(), kFeetAtOnce),
                      [&](const auto& range) {
                        gpu::stop_point();
                        for (std::size_t i = range.begin(); i != range.end(); ++i)
                          found[number(i)] = foot(face, nearest[i]);
                      });
    gpu::stop_point();
    if (!sides) return;
    const std::vector<gpu::Side> side = face.to_face.sides(asked, nearest);
    for (std::size_t i = 0; i < side.size(); ++i) found[number(i)].side = side[i];
  };
  if (faces_.size() == 1) {
    ask(faces_.front(), points, [](std::size_t i) { return i; });
    return found;
  }
  std::vector<std::vector<std::size_t>> own(faces_.size());
  for (std::size_t i = 0; i < points.size(); ++i) own[face_of(strip_of(i))].push_back(i);
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    std::vector<Vector3d> asked;
    for (const std::size_t i : own[f]) asked.push_back(points[i]);
    if (!asked.empty()) ask(faces_[f], asked, [&](std::size_t i) { return own[f][i]; });
  }
  return found;
}

}  // namespace hotblade::pipeline

#include "pipeline/verify/design_faces.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <map>
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
constexpr int kRibSamples = 33;

std::vector<Vector3d> points_of(const Rib& rib) {
  std::vector<Vector3d> points;
  for (const elastica::CurvePoint& q : elastica::sample(rib.elastica, kRibSamples))
    points.push_back(rib.frame.point(q.x, q.y));
  return points;
}

// The ruled surfaces between strips' ribs.
struct RibSheets {
  std::vector<Vector3d> points;
  std::vector<std::array<int, 3>> triangles;
  std::vector<int> strip_of;  // by triangle

  void add(const std::vector<Rib>& ribs, int strip) {
    const auto first = static_cast<int>(points.size());
    for (const Rib& rib : ribs) {
      const std::vector<Vector3d> own = points_of(rib);
      points.insert(points.end(), own.begin(), own.end());
    }
    for (int r = 0; r + 1 < static_cast<int>(ribs.size()); ++r) {
      for (int k = 0; k + 1 < kRibSamples; ++k) {
        const int a = first + r * kRibSamples + k, b = a + kRibSamples;
        triangles.push_back({a, b, b + 1});
        triangles.push_back({a, b + 1, a + 1});
        strip_of.insert(strip_of.end(), 2, strip);
      }
    }
  }
};

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
  smooth_ = faces_.size();
  if (smooth_ > 1) assign(design, face_of_triangle, program);
  for (std::size_t face = 0; face < smooth_; ++face) part(face, program, backend);
}

void DesignFaces::assign(const surface::TriangleMesh& design, const std::vector<int>& face_of_triangle,
                         const Program& program) {
  const gpu::MeshDistance to_design(design.vertices(), design.triangles());
  for (std::size_t s = 0; s < program.strips.size(); ++s) {
    std::vector<Vector3d> points;
    for (const Rib& rib : program.strips[s].ribs) {
      // Ends may lie past a crease: the middle does not.
      constexpr std::ptrdiff_t kEnds = 4;
      const std::vector<Vector3d> all = points_of(rib);
      points.insert(points.end(), all.begin() + kEnds, all.end() - kEnds);
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

void DesignFaces::part(std::size_t face, const Program& program, gpu::Backend backend) {
  std::vector<std::size_t> strips;
  for (std::size_t s = 0; s < program.strips.size(); ++s)
    if (face_of_strip_[s] == face) strips.push_back(s);
  if (strips.size() < 2) return;
  const surface::TriangleMesh mesh = faces_[face].mesh;
  const std::vector<int> piece_of = surface::connected_parts(mesh);
  const auto pieces = static_cast<std::size_t>(1 + *std::max_element(piece_of.begin(), piece_of.end()));
  if (pieces < 2) return;
  RibSheets sheets;
  for (const std::size_t s : strips) sheets.add(program.strips[s].ribs, static_cast<int>(s));
  if (sheets.triangles.empty()) return;
  // Middles of the facets, of a dense piece as many as tell.
  constexpr std::size_t kMost = 4096;
  std::vector<std::size_t> facets(pieces, 0), seen(pieces, 0);
  for (const int piece : piece_of) ++facets[static_cast<std::size_t>(piece)];
  std::vector<Vector3d> middles;
  std::vector<std::size_t> of;
  for (std::size_t t = 0; t < piece_of.size(); ++t) {
    const auto piece = static_cast<std::size_t>(piece_of[t]);
    if (seen[piece]++ % (1 + facets[piece] / kMost) != 0) continue;
    const Facet at = facet({mesh.vertices(), mesh.triangles()}, static_cast<int>(t));
    middles.push_back((at.a + at.b + at.c) / 3);
    of.push_back(piece);
  }
  std::map<std::size_t, std::vector<bool>> formed;
  for (const std::size_t s : strips) formed[s].assign(pieces, false);
  const std::vector<gpu::Nearest> nearest = gpu::MeshDistance(sheets.points, sheets.triangles).query(middles);
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    const int strip = sheets.strip_of[static_cast<std::size_t>(nearest[i].triangle)];
    formed[static_cast<std::size_t>(strip)][of[i]] = true;
  }
  // A strip that is nowhere the nearest, and one that forms all, is compared with the whole face.
  std::map<std::vector<bool>, std::size_t> faces{{std::vector<bool>(pieces, true), face},
                                                 {std::vector<bool>(pieces, false), face}};
  for (const auto& [strip, own] : formed) {
    const auto [known, is_new] = faces.emplace(own, faces_.size());
    if (is_new) {
      std::vector<int> triangles;
      for (std::size_t t = 0; t < piece_of.size(); ++t)
        if (own[static_cast<std::size_t>(piece_of[t])]) triangles.push_back(static_cast<int>(t));
      faces_.emplace_back(surface::mesh_of(mesh, triangles), backend);
    }
    face_of_strip_[strip] = known->second;
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

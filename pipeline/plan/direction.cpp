#include "pipeline/plan/direction.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "pipeline/plan/strips.hpp"
#include "surface/slice.hpp"

namespace hotblade::pipeline {

namespace {

constexpr int kCoarsePlanes = 11;
// One percent of the design left out weighs as much as one more strip.
constexpr double kUncoveredWeight = 100;

double extent(const surface::TriangleMesh& mesh, const Eigen::Vector3d& n) {
  double low = 1e300, high = -1e300;
  for (const Eigen::Vector3d& p : mesh.vertices) {
    low = std::min(low, n.dot(p));
    high = std::max(high, n.dot(p));
  }
  return high - low;
}

// Principal axes of the surface's area, widest first.
std::vector<Eigen::Vector3d> body_axes(const surface::TriangleMesh& mesh) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  double total = 0;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d a = mesh.vertices[static_cast<std::size_t>(t[0])],
                          b = mesh.vertices[static_cast<std::size_t>(t[1])],
                          c = mesh.vertices[static_cast<std::size_t>(t[2])];
    const double area = 0.5 * (b - a).cross(c - a).norm();
    const Eigen::Vector3d centre = (a + b + c) / 3;
    mean += area * centre;
    second += area * centre * centre.transpose();
    total += area;
  }
  mean /= total;
  const Eigen::Matrix3d covariance = second / total - mean * mean.transpose();
  const Eigen::Matrix3d v = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors();
  return {v.col(2), v.col(1), v.col(0)};
}

// One of n and -n: the first component above half the largest is positive.
Eigen::Vector3d oriented(const Eigen::Vector3d& n) {
  for (int i = 0; i < 3; ++i) {
    if (std::abs(n[i]) > 0.5 * n.cwiseAbs().maxCoeff()) return n[i] < 0 ? Eigen::Vector3d(-n) : n;
  }
  return n;
}

std::vector<Eigen::Vector3d> candidates(const surface::DesignSurface& design) {
  std::vector<Eigen::Vector3d> all;
  std::vector<Eigen::Vector3d> raw{Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(),
                                   Eigen::Vector3d::UnitZ()};
  for (const Eigen::Vector3d& axis : body_axes(design.mesh)) raw.push_back(oriented(axis));
  constexpr double kSame = 0.996;  // within 5 degrees
  for (const Eigen::Vector3d& n : raw) {
    const bool known = std::any_of(all.begin(), all.end(),
                                   [&](const Eigen::Vector3d& m) { return std::abs(m.dot(n)) > kSame; });
    if (!known) all.push_back(n);
  }
  return all;
}

DirectionScore score(const surface::DesignSurface& design, const Eigen::Vector3d& n,
                     const Settings& settings) {
  DirectionScore result{n, 0, 0, 0};
  surface::SliceOptions options;
  options.normal = n;
  const double wide = extent(design.mesh, n);
  if (wide > 2 * options.end_inset_mm) {
    options.spacing_mm = wide / (kCoarsePlanes - 1);
    const StripLayout layout = lay_out_strips(make_targets(slice(design, options), settings), settings);
    double covered = 0;
    for (const StripPlan& strip : layout.strips) {
      for (std::size_t i = 1; i < strip.ribs.size(); ++i) {
        covered += 0.5 * (strip.ribs[i].elastica.length + strip.ribs[i - 1].elastica.length) *
                   (strip.ribs[i].offset_mm - strip.ribs[i - 1].offset_mm);
      }
    }
    result.strips = layout.strips.size();
    result.covered_share = std::min(1.0, covered / design.health.area_mm2);
  }
  result.score = static_cast<double>(result.strips) + kUncoveredWeight * (1 - result.covered_share);
  return result;
}

}  // namespace

std::vector<DirectionScore> rank_directions(const surface::DesignSurface& design, const Settings& settings) {
  if (settings.slice.direction) {
    const auto& d = *settings.slice.direction;
    return {score(design, Eigen::Vector3d(d[0], d[1], d[2]).normalized(), settings)};
  }
  std::vector<DirectionScore> ranking;
  for (const Eigen::Vector3d& n : candidates(design)) ranking.push_back(score(design, n, settings));
  std::stable_sort(ranking.begin(), ranking.end(),
                   [](const DirectionScore& a, const DirectionScore& b) { return a.score < b.score; });
  return ranking;
}

}  // namespace hotblade::pipeline

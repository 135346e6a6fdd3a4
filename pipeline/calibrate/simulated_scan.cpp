#include "pipeline/calibrate/simulated_scan.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "pipeline/verify/mesh_view.hpp"

namespace hotblade::pipeline {

namespace {

// The standard's distributions differ from library to library; its engine does not.
class Chance {
 public:
  explicit Chance(std::uint64_t seed) : engine_(seed) {}
  // In [0, 1).
  double even() { return static_cast<double>(engine_() >> 11U) * 0x1p-53; }
  double between(double low, double high) { return low + (high - low) * even(); }
  // Normal, by Box and Muller.
  double normal() {
    const double u = 1 - even(), v = even();
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
  }
  Eigen::Vector3d normals() {
    const double x = normal(), y = normal(), z = normal();
    return {x, y, z};
  }

 private:
  std::mt19937_64 engine_;
};

Eigen::Isometry3d any_motion(Chance& chance) {
  constexpr double kFarthestMm = 500;
  const double w = chance.normal();
  const Eigen::Vector3d v = chance.normals();
  Eigen::Isometry3d move = Eigen::Isometry3d::Identity();
  move.linear() = Eigen::Quaterniond(w, v.x(), v.y(), v.z()).normalized().toRotationMatrix();
  for (int k = 0; k < 3; ++k) move.translation()[k] = chance.between(-kFarthestMm, kFarthestMm);
  return move;
}

}  // namespace

RehearsedScan rehearsed_scan(const Program& program, std::size_t strip, const ErrorVector& errors,
                             const ScanRehearsal& how) {
  constexpr double kSampleMm = 2, kOutlierMm = 10;
  const Program thinned = thinned_to(program, strip, kSampleMm);
  const SweptSurface cut = cut_with(thinned, errors, kSampleMm);
  Chance chance(how.seed);
  RehearsedScan scan;
  scan.scan_to_design = how.moved ? any_motion(chance) : Eigen::Isometry3d::Identity();
  // The part seen is what lies in the first share of the rows and of the columns: of a corner.
  const double side = std::sqrt(std::clamp(how.seen, 0.0, 1.0));
  const std::size_t rows = thinned.strips[0].poses.size(), columns = cut.vertices.size() / rows;
  const auto last_row = static_cast<int>(std::ceil(side * static_cast<double>(rows - 1)));
  const auto last_column = static_cast<int>(std::ceil(side * static_cast<double>(columns - 1)));
  const auto in_sight = [&](int vertex) {
    return vertex / static_cast<int>(columns) <= last_row &&
           vertex % static_cast<int>(columns) <= last_column;
  };
  const MeshView mesh{cut.vertices, cut.triangles};
  std::vector<int> seen;
  std::vector<double> area_before;
  double area = 0;
  for (std::size_t t = 0; t < cut.triangles.size(); ++t) {
    if (!std::all_of(cut.triangles[t].begin(), cut.triangles[t].end(), in_sight)) continue;
    seen.push_back(static_cast<int>(t));
    area_before.push_back(area);
    area += facet(mesh, static_cast<int>(t)).area();
  }
  const Eigen::Isometry3d to_scan = scan.scan_to_design.inverse();
  for (std::size_t i = 0; i < how.points && !seen.empty(); ++i) {
    const auto after = std::upper_bound(area_before.begin(), area_before.end(), area * chance.even());
    const Facet f = facet(mesh, seen[static_cast<std::size_t>(after - area_before.begin() - 1)]);
    double u = chance.even(), v = chance.even();
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    Eigen::Vector3d p = f.a + u * (f.b - f.a) + v * (f.c - f.a) + how.noise_mm * chance.normals();
    if (chance.even() < how.outliers)
      p += Eigen::Vector3d(chance.between(-kOutlierMm, kOutlierMm), chance.between(-kOutlierMm, kOutlierMm),
                           chance.between(-kOutlierMm, kOutlierMm));
    scan.points.push_back(to_scan * p);
  }
  return scan;
}

}  // namespace hotblade::pipeline

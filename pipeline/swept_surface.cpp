#include "pipeline/swept_surface.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>

#include "elastica/blade_batch.hpp"

namespace hotblade::pipeline {

namespace {

// Even points of the part in foam of some poses.
elastica::PartPoints points_in_foam(std::span<const BladePose* const> poses, std::size_t points) {
  std::vector<elastica::Elastica> blades;
  std::vector<elastica::Part> parts;
  for (const BladePose* pose : poses) {
    blades.push_back(pose->blade);
    parts.push_back({(*pose->foam)[0], (*pose->foam)[1]});
  }
  return elastica::sample_parts(blades, parts, points);
}

// Of both ends and the middle the farthest.
double moved_mm(const std::array<Eigen::Vector3d, 3>& from, const std::array<Eigen::Vector3d, 3>& to) {
  double moved = 0;
  for (std::size_t i = 0; i < 3; ++i) moved = std::max(moved, (to[i] - from[i]).norm());
  return moved;
}

// Poses with foam, one whenever an end or the middle has moved by `sample_mm`; first and last included. The
// last one takes the place of one less than half of that before it: the surface's slope is measured between
// rows, and over a hundredth of a millimetre the registers' micrometre would decide it.
std::vector<const BladePose*> grid_rows(const Strip& strip, double sample_mm) {
  std::vector<const BladePose*> in_foam, rows;
  for (const BladePose& pose : strip.poses) {
    if (pose.foam) in_foam.push_back(&pose);
  }
  if (in_foam.empty()) return rows;
  const elastica::PartPoints points = points_in_foam(in_foam, 3);
  std::array<Eigen::Vector3d, 3> last, marks;
  last.fill(Eigen::Vector3d::Zero());
  for (std::size_t n = 0; n < in_foam.size(); ++n) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector2d q = points.at(n, i);
      marks[i] = in_foam[n]->frame.point(q.x(), q.y());
    }
    if (n > 0 && moved_mm(last, marks) < sample_mm) continue;
    rows.push_back(in_foam[n]);
    last = marks;
  }
  if (rows.back() == in_foam.back()) return rows;
  if (rows.size() > 1 && moved_mm(last, marks) < 0.5 * sample_mm) rows.pop_back();
  rows.push_back(in_foam.back());
  return rows;
}

struct Grid {
  std::size_t rows = 0, columns = 0;
  std::vector<Eigen::Vector3d> centre, left;  // blade points, and the direction left of the blade there
  std::vector<double> curvature;              // 1/mm, without sign
};

Grid blade_grid(const std::vector<const BladePose*>& rows, double sample_mm) {
  Grid grid;
  grid.rows = rows.size();
  double longest = 0;
  for (const BladePose* pose : rows) longest = std::max(longest, (*pose->foam)[1] - (*pose->foam)[0]);
  grid.columns = static_cast<std::size_t>(std::max(2.0, std::ceil(longest / sample_mm))) + 1;
  const std::size_t points = grid.rows * grid.columns;
  grid.centre.reserve(points);
  grid.left.reserve(points);
  grid.curvature.reserve(points);
  constexpr std::size_t kBlock = 64;
  for (std::size_t from = 0; from < rows.size(); from += kBlock) {
    const auto some = std::span(rows).subspan(from, std::min(kBlock, rows.size() - from));
    const elastica::PartPoints on = points_in_foam(some, grid.columns);
    for (std::size_t i = 0; i < some.size(); ++i) {
      const Frame& frame = some[i]->frame;
      for (std::size_t n = i * grid.columns; n < (i + 1) * grid.columns; ++n) {
        grid.centre.push_back(frame.point(on.x[n], on.y[n]));
        grid.curvature.push_back(std::abs(on.curvature[n]));
        grid.left.push_back(-on.sin[n] * frame.x + on.cos[n] * frame.y);
      }
    }
  }
  return grid;
}

// Unit normal of the grid at (i, j), towards the waste, by central differences.
Eigen::Vector3d grid_normal(const Grid& g, std::size_t i, std::size_t j) {
  const auto at = [&](std::size_t a, std::size_t b) { return g.centre[a * g.columns + b]; };
  const Eigen::Vector3d along = at(i, std::min(j + 1, g.columns - 1)) - at(i, j > 0 ? j - 1 : 0);
  const Eigen::Vector3d sweep = at(std::min(i + 1, g.rows - 1), j) - at(i > 0 ? i - 1 : 0, j);
  const Eigen::Vector3d& left = g.left[i * g.columns + j];
  const Eigen::Vector3d n = along.cross(sweep);
  if (!(n.norm() > 0)) return left;
  return n.dot(left) < 0 ? Eigen::Vector3d(-n.normalized()) : Eigen::Vector3d(n.normalized());
}

void add_strip(const Program& program, std::size_t index, double sample_mm, SweptSurface& out) {
  const auto rows = grid_rows(program.strips[index], sample_mm);
  if (rows.size() < 2) return;
  const Grid grid = blade_grid(rows, sample_mm);
  for (std::size_t i = 0; i < grid.rows; ++i) {
    for (std::size_t j = 0; j < grid.columns; ++j) {
      const Eigen::Vector3d n = grid_normal(grid, i, j);
      const Eigen::Vector3d plane = rows[i]->frame.normal();
      out.vertices.push_back(grid.centre[i * grid.columns + j] - half_band_mm(program.blade, n, plane) * n);
      out.plane_normals.push_back(plane);
      out.normals.push_back(n);
      out.strip_of_vertex.push_back(static_cast<int>(index));
      out.pose_of_vertex.push_back(static_cast<int>(rows[i] - program.strips[index].poses.data()));
      out.curvature_per_mm.push_back(grid.curvature[i * grid.columns + j]);
    }
  }
  const auto columns = static_cast<int>(grid.columns);
  for (int i = 0; i + 1 < static_cast<int>(grid.rows); ++i) {
    for (int j = 0; j + 1 < columns; ++j) {
      const int a = i * columns + j, b = a + 1, c = a + columns, d = c + 1;
      const auto facing = [&](int p, int q, int r) {
        const auto& v = out.vertices;
        const auto at = [&](int k) { return v[static_cast<std::size_t>(k)]; };
        const bool front =
            (at(q) - at(p)).cross(at(r) - at(p)).dot(out.normals[static_cast<std::size_t>(p)]) >= 0;
        return front ? std::array<int, 3>{p, q, r} : std::array<int, 3>{p, r, q};
      };
      out.triangles.push_back(facing(a, b, d));
      out.triangles.push_back(facing(a, d, c));
    }
  }
}

void append(const SweptSurface& part, SweptSurface& out) {
  const auto base = static_cast<int>(out.vertices.size());
  const auto add = [&](auto member) {
    (out.*member).insert((out.*member).end(), (part.*member).begin(), (part.*member).end());
  };
  add(&SweptSurface::vertices);
  add(&SweptSurface::plane_normals);
  add(&SweptSurface::normals);
  add(&SweptSurface::strip_of_vertex);
  add(&SweptSurface::pose_of_vertex);
  add(&SweptSurface::curvature_per_mm);
  for (const auto& t : part.triangles) out.triangles.push_back({base + t[0], base + t[1], base + t[2]});
}

}  // namespace

double half_band_mm(const BladeData& blade, const Eigen::Vector3d& normal,
                    const Eigen::Vector3d& plane_normal) {
  return 0.5 * (blade.kerf_mm + blade.width_mm * std::abs(normal.dot(plane_normal)));
}

SweptSurface swept_surface(const Program& program, double sample_mm) {
  if (!(sample_mm > 0)) throw std::logic_error("sample_mm must be positive");
  // Some strips at a time: the surfaces of hundreds, made before they are joined, would be held twice.
  constexpr std::size_t kAtOnce = 16;
  SweptSurface out;
  for (std::size_t first = 0; first < program.strips.size(); first += kAtOnce) {
    std::vector<SweptSurface> parts(std::min(kAtOnce, program.strips.size() - first));
    tbb::parallel_for(std::size_t{0}, parts.size(),
                      [&](std::size_t i) { add_strip(program, first + i, sample_mm, parts[i]); });
    for (const SweptSurface& part : parts) append(part, out);
  }
  return out;
}

}  // namespace hotblade::pipeline

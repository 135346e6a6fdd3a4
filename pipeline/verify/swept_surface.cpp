#include "pipeline/verify/swept_surface.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>
#include <utility>

#include "elastica/blade/blade_batch.hpp"
#include "gpu/backend/stop.hpp"
#include "pipeline/verify/blade_speeds.hpp"
#include "pipeline/verify/hanging.hpp"

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

// A strip's rows and where its part of its run's surface begins.
struct StripGrid {
  std::vector<const BladePose*> rows;
  std::size_t columns = 0;
  std::size_t first_vertex = 0, first_triangle = 0;

  [[nodiscard]] std::size_t vertices() const { return rows.size() * columns; }
  [[nodiscard]] std::size_t triangles() const {
    return rows.size() < 2 ? 0 : 2 * (rows.size() - 1) * (columns - 1);
  }
};

StripGrid strip_grid(const Strip& strip, double sample_mm) {
  StripGrid grid;
  grid.rows = grid_rows(strip, sample_mm);
  if (grid.rows.size() < 2) grid.rows.clear();
  double longest = 0;
  for (const BladePose* pose : grid.rows) longest = std::max(longest, (*pose->foam)[1] - (*pose->foam)[0]);
  grid.columns = static_cast<std::size_t>(std::max(2.0, std::ceil(longest / sample_mm))) + 1;
  return grid;
}

// Calls work(first, last) for blocks of rows on all cores allowed: as many as fill the lanes of many blades.
template <typename Work>
void for_rows(const StripGrid& grid, const Work& work) {
  constexpr std::size_t kBlock = 64;
  tbb::parallel_for(std::size_t{0}, (grid.rows.size() + kBlock - 1) / kBlock, [&](std::size_t block) {
    gpu::stop_point();
    work(block * kBlock, std::min(grid.rows.size(), (block + 1) * kBlock));
  });
  gpu::stop_point();
}

// How the blades of some rows hang. Solved at every few rows: between them the shape hardly changes, and the
// sag with it.
class HangingRows {
 public:
  HangingRows(std::span<const BladePose* const> rows, const Strip& strip, const robot::Blade& blade) {
    for (std::size_t i = 0;; i = std::min(i + kStep, rows.size() - 1)) {
      profiles_.push_back(hanging(rows[i]->blade, rows[i]->frame, strip.design_to_cell, blade));
      at_.push_back(i);
      if (i + 1 == rows.size()) break;
    }
  }

  [[nodiscard]] robot::SagProfile::Value at(std::size_t row, double share) const {
    const std::size_t k = std::min(row / kStep, at_.size() - 1);
    const robot::SagProfile::Value p = profiles_[k].at(share);
    if (at_[k] == row) return p;
    const robot::SagProfile::Value q = profiles_[k + 1].at(share);
    const double t = static_cast<double>(row - at_[k]) / static_cast<double>(at_[k + 1] - at_[k]);
    return {(1 - t) * p.droop_mm + t * q.droop_mm, (1 - t) * p.twist_rad + t * q.twist_rad,
            (1 - t) * p.in_plane_mm + t * q.in_plane_mm};
  }

 private:
  static constexpr std::size_t kStep = 8;
  std::vector<robot::SagProfile> profiles_;
  std::vector<std::size_t> at_;
};

// Points of the hanging blade, curvatures, and in place of the normals the directions left of the blade.
void place_rows(const Program& program, const Strip& strip, const StripGrid& grid, std::size_t from,
                std::size_t to, SweptSurface& out) {
  const auto some = std::span(grid.rows).subspan(from, to - from);
  const elastica::PartPoints on = points_in_foam(some, grid.columns);
  const HangingRows hung(some, strip, program.blade);
  std::size_t v = grid.first_vertex + from * grid.columns;
  for (std::size_t i = 0; i < some.size(); ++i) {
    const Frame& frame = some[i]->frame;
    const auto& [first, last] = *some[i]->foam;
    for (std::size_t j = 0; j < grid.columns; ++j, ++v) {
      const std::size_t n = i * grid.columns + j;
      const double s =
          first + (last - first) * static_cast<double>(j) / static_cast<double>(grid.columns - 1);
      const Hang hang =
          hang_of(hung.at(i, s / some[i]->blade.length), frame, Eigen::Vector2d(on.cos[n], on.sin[n]));
      out.vertices[v] = frame.point(on.x[n], on.y[n]) + hang.shift_mm;
      out.curvature_per_mm[v] = std::abs(on.curvature[n]);
      out.normals[v] = -on.sin[n] * frame.x + on.cos[n] * frame.y;
      out.plane_normals[v] = hang.plane_normal;
    }
  }
}

// Unit normal of the blade points at row i and column j, by central differences, towards where `left` points.
Eigen::Vector3d grid_normal(const StripGrid& g, const std::vector<Eigen::Vector3d>& points, std::size_t i,
                            std::size_t j, const Eigen::Vector3d& left) {
  const auto at = [&](std::size_t a, std::size_t b) -> const Eigen::Vector3d& {
    return points[g.first_vertex + a * g.columns + b];
  };
  const Eigen::Vector3d along = at(i, std::min(j + 1, g.columns - 1)) - at(i, j > 0 ? j - 1 : 0);
  const Eigen::Vector3d sweep = at(std::min(i + 1, g.rows.size() - 1), j) - at(i > 0 ? i - 1 : 0, j);
  const Eigen::Vector3d n = along.cross(sweep);
  const double size = n.norm();
  if (!(size > 0)) return left;
  return (n.dot(left) < 0 ? -n : n) / size;
}

// Speed of the blade at row i and column j square to itself, by central differences.
double grid_speed(const StripGrid& g, const std::vector<Eigen::Vector3d>& points, std::size_t i,
                  std::size_t j) {
  const auto at = [&](std::size_t a, std::size_t b) -> const Eigen::Vector3d& {
    return points[g.first_vertex + a * g.columns + b];
  };
  const std::size_t before = i > 0 ? i - 1 : 0, after = std::min(i + 1, g.rows.size() - 1);
  return speed_across(at(before, j), at(after, j), g.rows[after]->t - g.rows[before]->t,
                      at(i, std::min(j + 1, g.columns - 1)) - at(i, j > 0 ? j - 1 : 0));
}

// Two triangles between four vertices, facing as the normals do.
void place_triangles(const StripGrid& grid, std::size_t from, std::size_t to, SweptSurface& out) {
  const auto& v = out.vertices;
  const auto facing = [&](int p, int q, int r) {
    const auto at = [&](int k) -> const Eigen::Vector3d& { return v[static_cast<std::size_t>(k)]; };
    const bool front =
        (at(q) - at(p)).cross(at(r) - at(p)).dot(out.normals[static_cast<std::size_t>(p)]) >= 0;
    return front ? std::array<int, 3>{p, q, r} : std::array<int, 3>{p, r, q};
  };
  const auto columns = static_cast<int>(grid.columns);
  std::size_t t = grid.first_triangle + 2 * from * (grid.columns - 1);
  for (std::size_t i = from; i < std::min(to, grid.rows.size() - 1); ++i) {
    const auto row = static_cast<int>(grid.first_vertex + i * grid.columns);
    for (int a = row; a + 1 < row + columns; ++a) {
      const int b = a + 1, c = a + columns, d = c + 1;
      out.triangles[t++] = facing(a, b, d);
      out.triangles[t++] = facing(a, d, c);
    }
  }
}

unsigned char sides_at(const StripGrid& grid, std::size_t row, std::size_t column) {
  const int bits = (row == 0 ? 1 : 0) | (row + 1 == grid.rows.size() ? 2 : 0) | (column == 0 ? 4 : 0) |
                   (column + 1 == grid.columns ? 8 : 0);
  return static_cast<unsigned char>(bits);
}

void add_strip(const Program& program, std::size_t index, const StripGrid& grid, SweptSurface& out) {
  const Strip& strip = program.strips[index];
  for_rows(grid, [&](std::size_t from, std::size_t to) { place_rows(program, strip, grid, from, to, out); });
  // Normals first, from the blade's points; then these move to the melted band's edge.
  for_rows(grid, [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      for (std::size_t j = 0; j < grid.columns; ++j) {
        const std::size_t v = grid.first_vertex + i * grid.columns + j;
        out.normals[v] = grid_normal(grid, out.vertices, i, j, out.normals[v]);
        out.speeds_mm_s[v] = grid_speed(grid, out.vertices, i, j);
        out.strip_of_vertex[v] = static_cast<int>(index);
        out.pose_of_vertex[v] = static_cast<int>(grid.rows[i] - program.strips[index].poses.data());
        out.sides_of_vertex[v] = sides_at(grid, i, j);
      }
    }
  });
  for_rows(grid, [&](std::size_t from, std::size_t to) {
    const std::size_t last = grid.first_vertex + to * grid.columns;
    for (std::size_t v = grid.first_vertex + from * grid.columns; v < last; ++v) {
      out.vertices[v] -=
          half_band_mm(program.blade, out.normals[v], out.plane_normals[v], out.speeds_mm_s[v]) *
          out.normals[v];
    }
  });
  for_rows(grid, [&](std::size_t from, std::size_t to) { place_triangles(grid, from, to, out); });
}

// How much of a surface some strips are.
struct Counts {
  std::size_t vertices = 0, triangles = 0;

  // Gives the strip its place behind what was counted.
  void add(StripGrid& grid) {
    grid.first_vertex = std::exchange(vertices, vertices + grid.vertices());
    grid.first_triangle = std::exchange(triangles, triangles + grid.triangles());
  }
};

SweptSurface surface_of(const Counts& counts) {
  SweptSurface out;
  out.vertices.resize(counts.vertices);
  out.plane_normals.resize(counts.vertices);
  out.speeds_mm_s.resize(counts.vertices);
  out.normals.resize(counts.vertices);
  out.strip_of_vertex.resize(counts.vertices);
  out.pose_of_vertex.resize(counts.vertices);
  out.curvature_per_mm.resize(counts.vertices);
  out.sides_of_vertex.resize(counts.vertices);
  out.triangles.resize(counts.triangles);
  return out;
}

}  // namespace

double half_band_mm(const robot::Blade& blade, const Eigen::Vector3d& normal,
                    const Eigen::Vector3d& plane_normal, double speed_mm_s) {
  return 0.5 * (blade.band_mm(speed_mm_s) + blade.width_mm * std::abs(normal.dot(plane_normal)));
}

SweptSurface swept_surface(const Program& program, double sample_mm) {
  SweptSurface all;
  each_swept_surface(program, sample_mm, std::numeric_limits<std::size_t>::max(),
                     [&](SweptSurface surface) { all = std::move(surface); });
  return all;
}

void each_swept_surface(const Program& program, double sample_mm, std::size_t vertices,
                        const std::function<void(SweptSurface)>& use) {
  if (!(sample_mm > 0)) throw std::logic_error("sample_mm must be positive");
  std::vector<StripGrid> grids(program.strips.size());
  tbb::parallel_for(std::size_t{0}, grids.size(), [&](std::size_t i) {
    gpu::stop_point();
    grids[i] = strip_grid(program.strips[i], sample_mm);
  });
  gpu::stop_point();
  for (std::size_t first = 0, last = 0; first < grids.size(); first = last) {
    Counts counts;
    while (last < grids.size() && counts.vertices < vertices) counts.add(grids[last++]);
    SweptSurface run = surface_of(counts);
    tbb::parallel_for(first, last, [&](std::size_t i) { add_strip(program, i, grids[i], run); });
    gpu::stop_point();
    use(std::move(run));
  }
}

}  // namespace hotblade::pipeline

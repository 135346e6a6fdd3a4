#include "pipeline/verify/swept_surface.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>

#include "elastica/blade/blade_batch.hpp"
#include "gpu/backend/stop.hpp"
#include "pipeline/verify/blade_speeds.hpp"
#include "pipeline/verify/hanging.hpp"
#include "pipeline/verify/row_way.hpp"
#include "pipeline/verify/width_pass.hpp"
#include "robot/blade/band_edge.hpp"

namespace hotblade::pipeline {

namespace {

// The blades of some poses and their parts in foam.
struct InFoam {
  std::vector<elastica::Elastica> blades;
  std::vector<elastica::Part> parts;

  explicit InFoam(std::span<const BladePose* const> poses) {
    for (const BladePose* pose : poses) {
      blades.push_back(pose->blade);
      parts.push_back({(*pose->foam)[0], (*pose->foam)[1]});
    }
  }
};

// Even points of the part in foam of some poses.
elastica::PartPoints points_in_foam(std::span<const BladePose* const> poses, std::size_t points) {
  const InFoam all(poses);
  return elastica::sample_parts(all.blades, all.parts, points);
}

// Points of a pose that tell how its blade moves: both ends of what is in foam, and three between.
constexpr std::size_t kMarks = 5;
using Marks = std::array<Eigen::Vector3d, kMarks>;

std::vector<Marks> marks_of(std::span<const BladePose* const> poses) {
  const InFoam all(poses);
  const elastica::PartPlaces points = elastica::sample_places(all.blades, all.parts, kMarks);
  std::vector<Marks> marks(poses.size());
  for (std::size_t n = 0; n < poses.size(); ++n) {
    for (std::size_t i = 0; i < kMarks; ++i) {
      const Eigen::Vector2d q = points.at(n, i);
      marks[n][i] = poses[n]->frame.point(q.x(), q.y());
    }
  }
  return marks;
}

// Of all marks the farthest.
double moved_mm(const Marks& from, const Marks& to) {
  double moved = 0;
  for (std::size_t i = 0; i < kMarks; ++i) moved = std::max(moved, (to[i] - from[i]).norm());
  return moved;
}

// Whether the part in foam slides along the blade from one pose to another, by so much that the blade moves
// across itself by less than half a finest step: then the surface's slope cannot be measured between both.
bool slides(const BladePose& p, const Marks& from, const BladePose& q, const Marks& to, double finest_mm) {
  const double first = (*q.foam)[0] - (*p.foam)[0], last = (*q.foam)[1] - (*p.foam)[1];
  const double least = 0.5 * finest_mm;
  if (!(std::max(std::abs(first), std::abs(last)) > least)) return false;
  double across_sq = 0;
  for (std::size_t i = 0; i < kMarks; ++i) {
    const double share = static_cast<double>(i) / (kMarks - 1), along = (1 - share) * first + share * last;
    across_sq = std::max(across_sq, (to[i] - from[i]).squaredNorm() - along * along);
  }
  return across_sq < least * least;
}

// Distance of a point from the straight line between two others.
double off_chord_mm(const Eigen::Vector3d& p, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d along = to - from;
  const double size_sq = along.squaredNorm();
  const double share = size_sq > 0 ? std::clamp(along.dot(p - from) / size_sq, 0.0, 1.0) : 0.0;
  return (p - from - share * along).norm();
}

// Chooses the poses that become rows.
class RowSteps {
 public:
  RowSteps(const std::vector<Marks>& marks, const GridSteps& steps) : marks_(marks), steps_(steps) {}

  // Returns the row after `from`: as far as a step goes that leaves no pose between off its chord, or the
  // first pose that is a finest step away; the number of poses where none is.
  [[nodiscard]] std::size_t after(std::size_t from) const {
    for (double step = steps_.widest_mm;; step = std::max(steps_.finest_mm, 0.5 * step)) {
      std::size_t to = from + 1;
      while (to < marks_.size() && moved_mm(marks_[from], marks_[to]) < step) ++to;
      if (step <= steps_.finest_mm) return to;
      const std::size_t end = std::min(to, marks_.size() - 1);
      if (end > from && moved_mm(marks_[from], marks_[end]) >= steps_.finest_mm && straight(from, end))
        return end;
    }
  }

 private:
  [[nodiscard]] bool straight(std::size_t from, std::size_t to) const {
    for (std::size_t n = from + 1; n < to; ++n) {
      for (std::size_t i = 0; i < kMarks; ++i) {
        if (off_chord_mm(marks_[n][i], marks_[from][i], marks_[to][i]) > steps_.chord_mm) return false;
      }
    }
    return true;
  }

  const std::vector<Marks>& marks_;
  const GridSteps& steps_;
};

// The poses of a stretch, and the numbers of those that become rows; first and last included. The last one
// takes the place of one less than half a finest step before it: the surface's slope is measured between
// rows, and over a hundredth of a millimetre the registers' micrometre would decide it.
struct GridRows {
  std::vector<const BladePose*> in_foam;
  std::vector<std::size_t> numbers;
  std::vector<char> slides;  // of each row
};

GridRows grid_rows(std::span<const BladePose> stretch, const GridSteps& steps) {
  GridRows rows;
  for (const BladePose& pose : stretch) rows.in_foam.push_back(&pose);
  const std::vector<Marks> marks = marks_of(rows.in_foam);
  const RowSteps row_steps(marks, steps);
  std::vector<std::size_t>& numbers = rows.numbers;
  for (std::size_t n = 0; n < rows.in_foam.size(); n = row_steps.after(n)) numbers.push_back(n);
  const std::size_t last = rows.in_foam.size() - 1;
  if (numbers.back() != last) {
    if (numbers.size() > 1 && moved_mm(marks[numbers.back()], marks[last]) < 0.5 * steps.finest_mm)
      numbers.pop_back();
    numbers.push_back(last);
  }
  rows.slides.assign(numbers.size(), 0);
  for (std::size_t i = 1; i < numbers.size(); ++i) {
    const std::size_t from = numbers[i - 1], to = numbers[i];
    if (slides(*rows.in_foam[from], marks[from], *rows.in_foam[to], marks[to], steps.finest_mm))
      rows.slides[i - 1] = rows.slides[i] = 1;
  }
  return rows;
}

// The most that the blades of some rows curve in foam. An elastica's curvature hardly changes between so many
// points.
double most_curvature_per_mm(std::span<const BladePose* const> rows) {
  constexpr std::size_t kPoints = 17;
  double most = 0;
  for (const double curvature : points_in_foam(rows, kPoints).curvature)
    most = std::max(most, std::abs(curvature));
  return most;
}

// Distance along a blade over which its chord is as high as steps allow, between the finest and the widest.
double column_step_mm(std::span<const BladePose* const> rows, const GridSteps& steps) {
  if (!(steps.widest_mm > steps.finest_mm)) return steps.finest_mm;
  const double by_chord = std::sqrt(8 * steps.chord_mm / most_curvature_per_mm(rows));
  return by_chord < steps.widest_mm ? std::max(by_chord, steps.finest_mm) : steps.widest_mm;
}

// The stretches of a strip's poses that follow each other hot and form the design: only between those has a
// blade melted the foam. What it passes cold stays, as a gap between two stretches.
std::vector<std::span<const BladePose>> forming_stretches(const Strip& strip) {
  std::vector<std::span<const BladePose>> stretches;
  const std::span<const BladePose> all(strip.poses);
  const auto forms = [](const BladePose& pose) { return pose.heat && pose.foam; };
  for (auto first = std::ranges::find_if(all, forms); first != all.end();) {
    const auto end = std::find_if_not(first, all.end(), forms);
    stretches.emplace_back(first, end);
    first = std::find_if(end, all.end(), forms);
  }
  return stretches;
}

// The rows of a stretch and where its part of the surface begins.
struct StripGrid {
  std::size_t strip = 0;  // index into program.strips
  std::vector<const BladePose*> rows;
  GridRows found;
  std::size_t columns = 0;
  std::size_t sag_every = 1;  // rows from one whose sag is solved to the next
  std::size_t first_vertex = 0, first_triangle = 0;
  static constexpr std::size_t kLeastColumns = 3;

  [[nodiscard]] std::size_t vertices() const { return rows.size() * columns; }
  // No steps are so wide that it has fewer.
  [[nodiscard]] bool least() const { return rows.size() <= 2 && columns <= kLeastColumns; }
  [[nodiscard]] std::size_t triangles() const {
    return rows.size() < 2 ? 0 : 2 * (rows.size() - 1) * (columns - 1);
  }
};

StripGrid strip_grid(std::size_t strip, std::span<const BladePose> stretch, const GridSteps& steps) {
  StripGrid grid;
  grid.strip = strip;
  grid.found = grid_rows(stretch, steps);
  if (grid.found.numbers.size() > 1) {
    for (const std::size_t n : grid.found.numbers) grid.rows.push_back(grid.found.in_foam[n]);
  }
  double longest = 0;
  for (const BladePose* pose : grid.rows) longest = std::max(longest, (*pose->foam)[1] - (*pose->foam)[0]);
  const double step = grid.rows.empty() ? steps.finest_mm : column_step_mm(grid.rows, steps);
  grid.columns = std::max(StripGrid::kLeastColumns, static_cast<std::size_t>(std::ceil(longest / step)) + 1);
  // A blade hangs nearly alike over eight finest steps, 20 mm: between two of them its sag is taken as
  // linear.
  constexpr double kFinestSteps = 8;
  grid.sag_every =
      static_cast<std::size_t>(std::max(1.0, std::floor(kFinestSteps * steps.finest_mm / steps.widest_mm)));
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
  HangingRows(std::span<const BladePose* const> rows, std::size_t every, const Strip& strip,
              const robot::Blade& blade)
      : every_(every) {
    std::vector<elastica::Elastica> blades;
    std::vector<Frame> frames;
    for (std::size_t i = 0;; i = std::min(i + every_, rows.size() - 1)) {
      blades.push_back(rows[i]->blade);
      frames.push_back(rows[i]->frame);
      at_.push_back(i);
      if (i + 1 == rows.size()) break;
    }
    profiles_ = hanging(blades, frames, strip.design_to_cell, blade);
  }

  [[nodiscard]] robot::SagProfile::Value at(std::size_t row, double share) const {
    const std::size_t k = std::min(row / every_, at_.size() - 1);
    const robot::SagProfile::Value p = profiles_[k].at(share);
    if (at_[k] == row) return p;
    const robot::SagProfile::Value q = profiles_[k + 1].at(share);
    const double t = static_cast<double>(row - at_[k]) / static_cast<double>(at_[k + 1] - at_[k]);
    return {(1 - t) * p.droop_mm + t * q.droop_mm, (1 - t) * p.twist_rad + t * q.twist_rad,
            (1 - t) * p.in_plane_mm + t * q.in_plane_mm};
  }

 private:
  std::size_t every_;
  std::vector<robot::SagProfile> profiles_;
  std::vector<std::size_t> at_;
};

// Points of the hanging blade, curvatures, and in place of the normals the directions left of the blade.
void place_rows(const Program& program, const Strip& strip, const StripGrid& grid, std::size_t from,
                std::size_t to, SweptSurface& out) {
  const auto some = std::span(grid.rows).subspan(from, to - from);
  const elastica::PartPoints on = points_in_foam(some, grid.columns);
  const HangingRows hung(some, grid.sag_every, strip, program.blade);
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

// The points of a strip's grid, or what else stands at its vertices.
class GridOf {
 public:
  GridOf(const StripGrid& grid, const std::vector<Eigen::Vector3d>& values) : grid_(grid), values_(values) {}

  [[nodiscard]] const Eigen::Vector3d& at(std::size_t row, std::size_t column) const {
    return values_[grid_.first_vertex + row * grid_.columns + column];
  }
  // From the vertex before to the vertex behind, along the blade and along the sweep.
  [[nodiscard]] Eigen::Vector3d along(std::size_t row, std::size_t column) const {
    return at(row, std::min(column + 1, grid_.columns - 1)) - at(row, column > 0 ? column - 1 : 0);
  }
  [[nodiscard]] Eigen::Vector3d sweep(std::size_t row, std::size_t column) const {
    return at(std::min(row + 1, grid_.rows.size() - 1), column) - at(row > 0 ? row - 1 : 0, column);
  }

 private:
  const StripGrid& grid_;
  const std::vector<Eigen::Vector3d>& values_;
};

// The direction of the grid's line through a vertex along one of its two ways, by `count` vertices of it.
template <typename At>
Eigen::Vector3d line_direction(std::size_t i, std::size_t count, const At& at) {
  if (count < 3) return at(count - 1) - at(0);
  if (i == 0) return direction_at(at(0), at(1), at(2), false);
  if (i + 1 == count) return -direction_at(at(i), at(i - 1), at(i - 2), false);
  return direction_at(at(i), at(i - 1), at(i + 1), true);
}

// Unit normal of the blade points at a row and column, towards where `left` points.
Eigen::Vector3d grid_normal(const StripGrid& g, const GridOf& points, std::size_t row, std::size_t column,
                            const RowWay* way, const Eigen::Vector3d& left) {
  const Eigen::Vector3d along = line_direction(column, g.columns,
                                               [&](std::size_t j) { return points.at(row, j); }),
                        sweep = way ? way->sweep[column]
                                    : line_direction(row, g.rows.size(),
                                                     [&](std::size_t i) { return points.at(i, column); });
  const Eigen::Vector3d n = along.cross(sweep);
  const double size = n.norm();
  if (!(size > 0)) return left;
  return (n.dot(left) < 0 ? -n : n) / size;
}

// Speed of the blade at a row and column square to itself, by central differences.
double grid_speed(const StripGrid& g, const GridOf& points, std::size_t row, std::size_t column) {
  const std::size_t before = row > 0 ? row - 1 : 0, after = std::min(row + 1, g.rows.size() - 1);
  return speed_across(points.at(before, column), points.at(after, column),
                      g.rows[after]->t - g.rows[before]->t, points.along(row, column));
}

// How a surface bends at a vertex, per mm: of its curves along the blade and along the sweep, and how it
// twists between them.
struct Bends {
  double along = 0, sweep = 0, twist = 0;
};

// By the turn of the grid's normals along both of its ways, and the blade's own curvature.
Bends bends_at(const StripGrid& g, std::size_t row, std::size_t column, const SweptSurface& out) {
  const GridOf points(g, out.vertices), normals(g, out.normals);
  const Eigen::Vector3d along = points.along(row, column), sweep = points.sweep(row, column);
  const double along_mm = along.norm(), sweep_mm = sweep.norm();
  Bends bends;
  bends.along = out.curvature_per_mm[g.first_vertex + row * g.columns + column];
  if (!(along_mm > 0 && sweep_mm > 0)) return bends;
  const Eigen::Vector3d by_along = normals.along(row, column) / along_mm,
                        by_sweep = normals.sweep(row, column) / sweep_mm;
  bends.along = std::max(bends.along, std::abs(by_along.dot(along)) / along_mm);
  bends.sweep = std::abs(by_sweep.dot(sweep)) / sweep_mm;
  bends.twist = std::max(std::abs(by_along.dot(sweep)) / sweep_mm, std::abs(by_sweep.dot(along)) / along_mm);
  return bends;
}

// How the surface of the blade's points bends where the width passes over it (robot::over_width_mm), by the
// grid's normals; 0 where its lines run along each other. At a step t across, the blade of the step before
// has its width turned: what that rises by counts twice, since the curvature has half of t squared.
double bend_across_per_mm(const StripGrid& g, std::size_t row, std::size_t column, const RowWay* way,
                          const SweptSurface& out) {
  constexpr double kSameWay_sq = 1e-6;
  const GridOf points(g, out.vertices), normals(g, out.normals), widths(g, out.plane_normals);
  const std::size_t v = g.first_vertex + row * g.columns + column;
  const Eigen::Vector3d &n = out.normals[v], &width = out.plane_normals[v];
  const Eigen::Vector3d across = width - n.dot(width) * n;
  const Eigen::Vector3d along = points.along(row, column),
                        sweep = way ? way->step[column] : points.sweep(row, column);
  const double aa = along.squaredNorm(), as = along.dot(sweep), ss = sweep.squaredNorm();
  const double size = aa * ss - as * as;
  if (!(size > kSameWay_sq * aa * ss)) return 0;
  const double xa = across.dot(along), xs = across.dot(sweep);
  const double by_along = (ss * xa - as * xs) / size, by_sweep = (aa * xs - as * xa) / size;
  const Eigen::Vector3d normals_sweep = way ? way->turn[column] : normals.sweep(row, column),
                        widths_sweep = way ? way->width_turn : widths.sweep(row, column);
  return -across.dot(by_along * normals.along(row, column) + by_sweep * normals_sweep) -
         2 * n.dot(by_along * widths.along(row, column) + by_sweep * widths_sweep);
}

// What a vertex stands for: its share of the area, and how much the surface bends there at most.
void place_measures(const StripGrid& g, std::size_t row, std::size_t column, SweptSurface& out) {
  const GridOf points(g, out.vertices);
  const std::size_t v = g.first_vertex + row * g.columns + column;
  const Eigen::Vector3d along = points.along(row, column), sweep = points.sweep(row, column);
  // Both reach over two steps, at the grid's edges over the one step of which half is the vertex's.
  out.areas_mm2[v] = 0.25 * along.cross(sweep).norm();
  const Bends bends = bends_at(g, row, column, out);
  // The larger principal curvature is no more than this.
  out.bends_per_mm[v] = std::max(bends.along, bends.sweep) + bends.twist;
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

// How far apart the poses are whose width passes over a row. Executed ones all count that differ by anything
// to speak of; between planned ones, which are smooth, a crest of the cut may be higher by half a micrometre.
double poses_apart_mm(const StripGrid& grid, std::size_t row, double width_mm, bool by_every_pose,
                      const SweptSurface& out) {
  constexpr double kLeast = 1.0 / 32, kMost = 1.0 / 8;  // of the width
  constexpr double kChord_mm = 5e-4;
  if (by_every_pose) return kLeast * width_mm;
  double bend_per_mm = 0;
  for (std::size_t j = 0; j < grid.columns; ++j)
    bend_per_mm =
        std::max(bend_per_mm, std::abs(out.width_bends_per_mm[grid.first_vertex + row * grid.columns + j]));
  const double apart_mm = std::sqrt(8 * kChord_mm / bend_per_mm);
  return std::clamp(apart_mm, kLeast * width_mm, kMost * width_mm);
}

// How far the edge of the melted band is from the blade's middle line along a row.
void place_half_bands(const Program& program, const Strip& strip, const StripGrid& grid, std::size_t row,
                      const WidthPasses& all, bool by_every_pose, SweptSurface& out) {
  const std::size_t first = grid.first_vertex + row * grid.columns;
  const std::optional<std::vector<double>> passes =
      all.deepest_mm(static_cast<std::size_t>(grid.rows[row] - strip.poses.data()),
                     std::span(out.normals).subspan(first, grid.columns),
                     std::span(out.plane_normals).subspan(first, grid.columns),
                     poses_apart_mm(grid, row, program.blade.width_mm, by_every_pose, out));
  for (std::size_t j = 0; j < grid.columns; ++j) {
    const std::size_t v = first + j;
    out.half_bands_mm[v] = passes ? 0.5 * program.blade.band_mm(out.speeds_mm_s[v]) + (*passes)[j]
                                  : half_band_mm(program.blade, out.normals[v], out.plane_normals[v],
                                                 out.speeds_mm_s[v], out.width_bends_per_mm[v]);
  }
}

unsigned char sides_at(const StripGrid& grid, std::size_t row, std::size_t column) {
  const int bits = (row == 0 ? 1 : 0) | (row + 1 == grid.rows.size() ? 2 : 0) | (column == 0 ? 4 : 0) |
                   (column + 1 == grid.columns ? 8 : 0);
  return static_cast<unsigned char>(bits);
}

void add_stretch(const Program& program, const StripGrid& grid, const WidthPasses& passes,
                 const GridSteps& steps, SweptSurface& out) {
  if (grid.rows.empty()) return;
  const Strip& strip = program.strips[grid.strip];
  for_rows(grid, [&](std::size_t from, std::size_t to) { place_rows(program, strip, grid, from, to, out); });
  std::vector<std::optional<RowWay>> ways(grid.rows.size());
  for_rows(grid, [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      if (grid.found.slides[i])
        ways[i] = row_way(grid.found.in_foam, grid.found.numbers[i], grid.columns, steps.finest_mm);
    }
  });
  const auto way_of = [&](std::size_t row) { return ways[row] ? &*ways[row] : nullptr; };
  // Normals first, from the blade's points; then these move to the melted band's edge.
  const GridOf points(grid, out.vertices);
  for_rows(grid, [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      for (std::size_t j = 0; j < grid.columns; ++j) {
        const std::size_t v = grid.first_vertex + i * grid.columns + j;
        out.normals[v] = grid_normal(grid, points, i, j, way_of(i), out.normals[v]);
        out.speeds_mm_s[v] = grid_speed(grid, points, i, j);
        out.strip_of_vertex[v] = static_cast<int>(grid.strip);
        out.pose_of_vertex[v] = static_cast<int>(grid.rows[i] - strip.poses.data());
        out.sides_of_vertex[v] = sides_at(grid, i, j);
      }
    }
  });
  for_rows(grid, [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      for (std::size_t j = 0; j < grid.columns; ++j)
        out.width_bends_per_mm[grid.first_vertex + i * grid.columns + j] =
            -bend_across_per_mm(grid, i, j, way_of(i), out);
    }
  });
  for_rows(grid, [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i)
      place_half_bands(program, strip, grid, i, passes, steps.by_every_pose, out);
  });
  for_rows(grid, [&](std::size_t from, std::size_t to) {
    for (std::size_t v = grid.first_vertex + from * grid.columns; v < grid.first_vertex + to * grid.columns;
         ++v)
      out.vertices[v] -= out.half_bands_mm[v] * out.normals[v];
  });
  for_rows(grid, [&](std::size_t from, std::size_t to) {
    place_triangles(grid, from, to, out);
    for (std::size_t i = from; i < to; ++i) {
      for (std::size_t j = 0; j < grid.columns; ++j) place_measures(grid, i, j, out);
    }
  });
}

// How much of a surface stretches are.
struct Counts {
  std::size_t vertices = 0, triangles = 0;

  // Gives the stretch its place behind what was counted.
  void add(StripGrid& grid) {
    grid.first_vertex = std::exchange(vertices, vertices + grid.vertices());
    grid.first_triangle = std::exchange(triangles, triangles + grid.triangles());
  }
};

// Returns steps with which so many vertices become few enough, or nearly: the sum of many grids is rounded
// up. A chord is higher by the square of its length.
GridSteps coarser(const GridSteps& steps, std::size_t vertices) {
  constexpr double kLeast = 1.1;  // less would hardly take a row or column away
  const double times =
      std::max(kLeast, std::sqrt(static_cast<double>(vertices) / static_cast<double>(steps.most_vertices)));
  return {times * steps.finest_mm, times * steps.widest_mm, times * times * steps.chord_mm,
          steps.most_vertices, steps.by_every_pose};
}

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
  out.areas_mm2.resize(counts.vertices);
  out.bends_per_mm.resize(counts.vertices);
  out.width_bends_per_mm.resize(counts.vertices);
  out.half_bands_mm.resize(counts.vertices);
  out.triangles.resize(counts.triangles);
  return out;
}

}  // namespace

double half_band_mm(const robot::Blade& blade, const Eigen::Vector3d& normal,
                    const Eigen::Vector3d& plane_normal, double speed_mm_s, double bend_per_mm) {
  return 0.5 * blade.band_mm(speed_mm_s) +
         robot::over_width_mm(normal.dot(plane_normal), bend_per_mm, blade.width_mm);
}

SweptSurface swept_surface(const Program& program, const GridSteps& given) {
  if (!(given.finest_mm > 0) || !(given.widest_mm >= given.finest_mm) || !(given.chord_mm >= 0))
    throw std::logic_error("swept_surface: steps must be positive, the widest no less than the finest");
  GridSteps steps = given;
  std::vector<std::pair<std::size_t, std::span<const BladePose>>> stretches;
  for (std::size_t i = 0; i < program.strips.size(); ++i) {
    for (const auto& stretch : forming_stretches(program.strips[i])) stretches.emplace_back(i, stretch);
  }
  std::vector<StripGrid> grids(stretches.size());
  Counts counts;
  for (bool fits = false; !fits;) {
    tbb::parallel_for(std::size_t{0}, grids.size(), [&](std::size_t i) {
      gpu::stop_point();
      grids[i] = strip_grid(stretches[i].first, stretches[i].second, steps);
    });
    gpu::stop_point();
    counts = {};
    for (StripGrid& grid : grids) counts.add(grid);
    fits = counts.vertices <= steps.most_vertices || std::ranges::all_of(grids, &StripGrid::least);
    if (!fits) steps = coarser(steps, counts.vertices);
  }
  SweptSurface surface = surface_of(counts);
  tbb::parallel_for(std::size_t{0}, program.strips.size(), [&](std::size_t i) {
    const auto own = std::ranges::equal_range(grids, i, {}, &StripGrid::strip);
    if (own.empty()) return;
    const WidthPasses passes(program.strips[i].poses, program.blade.width_mm);
    tbb::parallel_for(std::size_t{0}, own.size(),
                      [&](std::size_t k) { add_stretch(program, own[k], passes, steps, surface); });
    gpu::stop_point();
  });
  gpu::stop_point();
  return surface;
}

SweptSurface swept_surface(const Program& program, double sample_mm) {
  return swept_surface(program, {sample_mm, sample_mm, 0, std::numeric_limits<std::size_t>::max(), false});
}

}  // namespace hotblade::pipeline

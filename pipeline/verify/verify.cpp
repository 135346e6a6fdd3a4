#include "pipeline/verify/verify.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_reduce.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <utility>

#include "gpu/backend/stop.hpp"
#include "gpu/mesh/mesh_distance.hpp"
#include "pipeline/sayings/saying.hpp"
#include "pipeline/verify/cut_search.hpp"
#include "pipeline/verify/design_border.hpp"
#include "pipeline/verify/design_cells.hpp"
#include "pipeline/verify/design_faces.hpp"
#include "pipeline/verify/mesh_view.hpp"
#include "pipeline/verify/near_cells.hpp"
#include "pipeline/verify/swept_surface.hpp"
#include "pipeline/verify/width_heights.hpp"
#include "robot/blade/blade_section.hpp"

namespace hotblade::pipeline {

namespace {

std::vector<BranchReport> follow_branches(const Program& program, double min_margin) {
  const double sharpest = robot::max_curvature_per_mm(program.blade);
  std::vector<BranchReport> branches(program.strips.size());
  tbb::parallel_for(std::size_t{0}, branches.size(), [&](std::size_t i) {
    branches[i] = follow_branch(program.strips[i], {sharpest, min_margin, program.settings.machine.clamps});
  });
  gpu::stop_point();
  return branches;
}

// Samples that are measured at once: their answers take six times the memory of what stays of them.
constexpr std::size_t kAtOnce = 1 << 18;

// Calls work(i) for 0 .. count on all cores allowed.
template <typename Work>
void for_each_of(std::size_t count, const Work& work) {
  constexpr std::size_t kGrain = 1024;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kGrain), [&](const auto& range) {
    gpu::stop_point();
    for (std::size_t i = range.begin(); i != range.end(); ++i) work(i);
  });
  gpu::stop_point();
}

// Of the tolerance: what may stay between the largest deviation of the samples and what is proven of all
// places, and how high the chords of the cut's facets may be.
constexpr double kSettledShare = 0.01;

GridSteps grid_steps(const VerifyOptions& options, const robot::Blade& blade) {
  GridSteps steps;
  steps.finest_mm = options.sample_mm;
  // Where the band depends on the speed, it may change within one wide step.
  steps.widest_mm = (blade.melt.by_speed() ? 1 : options.widest) * options.sample_mm;
  steps.chord_mm = kSettledShare * options.tolerance_mm;
  steps.by_every_pose = options.by_every_pose;
  return steps;
}

// Edges of the design's cells where nothing asks for shorter ones, and where something does.
struct CellEdges {
  double widest_mm = 0, finest_mm = 0;
};

CellEdges cell_edges(const VerifyOptions& options, double area_mm2) {
  // So many cells, about, are made of a design where nothing asks for more: time and memory.
  constexpr double kCells = 5e5;
  // Of the square of its longest edge a right triangle takes a quarter, halved ones less.
  constexpr double kCell = 0.2;
  const double widest_mm = options.widest * options.sample_mm;
  const double wider = std::max(1.0, std::sqrt(area_mm2 / (kCell * kCells)) / widest_mm);
  return {wider * widest_mm, wider * options.sample_mm};
}

// One comparison of a cut with the design: its steps and what they share.
class CutMeasurement {
 public:
  CutMeasurement(const SweptSurface& cut, const Program& program, const surface::DesignSurface& design,
                 const VerifyOptions& options)
      : cut_(cut),
        program_(program),
        mesh_{design.mesh.vertices(), design.mesh.triangles()},
        options_(options),
        steps_(grid_steps(options, program.blade)),
        edges_(cell_edges(options, design.health.area_mm2)),
        to_design_(design.mesh, program, options_.backend) {
    report_.area_mm2 = design.health.area_mm2;
    report_.strip_max_mm.assign(program.strips.size(), 0.0);
    report_.strip_bound_mm.assign(program.strips.size(), 0.0);
    report_.strip_max_at.assign(program.strips.size(), Eigen::Vector3d::Zero());
    report_.rows = RowBounds(cut, program);
  }

  VerifyReport take(const BladeTouches& touches) {
    cut_to_design();
    // A point of the cut lies within two steps of one of its vertices. Small cells would be many, and save
    // little.
    constexpr double kLeastCellMm = 100;
    const CutSearch search(cut_, std::max(kLeastCellMm, far() + 2 * steps_.widest_mm), options_.backend);
    if (options_.cut_only) {
      corners_to_cut(search);
    } else {
      design_to_cut(search);
      report_.to_cut = search.search().used();
      count_touches(search, touches);
    }
    conclude();
    return report_;
  }

 private:
  [[nodiscard]] double near() const { return options_.reach * options_.tolerance_mm; }
  [[nodiscard]] double far() const { return options_.far * options_.tolerance_mm; }

  void conclude() {
    report_.deviation = statistics_.result();
    report_.histogram = statistics_.histogram(options_.tolerance_mm);
    constexpr std::array kPercents{50.0, 90.0, 95.0, 99.0, 99.9, 100.0};
    const std::vector<double> within = statistics_.percentiles(kPercents);
    for (std::size_t i = 0; i < kPercents.size(); ++i) {
      report_.percentiles_mm.emplace_back(kPercents[i], within[i]);
      if (kPercents[i] == 99.0) report_.deviation.p99 = within[i];
    }
    report_.bound_mm = std::max(report_.bound_mm, report_.deviation.max);
    constexpr double kCloseToTheCap = 0.95;
    const bool left_out = report_.beyond_samples > 0 || report_.uncut_mm2 > 0;
    report_.capped =
        left_out && report_.deviation.max <= near() && report_.deviation.max > kCloseToTheCap * near();
    report_.within_tolerance =
        report_.bound_mm <= options_.tolerance_mm && report_.uncut_share() <= options_.max_uncut_share;
  }

  // `vertex` is the nearest of the cut, none of what is no part of it.
  void add(double distance, const Eigen::Vector3d& at, double area_mm2, int strip, int vertex = -1) {
    if (report_.worst_strip < 0 || distance > worst_) {
      worst_ = distance;
      report_.worst_strip = strip;
    }
    statistics_.add(distance, at, area_mm2);
    const auto of = static_cast<std::size_t>(strip);
    if (distance > report_.strip_max_mm[of]) {
      report_.strip_max_mm[of] = distance;
      report_.strip_max_at[of] = at;
    }
    const auto nearest = static_cast<std::size_t>(vertex);
    add_bound(distance, strip, vertex < 0 ? std::span<const std::size_t>{} : std::span(&nearest, 1));
  }

  // Of all places that a sample stands for, nearest to some vertices of the cut.
  void add_bound(double bound, int strip, std::span<const std::size_t> nearest) {
    double& largest = report_.strip_bound_mm[static_cast<std::size_t>(strip)];
    largest = std::max(largest, bound);
    report_.bound_mm = std::max(report_.bound_mm, bound);
    if (!nearest.empty()) report_.rows.add(nearest, bound);
  }

  // A sample of the cut against the design.
  struct Compared {
    double distance = 0, half_band = 0;
    bool beyond = false;  // past the design's edge
  };

  void cut_to_design() {
    const std::span<const Eigen::Vector3d> all(cut_.vertices);
    std::vector<Compared> compared;
    for (std::size_t first = 0; first < all.size(); first += kAtOnce) {
      const std::vector<DesignFaces::Foot> on_design =
          to_design_.feet(all.subspan(first, std::min(kAtOnce, all.size() - first)),
                          [&](std::size_t i) { return cut_.strip_of_vertex[first + i]; });
      compared.resize(on_design.size());
      for_each_of(compared.size(),
                  [&](std::size_t i) { compared[i] = compare_with_design(first + i, on_design[i]); });
      for (std::size_t i = 0; i < compared.size(); ++i) {
        gpu::stop_point();
        count(first + i, compared[i]);
      }
    }
    report_.to_design = to_design_.used();
    report_.cut_samples = cut_.vertices.size();
  }

  [[nodiscard]] Compared compare_with_design(std::size_t i, const DesignFaces::Foot& on_design) const {
    Compared c{on_design.distance};
    const Eigen::Vector3d& n = on_design.normal;
    if (on_design.on_border) {
      const Eigen::Vector3d d = cut_.vertices[i] - on_design.point;
      c.distance = std::abs(n.dot(d));
      c.beyond = (d - n.dot(d) * n).norm() > options_.edge_mm;
    }
    const auto half_band = [&](const Eigen::Vector3d& normal) {
      return half_band_mm(program_.blade, normal, cut_.plane_normals[i], cut_.speeds_mm_s[i],
                          cut_.width_bends_per_mm[i]);
    };
    c.half_band = std::abs(half_band(cut_.normals[i]) - half_band(n));
    return c;
  }

  void count(std::size_t i, const Compared& c) {
    if (c.beyond) {
      ++report_.beyond_samples;
      report_.beyond_mm2 += cut_.areas_mm2[i];
      return;
    }
    report_.half_band_mm = std::max(report_.half_band_mm, c.half_band);
    add(c.distance, cut_.vertices[i], cut_.areas_mm2[i], cut_.strip_of_vertex[i], static_cast<int>(i));
  }

  // What of the cut is nearest to a design sample.
  struct NearestCut {
    double distance = std::numeric_limits<double>::infinity();
    int vertex = -1;    // of the facet it lies on; -1: of none
    bool uncut = true;  // too far, or past the cut's edge
    bool on_edge = true;
  };
  // -1: of none.
  [[nodiscard]] int strip_of(const NearestCut& at) const {
    return at.vertex < 0 ? -1 : cut_.strip_of_vertex[static_cast<std::size_t>(at.vertex)];
  }

  // Corners of large facets stand out of what bends smoothly between the cut's samples. Those at the cut's
  // edge may be other strips'.
  void corners_to_cut(const CutSearch& search) {
    const std::vector<Eigen::Vector3d> corners = corners_of_large_facets();
    std::vector<NearestCut> nearest;
    find_nearest(search, corners, nearest);
    for (std::size_t i = 0; i < nearest.size(); ++i) {
      if (!nearest[i].uncut && !nearest[i].on_edge)
        add(nearest[i].distance, corners[i], 0, strip_of(nearest[i]), nearest[i].vertex);
    }
  }

  // Those of facets with an edge longer than samples lie apart.
  [[nodiscard]] std::vector<Eigen::Vector3d> corners_of_large_facets() const {
    std::vector<char> large(mesh_.vertices.size(), 0);
    for (const auto& t : mesh_.triangles) {
      gpu::stop_point();
      for (std::size_t i = 0; i < 3; ++i) {
        const auto a = static_cast<std::size_t>(t[i]), b = static_cast<std::size_t>(t[(i + 1) % 3]);
        if ((mesh_.vertices[a] - mesh_.vertices[b]).norm() > steps_.finest_mm) large[a] = large[b] = 1;
      }
    }
    std::vector<Eigen::Vector3d> corners;
    for (std::size_t v = 0; v < large.size(); ++v) {
      if (large[v]) corners.push_back(mesh_.vertices[v]);
    }
    return corners;
  }

  // Cells of the design are divided until what is known at their corners settles what lies between them. The
  // distance from a triangle's points to the triangle of their corners' nearest points is largest at a
  // corner; the cut lies as far from that triangle as its bend makes it.
  void design_to_cut(const CutSearch& search) {
    DesignCells cells(mesh_);
    std::vector<NearestCut> nearest;
    std::vector<double> stands_for_mm2;
    while (!cells.cells().empty()) {
      find_nearest(search, cells.points(), nearest);
      stands_for_mm2.reserve(nearest.size());
      stands_for_mm2.resize(nearest.size(), 0);
      const std::span<const DesignCells::Cell> asked(cells.cells());
      const double most = farthest_corner(cells, nearest);
      // Set by all cores: new memory is as much work as what is written to it.
      const auto known = std::make_unique_for_overwrite<Known[]>(asked.size());
      const auto cuts = std::make_unique_for_overwrite<DesignCells::Cut[]>(asked.size());
      for_each_of(asked.size(), [&](std::size_t i) {
        const CellBound bound = bound_of(cells, asked[i], nearest);
        known[i] = {bound.sum(), cells.area_mm2(asked[i])};
        const double wanted_mm = wanted_edge_mm(cells, asked[i], nearest, bound, most);
        cuts[i] = wanted_mm > 0 ? cells.cut_to(asked[i], wanted_mm) : DesignCells::Cut{};
      });
      std::vector<DesignCells::Cell> before;  // what `asked` shows from then on
      tbb::parallel_invoke(
          [&] {
            for (std::size_t i = 0; i < asked.size(); ++i) {
              gpu::stop_point();
              if (cuts[i].pieces == 0) settle(asked[i], nearest, known[i], stands_for_mm2);
            }
          },
          [&] {
            before = cells.divide({cuts.get(), asked.size()});
          });
      gpu::stop_point();
    }
    report_.design_samples = nearest.size();
    for (std::size_t i = 0; i < nearest.size(); ++i) {
      gpu::stop_point();
      if (stands_for_mm2[i] > 0)
        add(nearest[i].distance, cells.points()[i], stands_for_mm2[i], strip_of(nearest[i]),
            nearest[i].vertex);
    }
  }

  // What is known of a cell's points by its corners: none is farther from the cut than the farthest corner
  // and what the cut bends between them. Where a corner is uncut nothing is known.
  struct CellBound {
    double corner = 0, bend = 0;
    bool uncut = false;
    [[nodiscard]] double sum() const {
      return uncut ? std::numeric_limits<double>::infinity() : corner + bend;
    }
  };

  // Of it what settles a cell: the sum, and the area.
  struct Known {
    double bound_mm, area_mm2;
  };

  // Returns the largest deviation there is, with those of the cells' corners.
  [[nodiscard]] double farthest_corner(const DesignCells& cells, std::span<const NearestCut> nearest) const {
    constexpr std::size_t kGrain = 4096;
    const double farthest = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, cells.cells().size(), kGrain), worst_,
        [&](const auto& range, double found) {
          gpu::stop_point();
          for (std::size_t i = range.begin(); i != range.end(); ++i) {
            for (const std::uint32_t corner : cells.cells()[i].corners) {
              const NearestCut& at = nearest[corner];
              if (!at.uncut) found = std::max(found, at.distance);
            }
          }
          return found;
        },
        [](double a, double b) { return std::max(a, b); });
    gpu::stop_point();
    return farthest;
  }

  [[nodiscard]] CellBound bound_of(const DesignCells& cells, const DesignCells::Cell& cell,
                                   std::span<const NearestCut> nearest) const {
    // A circle whose radius squared is a third of the longest edge's covers a triangle, and a surface that
    // bends by k rises k/2 times that radius squared over it.
    constexpr double kCover = 1.0 / 6;
    CellBound bound;
    double bend_per_mm = 0;
    for (const std::uint32_t corner : cell.corners) {
      const NearestCut& at = nearest[corner];
      if (at.uncut) return {.uncut = true};
      bound.corner = std::max(bound.corner, at.distance);
      bend_per_mm = std::max(bend_per_mm, cut_.bends_per_mm[static_cast<std::size_t>(at.vertex)]);
    }
    const double edge = cells.longest_edge_mm(cell);
    bound.bend = kCover * bend_per_mm * edge * edge;
    return bound;
  }

  // How long a cell's longest edge should be to settle what is open in it; 0 where nothing is.
  [[nodiscard]] double wanted_edge_mm(const DesignCells& cells, const DesignCells::Cell& cell,
                                      std::span<const NearestCut> nearest, const CellBound& bound,
                                      double most) const {
    const double edge = cells.longest_edge_mm(cell);
    if (edge > edges_.widest_mm) return edges_.widest_mm;
    const auto& [a, b, c] = cell.corners;
    if (nearest[a].uncut && nearest[b].uncut && nearest[c].uncut) return 0;
    const bool at_edge = nearest[a].on_edge || nearest[b].on_edge || nearest[c].on_edge;
    if (at_edge && edge > edges_.finest_mm) return edges_.finest_mm;
    const int strip = strip_of(nearest[a]);
    const bool between_strips = strip_of(nearest[b]) != strip || strip_of(nearest[c]) != strip;
    // Each strip goes on for some millimetres past where they meet.
    if (between_strips && edge > 2 * edges_.finest_mm) return 2 * edges_.finest_mm;
    if (bound.uncut) return 0;
    // Where that leaves it open whether the tolerance holds, the bend is brought down to a tenth of what else
    // settles.
    constexpr double kNothing = 0.1;
    const bool decides = most <= options_.tolerance_mm && bound.sum() > options_.tolerance_mm;
    const bool open = bound.sum() > most + settled_mm() || (decides && bound.bend > kNothing * settled_mm());
    return open ? 0.5 * edge : 0;
  }

  [[nodiscard]] double settled_mm() const { return kSettledShare * options_.tolerance_mm; }

  void settle(const DesignCells::Cell& cell, std::span<const NearestCut> nearest, const Known& known,
              std::vector<double>& stands_for_mm2) {
    const double share = known.area_mm2 / 3;
    double farthest = -1;
    int strip = -1;
    for (const std::uint32_t corner : cell.corners) {
      const NearestCut& at = nearest[corner];
      if (at.uncut) {
        report_.uncut_mm2 += share;
        continue;
      }
      stands_for_mm2[corner] += share;
      if (at.distance > farthest) {
        farthest = at.distance;
        strip = strip_of(at);
      }
    }
    if (!std::isfinite(known.bound_mm)) return;
    std::array<std::size_t, 3> of{};
    std::size_t count = 0;
    for (const std::uint32_t corner : cell.corners) {
      if (strip_of(nearest[corner]) == strip) of[count++] = static_cast<std::size_t>(nearest[corner].vertex);
    }
    add_bound(known.bound_mm, strip, std::span(of).first(count));
  }

  // Of the points that `nearest` does not hold yet.
  void find_nearest(const CutSearch& search, std::span<const Eigen::Vector3d> points,
                    std::vector<NearestCut>& nearest) const {
    std::size_t first = nearest.size();
    nearest.reserve(points.size());  // no more: there are few rounds
    nearest.resize(points.size());
    for (; first < points.size(); first += kAtOnce) {
      const std::size_t count = std::min(kAtOnce, points.size() - first);
      compare_with_cut(search, points.subspan(first, count), std::span(nearest).subspan(first, count));
    }
  }

  void compare_with_cut(const CutSearch& search, std::span<const Eigen::Vector3d> points,
                        std::span<NearestCut> nearest) const {
    std::vector<char> held(points.size());
    search.cells().hold(points, held);
    std::vector<std::size_t> index;
    std::vector<Eigen::Vector3d> some;
    const bool all = std::all_of(held.begin(), held.end(), [](char is) { return is != 0; });
    for (std::size_t i = 0; i < points.size() && !all; ++i) {
      if (!held[i]) continue;
      index.push_back(i);
      some.push_back(points[i]);
    }
    const std::span<const Eigen::Vector3d> asked = all ? points : some;
    const std::vector<gpu::Nearest> found = search.search().query(asked);
    for_each_of(found.size(), [&](std::size_t k) {
      NearestCut& at = nearest[all ? k : index[k]];
      at.distance = search.distance_mm(asked[k], found[k]);
      at.vertex = static_cast<int>(search.vertex_of(found[k].triangle));
      at.on_edge = search.on_edge(found[k]);
      if (at.on_edge) at.distance = found[k].distance;
      at.uncut = at.distance > far() || (at.distance > near() && at.on_edge);
    });
  }

  void count_touches(const CutSearch& search, const BladeTouches& touches) {
    if (touches.points.empty()) return;
    const std::vector<DesignFaces::Foot> touched =
        to_design_.feet(touches.points, [&](std::size_t i) { return touches.strip_of_point[i]; });
    std::vector<Eigen::Vector3d> feet;
    feet.reserve(touched.size());
    for (const DesignFaces::Foot& foot : touched) feet.push_back(foot.point);
    const std::vector<gpu::Nearest> formed = search.search().query(feet);
    std::vector<WidthPlace> places;
    std::vector<std::size_t> of;
    for (std::size_t k = 0; k < feet.size(); ++k) {
      // Only what the same strip forms: another strip's part lies in another block.
      const int strip = touches.strip_of_point[k];
      if (search.strip_of(formed[k].triangle) != strip || formed[k].distance > near()) continue;
      if (touched[k].on_border || search.on_edge(formed[k])) continue;
      places.push_back(
          {touches.points[k], touches.plane_normals[k], cut_.normals[search.vertex_of(formed[k].triangle)]});
      of.push_back(k);
    }
    const auto strip_of = [&](std::size_t i) { return touches.strip_of_point[of[i]]; };
    const std::vector<double> heights =
        width_heights(to_design_, places, program_.blade.width_mm, PastBorder::kNothing, strip_of);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const double depth = 0.5 * program_.blade.band_mm(touches.speeds_mm_s[of[i]]) - heights[i];
      if (!(depth > 0)) continue;
      report_.gouge_mm = std::max(report_.gouge_mm, depth);
      // A point: it stands for no area.
      add(depth, feet[of[i]], 0, strip_of(i));
    }
  }

  const SweptSurface& cut_;
  const Program& program_;
  MeshView mesh_;  // the design's
  const VerifyOptions& options_;
  GridSteps steps_;
  CellEdges edges_;
  DesignFaces to_design_;
  DeviationStatistics statistics_;
  VerifyReport report_;
  double worst_ = 0;
};

}  // namespace

bool VerifyReport::holds() const {
  return std::all_of(branches.begin(), branches.end(), [](const BranchReport& b) { return b.held(); });
}

namespace {

VerifyReport measure(const SweptSurface& cut, const BladeTouches& touches, const Program& program,
                     const surface::DesignSurface& design, const VerifyOptions& options) {
  if (!cut.triangles.empty()) return CutMeasurement(cut, program, design, options).take(touches);
  VerifyReport report;
  report.area_mm2 = report.uncut_mm2 = design.health.area_mm2;
  report.strip_max_mm.assign(program.strips.size(), 0.0);
  report.strip_bound_mm.assign(program.strips.size(), 0.0);
  report.strip_max_at.assign(program.strips.size(), Eigen::Vector3d::Zero());
  return report;
}

}  // namespace

VerifyReport measure(const SweptSurface& cut, const Program& program, const surface::DesignSurface& design,
                     const VerifyOptions& options) {
  return measure(cut, {}, program, design, options);
}

VerifyReport measure(const Program& cut, const BladeTouches& touches, const surface::DesignSurface& design,
                     const VerifyOptions& options) {
  return measure(swept_surface(cut, grid_steps(options, cut.blade)), touches, cut, design, options);
}

void add_told(VerifyReport& report, std::size_t index, const Strip& strip, const BranchReport& branch,
              double width_mm) {
  double& bound = report.strip_bound_mm[index];
  const double with = report.rows.with(branch.told_off, strip, index, width_mm);
  report.strip_told_mm.resize(report.strip_bound_mm.size(), 0.0);
  report.strip_told_mm[index] = std::max(0.0, with - bound);
  bound = std::max(bound, with);
  report.bound_mm = std::max(report.bound_mm, bound);
}

VerifyReport verify(const Program& program, const surface::DesignSurface& design,
                    const VerifyOptions& options) {
  std::vector<BranchReport> branches;
  double mismatch_mm = 0;
  RibCheck ribs;
  std::vector<MotionBreach> motion;
  VerifyReport report;
  // Side by side: a strip's branch is followed by one thread.
  tbb::parallel_invoke([&] { branches = follow_branches(program, options.min_margin); },
                       [&] { mismatch_mm = clamp_mismatch_mm(program); },
                       [&] { ribs = check_ribs(program, options.tolerance_mm, options.backend); },
                       [&] {
                         if (options.motion) motion = check_motion(program);
                       },
                       [&] { report = measure(program, {}, design, options); });
  gpu::stop_point();
  report.branches = std::move(branches);
  report.ribs = std::move(ribs);
  report.motion = std::move(motion);
  report.clamp_mismatch_mm = mismatch_mm;
  for (std::size_t i = 0; i < report.branches.size(); ++i) {
    add_told(report, i, program.strips[i], report.branches[i], program.blade.width_mm);
    report.branches[i].told_off = {};
  }
  report.rows = {};
  report.within_tolerance = report.within_tolerance && report.bound_mm <= options.tolerance_mm &&
                            report.clamp_mismatch_mm <= kClampMismatchMm;
  return report;
}

std::vector<std::string> not_checked(const robot::Blade& blade) {
  return {say(Saying::kSnapsBetween),
          say(Saying::kClampsInDeviation),
          say(blade.melt.by_speed() ? Saying::kMeltOfHeld : Saying::kMeltOfSlow),
          say(Saying::kHotSteel),
          say(Saying::kArmsNotLookedAt),
          say(Saying::kThermal),
          say(Saying::kPlinthAside),
          say(Saying::kJerkUnlimited)};
}

}  // namespace hotblade::pipeline

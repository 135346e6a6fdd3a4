#include "pipeline/verify/verify.hpp"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "gpu/backend/stop.hpp"
#include "gpu/mesh/mesh_distance.hpp"
#include "pipeline/program/clamps.hpp"
#include "pipeline/verify/design_border.hpp"
#include "pipeline/verify/design_faces.hpp"
#include "pipeline/verify/design_samples.hpp"
#include "pipeline/verify/largest_text.hpp"
#include "pipeline/verify/mesh_view.hpp"
#include "pipeline/verify/near_cells.hpp"
#include "pipeline/verify/swept_surface.hpp"
#include "robot/blade/blade_section.hpp"

namespace hotblade::pipeline {

namespace {

// Largest distance between a clamp and the blade's end it holds, mm, tangents a radian counted as 1000 mm.
double clamp_mismatch_mm(const Program& program) {
  constexpr double kMmPerRad = 1000;
  const robot::ClampOffsets& offsets = program.settings.machine.clamps;
  std::vector<double> worst(program.strips.size(), 0);
  tbb::parallel_for(std::size_t{0}, worst.size(), [&](std::size_t i) {
    const std::vector<BladePose>& poses = program.strips[i].poses;
    std::vector<elastica::Elastica> blades;
    std::vector<Frame> frames;
    for (const BladePose& pose : poses) {
      blades.push_back(pose.blade);
      frames.push_back(pose.frame);
    }
    const std::vector<ClampPoses> planned = clamps(blades, frames);
    for (std::size_t k = 0; k < poses.size(); ++k) {
      for (const auto clamp : {&ClampPoses::a, &ClampPoses::b}) {
        const bool is_a = clamp == &ClampPoses::a;
        const Pose is = robot::held(is_a ? poses[k].a : poses[k].b, is_a ? offsets.a : offsets.b),
                   &should = planned[k].*clamp;
        const double off = std::max((is.p - should.p).norm(), kMmPerRad * is.q.angularDistance(should.q));
        if (!(off <= worst[i])) worst[i] = off;
      }
    }
  });
  gpu::stop_point();
  return worst.empty() ? 0 : *std::max_element(worst.begin(), worst.end(), [](double p, double q) {
    return p < q || std::isnan(q);
  });
}

std::vector<BranchReport> follow_branches(const Program& program, double min_margin) {
  const double sharpest = robot::max_curvature_per_mm(program.blade);
  std::vector<BranchReport> branches(program.strips.size());
  tbb::parallel_for(std::size_t{0}, branches.size(), [&](std::size_t i) {
    branches[i] = follow_branch(program.strips[i], {sharpest, min_margin, program.settings.machine.clamps});
  });
  gpu::stop_point();
  return branches;
}

// Samples of both surfaces together, about: on larger designs they lie farther apart, so that time and memory
// stay bounded.
constexpr double kMostSamples = 8e6;
// Samples that are measured at once: their answers take six times the memory of what stays of them.
constexpr std::size_t kAtOnce = 1 << 19;

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

double bounded(double sample_mm, double area_mm2) {
  return std::max(sample_mm, std::sqrt(2 * area_mm2 / kMostSamples));
}

// A run of whole strips of a cut, and what finds the nearest of their points. Refers to the cut.
class CutPart {
 public:
  // Vertices [first, last) of the cut; `near_mm` as of NearCells.
  CutPart(const SweptSurface& cut, std::size_t first, std::size_t last, double near_mm, gpu::Backend backend)
      : cut_(cut),
        first_(first),
        vertices_(std::span(cut.vertices).subspan(first, last - first)),
        some_(last - first < cut.vertices.size() ? within(cut, first, last) : Triangles{}),
        triangles_(last - first < cut.vertices.size() ? std::span<const std::array<int, 3>>(some_)
                                                      : cut.triangles) {
    tbb::parallel_invoke([&] { cells_.emplace(vertices_, near_mm); },
                         [&] { search_.emplace(vertices_, triangles_, backend); });
    gpu::stop_point();
  }
  CutPart(const CutPart&) = delete;
  CutPart& operator=(const CutPart&) = delete;

  [[nodiscard]] const NearCells& cells() const { return *cells_; }
  [[nodiscard]] const gpu::MeshDistance& search() const { return *search_; }
  // Of the cut.
  [[nodiscard]] std::size_t vertex_of(int triangle) const {
    return first_ + static_cast<std::size_t>(triangles_[static_cast<std::size_t>(triangle)][0]);
  }
  [[nodiscard]] int strip_of(int triangle) const { return cut_.strip_of_vertex[vertex_of(triangle)]; }
  // Does the nearest point lie on the strips' edge?
  [[nodiscard]] bool on_edge(const gpu::Nearest& nearest) const {
    const auto sides = [&](int v) { return cut_.sides_of_vertex[first_ + static_cast<std::size_t>(v)]; };
    return lies_on(
        {vertices_, triangles_}, nearest, [&](int v) { return sides(v) != 0; },
        [&](int corner) {
          const auto& t = triangles_[static_cast<std::size_t>(corner / 3)];
          const auto i = static_cast<std::size_t>(corner % 3);
          return (sides(t[i]) & sides(t[(i + 1) % 3])) != 0;
        });
  }

 private:
  using Triangles = std::vector<std::array<int, 3>>;

  static Triangles within(const SweptSurface& cut, std::size_t first, std::size_t last) {
    Triangles triangles;
    const auto base = static_cast<int>(first), end = static_cast<int>(last);
    for (const auto& t : cut.triangles) {
      if (t[0] >= base && t[0] < end) triangles.push_back({t[0] - base, t[1] - base, t[2] - base});
    }
    return triangles;
  }

  const SweptSurface& cut_;
  std::size_t first_;
  std::span<const Eigen::Vector3d> vertices_;
  Triangles some_;  // of the cut, where the part is not all of it
  std::span<const std::array<int, 3>> triangles_;
  std::optional<NearCells> cells_;
  std::optional<gpu::MeshDistance> search_;
};

// One comparison of a cut with the design: its steps and what they share.
class CutMeasurement {
 public:
  CutMeasurement(SweptSurface cut, const Program& program, const surface::DesignSurface& design,
                 const VerifyOptions& options)
      : cut_(std::move(cut)),
        program_(program),
        mesh_{design.mesh.vertices(), design.mesh.triangles()},
        options_(options) {
    to_design_.emplace(design.mesh, program, options_.backend);
    report_.area_mm2 = design.health.area_mm2;
    report_.strip_max_mm.assign(program.strips.size(), 0.0);
  }

  VerifyReport run(const BladeTouches& touches) {
    cut_to_design();
    // The trees are large: only touches need all at once, and the cut's planes.
    if (touches.points.empty()) forget_what_cut_the_design();
    design_to_cut(touches.points.empty() ? options_.cut_vertices_at_once : cut_.vertices.size());
    count_touches(touches);
    report_.deviation = statistics_.result();
    report_.histogram = statistics_.histogram(options_.tolerance_mm);
    constexpr std::array kPercents{50.0, 90.0, 95.0, 99.0, 99.9, 100.0};
    const std::vector<double> within = statistics_.percentiles(kPercents);
    for (std::size_t i = 0; i < kPercents.size(); ++i) {
      report_.percentiles_mm.emplace_back(kPercents[i], within[i]);
      if (kPercents[i] == 99.0) report_.deviation.p99 = within[i];
    }
    constexpr double kCloseToTheCap = 0.95;
    const bool left_out = report_.beyond_samples > 0 || report_.uncut_mm2 > 0;
    report_.capped =
        left_out && report_.deviation.max <= near() && report_.deviation.max > kCloseToTheCap * near();
    report_.within_tolerance =
        report_.deviation.max <= options_.tolerance_mm && report_.uncut_share() <= options_.max_uncut_share;
    return report_;
  }

 private:
  [[nodiscard]] double near() const { return options_.reach * options_.tolerance_mm; }
  [[nodiscard]] double far() const { return options_.far * options_.tolerance_mm; }

  void add(double distance, const Eigen::Vector3d& at, int strip) {
    if (report_.worst_strip < 0 || distance > worst_) {
      worst_ = distance;
      report_.worst_strip = strip;
    }
    statistics_.add(distance, at);
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
          to_design_->feet(all.subspan(first, std::min(kAtOnce, all.size() - first)),
                           [&](std::size_t i) { return cut_.strip_of_vertex[first + i]; });
      compared.resize(on_design.size());
      for_each_of(compared.size(),
                  [&](std::size_t i) { compared[i] = compare_with_design(first + i, on_design[i]); });
      for (std::size_t i = 0; i < compared.size(); ++i) count(first + i, compared[i]);
    }
    report_.to_design = to_design_->used();
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
    const double speed = cut_.speeds_mm_s[i];
    const double by_cut = half_band_mm(program_.blade, cut_.normals[i], cut_.plane_normals[i], speed);
    const double by_design = half_band_mm(program_.blade, n, cut_.plane_normals[i], speed);
    c.half_band = std::abs(by_cut - by_design);
    return c;
  }

  void count(std::size_t i, const Compared& c) {
    if (c.beyond) {
      ++report_.beyond_samples;
      return;
    }
    const int strip = cut_.strip_of_vertex[i];
    report_.half_band_mm = std::max(report_.half_band_mm, c.half_band);
    add(c.distance, cut_.vertices[i], strip);
    double& largest = report_.strip_max_mm[static_cast<std::size_t>(strip)];
    largest = std::max(largest, c.distance);
  }

  void forget_what_cut_the_design() {
    to_design_.reset();
    for (auto* list : {&cut_.normals, &cut_.plane_normals}) std::vector<Eigen::Vector3d>().swap(*list);
    std::vector<double>().swap(cut_.speeds_mm_s);
    std::vector<double>().swap(cut_.curvature_per_mm);
    std::vector<int>().swap(cut_.pose_of_vertex);
  }

  // What of the cut is nearest to a design sample.
  struct NearestCut {
    double distance = std::numeric_limits<double>::infinity();
    int strip = -1;
    bool uncut = true;  // too far, or past the cut's edge
  };

  // The cut's vertices are searched so many at a time, whole strips.
  void design_to_cut(std::size_t at_once) {
    const double sample_mm = bounded(options_.sample_mm, report_.area_mm2);
    const DesignSampler sampler(mesh_, sample_mm);
    report_.design_samples = sampler.count();
    std::vector<NearestCut> nearest(sampler.count());
    for (std::size_t first = 0, last = 0; first < cut_.vertices.size(); first = last) {
      last = end_of_part(first, at_once);
      // A point of the cut lies within two steps of one of its vertices. Small cells would be many, and save
      // little.
      constexpr double kLeastCellMm = 100;
      part_.emplace(cut_, first, last, std::max(kLeastCellMm, far() + 2 * sample_mm), options_.backend);
      std::size_t at = 0;
      sampler.each(kAtOnce, [&](const DesignSamples& samples) {
        compare_with_part(samples.points, std::span(nearest).subspan(at, samples.points.size()));
        at += samples.points.size();
      });
      report_.to_cut = part_->search().used();
    }
    std::size_t at = 0;
    sampler.each(kAtOnce, [&](const DesignSamples& samples) {
      for (std::size_t i = 0; i < samples.points.size(); ++i) {
        const NearestCut& found = nearest[at++];
        if (found.uncut) {
          report_.uncut_mm2 += samples.areas[i];
        } else {
          add(found.distance, samples.points[i], found.strip);
        }
      }
    });
  }

  // Behind `at_once` vertices or more, at the end of a strip.
  [[nodiscard]] std::size_t end_of_part(std::size_t first, std::size_t at_once) const {
    std::size_t last = std::min(cut_.vertices.size(), first + at_once);
    while (last < cut_.vertices.size() && cut_.strip_of_vertex[last] == cut_.strip_of_vertex[last - 1])
      ++last;
    return last;
  }

  void compare_with_part(std::span<const Eigen::Vector3d> points, std::span<NearestCut> nearest) {
    std::vector<char> held(points.size());
    part_->cells().hold(points, held);
    std::vector<std::size_t> index;
    std::vector<Eigen::Vector3d> asked;
    index.reserve(points.size());
    asked.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!held[i]) continue;
      index.push_back(i);
      asked.push_back(points[i]);
    }
    const std::vector<gpu::Nearest> found = part_->search().query(asked);
    for (std::size_t k = 0; k < found.size(); ++k) {
      NearestCut& best = nearest[index[k]];
      const double distance = found[k].distance;
      if (distance >= best.distance) continue;
      best = {distance, part_->strip_of(found[k].triangle),
              distance > far() || (distance > near() && part_->on_edge(found[k]))};
    }
  }

  void count_touches(const BladeTouches& touches) {
    if (touches.points.empty()) return;
    const std::vector<DesignFaces::Foot> touched =
        to_design_->feet(touches.points, [&](std::size_t i) { return touches.strip_of_point[i]; });
    std::vector<Eigen::Vector3d> feet;
    for (const DesignFaces::Foot& foot : touched) feet.push_back(foot.point);
    const std::vector<gpu::Nearest> formed = part_->search().query(feet);
    for (std::size_t i = 0; i < feet.size(); ++i) {
      // Only what the same strip forms: another strip's part lies in another block.
      if (part_->strip_of(formed[i].triangle) != touches.strip_of_point[i] || formed[i].distance > near())
        continue;
      if (touched[i].on_border || part_->on_edge(formed[i])) continue;
      const std::size_t vertex = part_->vertex_of(formed[i].triangle);
      Eigen::Vector3d n = touched[i].normal;
      if (n.dot(cut_.normals[vertex]) < 0) n = -n;
      const double above = n.dot(touches.points[i] - feet[i]);
      const double depth =
          half_band_mm(program_.blade, n, touches.plane_normals[i], touches.speeds_mm_s[i]) - above;
      if (!(depth > 0)) continue;
      report_.gouge_mm = std::max(report_.gouge_mm, depth);
      add(depth, feet[i], touches.strip_of_point[i]);
    }
  }

  SweptSurface cut_;
  const Program& program_;
  MeshView mesh_;  // the design's
  const VerifyOptions& options_;
  std::optional<DesignFaces> to_design_;
  std::optional<CutPart> part_;  // of the cut; all of it where touches are asked for
  DeviationStatistics statistics_;
  VerifyReport report_;
  double worst_ = 0;
};

}  // namespace

bool VerifyReport::holds() const {
  return std::all_of(branches.begin(), branches.end(), [](const BranchReport& b) { return b.held(); });
}

VerifyReport measure(SweptSurface cut, const BladeTouches& touches, const Program& program,
                     const surface::DesignSurface& design, const VerifyOptions& options) {
  if (!cut.triangles.empty()) return CutMeasurement(std::move(cut), program, design, options).run(touches);
  VerifyReport report;
  report.area_mm2 = report.uncut_mm2 = design.health.area_mm2;
  report.strip_max_mm.assign(program.strips.size(), 0.0);
  return report;
}

VerifyReport verify(const Program& program, const surface::DesignSurface& design,
                    const VerifyOptions& options) {
  std::vector<BranchReport> branches;
  double mismatch_mm = 0;
  RibCheck ribs;
  VerifyReport report;
  // Side by side: a strip's branch is followed by one thread.
  tbb::parallel_invoke([&] { branches = follow_branches(program, options.min_margin); },
                       [&] { mismatch_mm = clamp_mismatch_mm(program); },
                       [&] { ribs = check_ribs(program, options.tolerance_mm, options.backend); },
                       [&] {
                         const double sample_mm = bounded(options.sample_mm, design.health.area_mm2);
                         report = measure(swept_surface(program, sample_mm), {}, program, design, options);
                       });
  gpu::stop_point();
  report.branches = std::move(branches);
  report.ribs = std::move(ribs);
  report.clamp_mismatch_mm = mismatch_mm;
  report.within_tolerance = report.within_tolerance && report.clamp_mismatch_mm <= kClampMismatchMm;
  return report;
}

std::string largest_text(const VerifyReport& report) {
  return fmt::format("{}{:.3f} mm", report.capped ? ">= " : "", report.deviation.max);
}

std::vector<std::string> not_checked(const robot::Blade& blade) {
  return {"snaps and bending by verify between every sixteenth waypoint; the plan checks every pose",
          "errors of the clamps in the measured deviation: they have a line in the budget, and an amber "
          "verdict says "
          "what they may be",
          blade.melt.by_speed() ? "melt-back of a held blade" : "melt-back of a slow or held blade",
          "how much softer hot steel hangs than the blade that is measured: a fifth of its sag stands in the "
          "budget",
          kArmsNotChecked,
          "thermal spring-back",
          "plinth outside the kept side",
          kJerkNotChecked};
}

}  // namespace hotblade::pipeline

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
#include "pipeline/sayings/saying.hpp"
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
  constexpr std::size_t kPosesAtOnce = 1024;
  const robot::ClampOffsets& offsets = program.settings.machine.clamps;
  std::vector<double> worst(program.strips.size(), 0);
  tbb::parallel_for(std::size_t{0}, worst.size(), [&](std::size_t i) {
    const std::span<const BladePose> all(program.strips[i].poses);
    for (std::size_t first = 0; first < all.size(); first += kPosesAtOnce) {
      gpu::stop_point();
      const auto poses = all.subspan(first, std::min(kPosesAtOnce, all.size() - first));
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

double bounded(double sample_mm, double area_mm2) {
  return std::max(sample_mm, std::sqrt(2 * area_mm2 / kMostSamples));
}

// Strips of a cut, and what finds the nearest of their points. Refers to them.
class CutPart {
 public:
  // `near_mm` as of NearCells.
  CutPart(const SweptSurface& cut, double near_mm, gpu::Backend backend) : cut_(cut) {
    tbb::parallel_invoke([&] { cells_.emplace(cut.vertices, near_mm); },
                         [&] { search_.emplace(cut.vertices, cut.triangles, backend); });
    gpu::stop_point();
    for (const Eigen::Vector3d& p : cut.vertices) near_.extend(p);
    near_.min().array() -= near_mm;
    near_.max().array() += near_mm;
  }
  CutPart(const CutPart&) = delete;
  CutPart& operator=(const CutPart&) = delete;

  // Points farther off than `near_mm` may lie outside.
  [[nodiscard]] const Eigen::AlignedBox3d& near() const { return near_; }
  [[nodiscard]] const NearCells& cells() const { return *cells_; }
  [[nodiscard]] const gpu::MeshDistance& search() const { return *search_; }
  [[nodiscard]] std::size_t vertex_of(int triangle) const {
    return static_cast<std::size_t>(cut_.triangles[static_cast<std::size_t>(triangle)][0]);
  }
  [[nodiscard]] int strip_of(int triangle) const { return cut_.strip_of_vertex[vertex_of(triangle)]; }
  // Does the nearest point lie on the strips' edge?
  [[nodiscard]] bool on_edge(const gpu::Nearest& nearest) const {
    const auto sides = [&](int v) { return cut_.sides_of_vertex[static_cast<std::size_t>(v)]; };
    return lies_on(
        {cut_.vertices, cut_.triangles}, nearest, [&](int v) { return sides(v) != 0; },
        [&](int corner) {
          const auto& t = cut_.triangles[static_cast<std::size_t>(corner / 3)];
          const auto i = static_cast<std::size_t>(corner % 3);
          return (sides(t[i]) & sides(t[(i + 1) % 3])) != 0;
        });
  }

 private:
  const SweptSurface& cut_;
  Eigen::AlignedBox3d near_;
  std::optional<NearCells> cells_;
  std::optional<gpu::MeshDistance> search_;
};

// One comparison of a cut with the design: its steps and what they share. The cut comes in runs of whole
// strips, each of which is given up when it has been measured.
class CutMeasurement {
 public:
  CutMeasurement(const Program& program, const surface::DesignSurface& design, const VerifyOptions& options)
      : program_(program),
        mesh_{design.mesh.vertices(), design.mesh.triangles()},
        options_(options),
        to_design_(design.mesh, program, options_.backend),
        sample_mm_(bounded(options.sample_mm, design.health.area_mm2)),
        sampler_(mesh_, sample_mm_),
        nearest_(options.cut_only ? 0 : sampler_.count()) {
    report_.area_mm2 = design.health.area_mm2;
    report_.design_samples = nearest_.size();
    report_.strip_max_mm.assign(program.strips.size(), 0.0);
  }

  void add(const SweptSurface& cut, const BladeTouches& touches) {
    cut_to_design(cut);
    if (options_.cut_only) return;
    // A point of the cut lies within two steps of one of its vertices. Small cells would be many, and save
    // little.
    constexpr double kLeastCellMm = 100;
    const CutPart part(cut, std::max(kLeastCellMm, far() + 2 * sample_mm_), options_.backend);
    design_to_cut(part);
    report_.to_cut = part.search().used();
    count_touches(cut, part, touches);
  }

  // What is told of all that was added.
  VerifyReport take() {
    if (!options_.cut_only) count_design();
    for (const Touched& t : touched_) add(t.depth, t.at, t.strip);
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

  void cut_to_design(const SweptSurface& cut) {
    const std::span<const Eigen::Vector3d> all(cut.vertices);
    std::vector<Compared> compared;
    for (std::size_t first = 0; first < all.size(); first += kAtOnce) {
      const std::vector<DesignFaces::Foot> on_design =
          to_design_.feet(all.subspan(first, std::min(kAtOnce, all.size() - first)),
                          [&](std::size_t i) { return cut.strip_of_vertex[first + i]; });
      compared.resize(on_design.size());
      for_each_of(compared.size(),
                  [&](std::size_t i) { compared[i] = compare_with_design(cut, first + i, on_design[i]); });
      for (std::size_t i = 0; i < compared.size(); ++i) {
        gpu::stop_point();
        count(cut, first + i, compared[i]);
      }
    }
    report_.to_design = to_design_.used();
    report_.cut_samples += cut.vertices.size();
  }

  [[nodiscard]] Compared compare_with_design(const SweptSurface& cut, std::size_t i,
                                             const DesignFaces::Foot& on_design) const {
    Compared c{on_design.distance};
    const Eigen::Vector3d& n = on_design.normal;
    if (on_design.on_border) {
      const Eigen::Vector3d d = cut.vertices[i] - on_design.point;
      c.distance = std::abs(n.dot(d));
      c.beyond = (d - n.dot(d) * n).norm() > options_.edge_mm;
    }
    const double speed = cut.speeds_mm_s[i];
    const double by_cut = half_band_mm(program_.blade, cut.normals[i], cut.plane_normals[i], speed);
    const double by_design = half_band_mm(program_.blade, n, cut.plane_normals[i], speed);
    c.half_band = std::abs(by_cut - by_design);
    return c;
  }

  void count(const SweptSurface& cut, std::size_t i, const Compared& c) {
    if (c.beyond) {
      ++report_.beyond_samples;
      return;
    }
    const int strip = cut.strip_of_vertex[i];
    report_.half_band_mm = std::max(report_.half_band_mm, c.half_band);
    add(c.distance, cut.vertices[i], strip);
    double& largest = report_.strip_max_mm[static_cast<std::size_t>(strip)];
    largest = std::max(largest, c.distance);
  }

  // What of the cut is nearest to a design sample.
  struct NearestCut {
    double distance = std::numeric_limits<double>::infinity();
    int strip = -1;
    bool uncut = true;  // too far, or past the cut's edge
  };

  void design_to_cut(const CutPart& part) {
    sampler_.each_in(part.near(), kAtOnce, [&](std::size_t first, const DesignSamples& samples) {
      compare_with_part(part, samples.points, std::span(nearest_).subspan(first, samples.points.size()));
    });
  }

  void compare_with_part(const CutPart& part, std::span<const Eigen::Vector3d> points,
                         std::span<NearestCut> nearest) const {
    std::vector<char> held(points.size());
    part.cells().hold(points, held);
    std::vector<std::size_t> index;
    std::vector<Eigen::Vector3d> asked;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!held[i]) continue;
      index.push_back(i);
      asked.push_back(points[i]);
    }
    const std::vector<gpu::Nearest> found = part.search().query(asked);
    for (std::size_t k = 0; k < found.size(); ++k) {
      NearestCut& best = nearest[index[k]];
      const double distance = found[k].distance;
      if (distance >= best.distance) continue;
      best = {distance, part.strip_of(found[k].triangle),
              distance > far() || (distance > near() && part.on_edge(found[k]))};
    }
  }

  void count_design() {
    sampler_.each(kAtOnce, [&](std::size_t first, const DesignSamples& samples) {
      for (std::size_t i = 0; i < samples.points.size(); ++i) {
        gpu::stop_point();
        const NearestCut& found = nearest_[first + i];
        if (found.uncut) {
          report_.uncut_mm2 += samples.areas[i];
        } else {
          add(found.distance, samples.points[i], found.strip);
        }
      }
    });
  }

  void count_touches(const SweptSurface& cut, const CutPart& part, const BladeTouches& touches) {
    const int first_strip = cut.strip_of_vertex.front(), last_strip = cut.strip_of_vertex.back();
    std::vector<std::size_t> index;
    std::vector<Eigen::Vector3d> points;
    for (std::size_t i = 0; i < touches.points.size(); ++i) {
      if (touches.strip_of_point[i] < first_strip || touches.strip_of_point[i] > last_strip) continue;
      index.push_back(i);
      points.push_back(touches.points[i]);
    }
    if (index.empty()) return;
    const auto strip_of = [&](std::size_t k) { return touches.strip_of_point[index[k]]; };
    const std::vector<DesignFaces::Foot> touched = to_design_.feet(points, strip_of);
    std::vector<Eigen::Vector3d> feet;
    for (const DesignFaces::Foot& foot : touched) feet.push_back(foot.point);
    const std::vector<gpu::Nearest> formed = part.search().query(feet);
    for (std::size_t k = 0; k < feet.size(); ++k) {
      // Only what the same strip forms: another strip's part lies in another block.
      if (part.strip_of(formed[k].triangle) != strip_of(k) || formed[k].distance > near()) continue;
      if (touched[k].on_border || part.on_edge(formed[k])) continue;
      const std::size_t vertex = part.vertex_of(formed[k].triangle);
      Eigen::Vector3d n = touched[k].normal;
      if (n.dot(cut.normals[vertex]) < 0) n = -n;
      const double above = n.dot(points[k] - feet[k]);
      const double depth =
          half_band_mm(program_.blade, n, touches.plane_normals[index[k]], touches.speeds_mm_s[index[k]]) -
          above;
      if (!(depth > 0)) continue;
      report_.gouge_mm = std::max(report_.gouge_mm, depth);
      touched_.push_back({depth, feet[k], strip_of(k)});
    }
  }

  // A touch that reaches into the kept side.
  struct Touched {
    double depth = 0;
    Eigen::Vector3d at;
    int strip = -1;
  };

  const Program& program_;
  MeshView mesh_;  // the design's
  const VerifyOptions& options_;
  DesignFaces to_design_;
  double sample_mm_;
  DesignSampler sampler_;
  std::vector<NearestCut> nearest_;  // by design sample
  std::vector<Touched> touched_;
  DeviationStatistics statistics_;
  VerifyReport report_;
  double worst_ = 0;
};

}  // namespace

bool VerifyReport::holds() const {
  return std::all_of(branches.begin(), branches.end(), [](const BranchReport& b) { return b.held(); });
}

namespace {

// Of runs of a cut, given by each(use), which calls use(run) for one after the other.
template <typename Each>
VerifyReport measure_runs(const Each& each, const BladeTouches& touches, const Program& program,
                          const surface::DesignSurface& design, const VerifyOptions& options) {
  std::optional<CutMeasurement> measurement;
  each([&](const SweptSurface& run) {
    if (run.triangles.empty()) return;
    if (!measurement) measurement.emplace(program, design, options);
    measurement->add(run, touches);
  });
  if (measurement) return measurement->take();
  VerifyReport report;
  report.area_mm2 = report.uncut_mm2 = design.health.area_mm2;
  report.strip_max_mm.assign(program.strips.size(), 0.0);
  return report;
}

}  // namespace

VerifyReport measure(const SweptSurface& cut, const Program& program, const surface::DesignSurface& design,
                     const VerifyOptions& options) {
  return measure_runs([&](const auto& use) { use(cut); }, {}, program, design, options);
}

VerifyReport measure(const Program& cut, const BladeTouches& touches, const surface::DesignSurface& design,
                     const VerifyOptions& options) {
  const double sample_mm = bounded(options.sample_mm, design.health.area_mm2);
  // A touch is of the strip that is nearest to it in all of the cut.
  const std::size_t at_once =
      touches.points.empty() ? options.cut_vertices_at_once : std::numeric_limits<std::size_t>::max();
  return measure_runs([&](const auto& use) { each_swept_surface(cut, sample_mm, at_once, use); }, touches,
                      cut, design, options);
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
                       [&] { report = measure(program, {}, design, options); });
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

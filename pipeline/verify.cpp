#include "pipeline/verify.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "gpu/mesh_distance.hpp"
#include "pipeline/near_cells.hpp"
#include "pipeline/plan/blade_path.hpp"
#include "pipeline/swept_surface.hpp"
#include "robot/blade_section.hpp"
#include "surface/face_links.hpp"

namespace hotblade::pipeline {

namespace {

// A mesh wherever it lies.
struct MeshView {
  std::span<const Eigen::Vector3d> vertices;
  std::span<const std::array<int, 3>> triangles;
};

// Edges with one face, by the corner of the face that they start at, and their vertices.
struct Border {
  surface::FaceLinks links;
  std::vector<bool> vertex;

  explicit Border(const MeshView& mesh)
      : links(surface::link_faces(mesh.triangles)), vertex(mesh.vertices.size(), false) {
    for (std::size_t c = 0; c < links.beyond.size(); ++c) {
      if (!edge(c)) continue;
      const auto& t = mesh.triangles[c / 3];
      vertex[static_cast<std::size_t>(t[c % 3])] = vertex[static_cast<std::size_t>(t[(c + 1) % 3])] = true;
    }
  }
  [[nodiscard]] bool edge(std::size_t corner) const {
    return links.beyond[corner] == surface::FaceLinks::kNone;
  }
};

struct Facet {
  Eigen::Vector3d a, b, c;
  [[nodiscard]] Eigen::Vector3d normal() const { return (b - a).cross(c - a).stableNormalized(); }
  [[nodiscard]] double area() const { return 0.5 * (b - a).cross(c - a).norm(); }
};

Facet facet(const MeshView& mesh, int triangle) {
  const auto& t = mesh.triangles[static_cast<std::size_t>(triangle)];
  return {mesh.vertices[static_cast<std::size_t>(t[0])], mesh.vertices[static_cast<std::size_t>(t[1])],
          mesh.vertices[static_cast<std::size_t>(t[2])]};
}

// Does the nearest point lie on the design's border? Shares of area below kOnEdge are rounding.
bool on_border(const MeshView& mesh, const Border& border, const gpu::Nearest& nearest) {
  constexpr double kOnEdge = 1e-7;
  const Facet f = facet(mesh, nearest.triangle);
  const auto& t = mesh.triangles[static_cast<std::size_t>(nearest.triangle)];
  const double area = f.area();
  if (!(area > 0)) return false;
  const std::array<double, 3> share{Facet{nearest.point, f.b, f.c}.area() / area,
                                    Facet{f.a, nearest.point, f.c}.area() / area,
                                    Facet{f.a, f.b, nearest.point}.area() / area};
  for (std::size_t i = 0; i < 3; ++i) {
    if (share[i] > 1 - kOnEdge) return border.vertex[static_cast<std::size_t>(t[i])];
  }
  for (std::size_t i = 0; i < 3; ++i) {
    if (share[i] < kOnEdge && border.edge(3 * static_cast<std::size_t>(nearest.triangle) + (i + 1) % 3))
      return true;
  }
  return false;
}

// Points spread over every face no farther apart than the spacing, with the areas they stand for.
struct DesignSamples {
  std::vector<Eigen::Vector3d> points;
  std::vector<double> areas;
};

// Rows parallel to the shortest edge, each divided by its own width: a needle makes samples in proportion to
// its length, not to the square of it.
void sample_facet(const Facet& f, double sample_mm, DesignSamples& samples) {
  const double ab = (f.b - f.a).norm(), bc = (f.c - f.b).norm(), ca = (f.a - f.c).norm();
  Facet g = f;  // b and c on the shortest edge
  if (ab <= bc && ab <= ca) g = {f.c, f.a, f.b};
  if (ca < ab && ca <= bc) g = {f.b, f.c, f.a};
  const double height = std::max((g.b - g.a).norm(), (g.c - g.a).norm()), width = (g.c - g.b).norm();
  const double rows = std::max(1.0, std::ceil(height / sample_mm));
  for (double i = 0; i < rows; ++i) {
    const double t = (i + 0.5) / rows, columns = std::max(1.0, std::ceil(t * width / sample_mm));
    const double area = f.area() * (2 * i + 1) / (rows * rows * columns);
    for (double k = 0; k < columns; ++k) {
      samples.points.push_back(g.a + t * (g.b - g.a + (k + 0.5) / columns * (g.c - g.b)));
      samples.areas.push_back(area);
    }
  }
}

// Largest distance between a clamp and the blade's end it holds, mm, tangents a radian counted as 1000 mm.
double clamp_mismatch_mm(const Program& program) {
  constexpr double kMmPerRad = 1000;
  std::vector<double> worst(program.strips.size(), 0);
  tbb::parallel_for(std::size_t{0}, worst.size(), [&](std::size_t i) {
    const std::vector<BladePose>& poses = program.strips[i].poses;
    std::vector<elastica::Elastica> blades;
    std::vector<Frame> frames;
    for (const BladePose& pose : poses) {
      blades.push_back(pose.blade);
      frames.push_back(pose.frame);
    }
    const std::vector<ClampPair> planned = clamps(blades, frames);
    for (std::size_t k = 0; k < poses.size(); ++k) {
      for (const auto clamp : {&ClampPair::a, &ClampPair::b}) {
        const Pose &is = clamp == &ClampPair::a ? poses[k].a : poses[k].b, &should = planned[k].*clamp;
        const double off = std::max((is.p - should.p).norm(), kMmPerRad * is.q.angularDistance(should.q));
        if (!(off <= worst[i])) worst[i] = off;
      }
    }
  });
  return worst.empty() ? 0 : *std::max_element(worst.begin(), worst.end(), [](double p, double q) {
    return p < q || std::isnan(q);
  });
}

std::vector<BranchReport> follow_branches(const Program& program, double min_margin) {
  const BladeData& b = program.blade;
  const robot::BladeSection section{b.width_mm,           b.thickness_mm, b.youngs_modulus_mpa, 0,
                                    b.yield_strength_mpa, b.safety,       b.density_kg_m3};
  std::vector<BranchReport> branches(program.strips.size());
  tbb::parallel_for(std::size_t{0}, branches.size(), [&](std::size_t i) {
    branches[i] = follow_branch(program.strips[i], {robot::max_curvature_per_mm(section), min_margin});
  });
  return branches;
}

// Distances in, statistics out; sums run in sample order, so they do not depend on threads.
class Statistics {
 public:
  void add(double distance, const Eigen::Vector3d& at) {
    if (distance > deviation_.max || all_.empty()) {
      deviation_.max = distance;
      deviation_.at = at;
    }
    sum_ += distance;
    sum_sq_ += distance * distance;
    all_.push_back(distance);
  }

  [[nodiscard]] Deviation result() {
    if (all_.empty()) return deviation_;
    const auto n = static_cast<double>(all_.size());
    deviation_.mean = sum_ / n;
    deviation_.rms = std::sqrt(sum_sq_ / n);
    deviation_.p99 = percentile(99);
    return deviation_;
  }

  // The deviation that this percentage of the samples stays within; 0 without samples.
  [[nodiscard]] double percentile(double percent) {
    if (all_.empty()) return 0;
    const double rank = std::ceil(percent / 100 * static_cast<double>(all_.size()));
    const auto nth = all_.begin() + static_cast<std::ptrdiff_t>(std::max(1.0, rank)) - 1;
    std::nth_element(all_.begin(), nth, all_.end());
    return *nth;
  }

  [[nodiscard]] DeviationHistogram histogram(double tolerance_mm) const {
    constexpr std::size_t kBins = 45;  // thirty up to the tolerance
    DeviationHistogram h{tolerance_mm / 30, std::vector<std::size_t>(kBins, 0), 0};
    for (const double distance : all_) {
      const double bin = distance / h.bin_mm;
      if (bin < static_cast<double>(kBins)) {
        ++h.counts[static_cast<std::size_t>(bin)];
      } else {
        ++h.beyond;
      }
    }
    return h;
  }

 private:
  Deviation deviation_;
  std::vector<double> all_;
  double sum_ = 0, sum_sq_ = 0;
};

// Samples of both surfaces together, about: on larger designs they lie farther apart, so that time and memory
// stay bounded.
constexpr double kMostSamples = 8e6;
// Samples that are measured at once: their answers take six times the memory of what stays of them.
constexpr std::size_t kAtOnce = 1 << 19;

double bounded(double sample_mm, double area_mm2) {
  return std::max(sample_mm, std::sqrt(2 * area_mm2 / kMostSamples));
}

// Calls use(samples) for the design's samples, some at a time and always the same.
template <typename Use>
void for_samples(const MeshView& mesh, double sample_mm, const Use& use) {
  DesignSamples samples;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    sample_facet(facet(mesh, static_cast<int>(t)), sample_mm, samples);
    if (samples.points.size() < kAtOnce && t + 1 < mesh.triangles.size()) continue;
    use(samples);
    samples.points.clear();
    samples.areas.clear();
  }
}

// A run of whole strips of a cut, and what finds the nearest of their points. Refers to the cut.
class CutPart {
 public:
  // Vertices [first, last) of the cut; `near_mm` as of NearCells.
  CutPart(const SweptSurface& cut, std::size_t first, std::size_t last, double near_mm, gpu::Backend backend)
      : cut_(cut),
        first_(first),
        vertices_(std::span(cut.vertices).subspan(first, last - first)),
        triangles_(within(cut, first, last)),
        cells_(vertices_, near_mm),
        search_(vertices_, triangles_, backend) {}

  [[nodiscard]] const NearCells& cells() const { return cells_; }
  [[nodiscard]] const gpu::MeshDistance& search() const { return search_; }
  // Of the cut.
  [[nodiscard]] std::size_t vertex_of(int triangle) const {
    return first_ + static_cast<std::size_t>(triangles_[static_cast<std::size_t>(triangle)][0]);
  }
  [[nodiscard]] int strip_of(int triangle) const { return cut_.strip_of_vertex[vertex_of(triangle)]; }
  // Does the nearest point lie on the strips' edge? Few samples ask.
  [[nodiscard]] bool on_edge(const gpu::Nearest& nearest) {
    const MeshView mesh{vertices_, triangles_};
    if (!border_) border_.emplace(mesh);
    return on_border(mesh, *border_, nearest);
  }

 private:
  static std::vector<std::array<int, 3>> within(const SweptSurface& cut, std::size_t first,
                                                std::size_t last) {
    std::vector<std::array<int, 3>> triangles;
    const auto base = static_cast<int>(first), end = static_cast<int>(last);
    for (const auto& t : cut.triangles) {
      if (t[0] >= base && t[0] < end) triangles.push_back({t[0] - base, t[1] - base, t[2] - base});
    }
    return triangles;
  }

  const SweptSurface& cut_;
  std::size_t first_;
  std::span<const Eigen::Vector3d> vertices_;
  std::vector<std::array<int, 3>> triangles_;
  NearCells cells_;
  gpu::MeshDistance search_;
  std::optional<Border> border_;
};

// One comparison of a cut with the design: its steps and what they share.
class CutMeasurement {
 public:
  CutMeasurement(SweptSurface cut, const Program& program, const surface::DesignSurface& design,
                 const VerifyOptions& options)
      : cut_(std::move(cut)),
        program_(program),
        mesh_{design.mesh.vertices, design.mesh.triangles},
        options_(options),
        border_(mesh_) {
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
    for (const double percent : {50.0, 90.0, 95.0, 99.0, 99.9, 100.0}) {
      report_.percentiles_mm.emplace_back(percent, statistics_.percentile(percent));
    }
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

  void cut_to_design() {
    to_design_.emplace(mesh_.vertices, mesh_.triangles, options_.backend);
    const std::span<const Eigen::Vector3d> all(cut_.vertices);
    for (std::size_t first = 0; first < all.size(); first += kAtOnce) {
      const std::vector<gpu::Nearest> on_design =
          to_design_->query(all.subspan(first, std::min(kAtOnce, all.size() - first)));
      for (std::size_t i = 0; i < on_design.size(); ++i) compare_with_design(first + i, on_design[i]);
    }
    report_.to_design = to_design_->used();
    report_.cut_samples = cut_.vertices.size();
  }

  void compare_with_design(std::size_t i, const gpu::Nearest& on_design) {
    double distance = on_design.distance;
    const Eigen::Vector3d n = facet(mesh_, on_design.triangle).normal();
    if (on_border(mesh_, border_, on_design)) {
      const Eigen::Vector3d d = cut_.vertices[i] - on_design.point;
      distance = std::abs(n.dot(d));
      if ((d - n.dot(d) * n).norm() > near()) {
        ++report_.beyond_samples;
        return;
      }
    }
    const double by_cut = half_band_mm(program_.blade, cut_.normals[i], cut_.plane_normals[i]);
    const double by_design = half_band_mm(program_.blade, n, cut_.plane_normals[i]);
    report_.half_band_mm = std::max(report_.half_band_mm, std::abs(by_cut - by_design));
    add(distance, cut_.vertices[i], cut_.strip_of_vertex[i]);
    double& strip = report_.strip_max_mm[static_cast<std::size_t>(cut_.strip_of_vertex[i])];
    strip = std::max(strip, distance);
  }

  void forget_what_cut_the_design() {
    to_design_.reset();
    for (auto* list : {&cut_.normals, &cut_.plane_normals}) std::vector<Eigen::Vector3d>().swap(*list);
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
    std::vector<NearestCut> nearest;
    for_samples(mesh_, sample_mm, [&](const DesignSamples& s) { report_.design_samples += s.points.size(); });
    nearest.resize(report_.design_samples);
    for (std::size_t first = 0, last = 0; first < cut_.vertices.size(); first = last) {
      last = end_of_part(first, at_once);
      // A point of the cut lies within two steps of one of its vertices. Small cells would be many, and save
      // little.
      constexpr double kLeastCellMm = 100;
      part_.emplace(cut_, first, last, std::max(kLeastCellMm, far() + 2 * sample_mm), options_.backend);
      std::size_t at = 0;
      for_samples(mesh_, sample_mm, [&](const DesignSamples& samples) {
        compare_with_part(samples.points, std::span(nearest).subspan(at, samples.points.size()));
        at += samples.points.size();
      });
      report_.to_cut = part_->search().used();
    }
    std::size_t at = 0;
    for_samples(mesh_, sample_mm, [&](const DesignSamples& samples) {
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
    std::vector<std::size_t> index;
    std::vector<Eigen::Vector3d> asked;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!part_->cells().holds(points[i])) continue;
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
    const std::vector<gpu::Nearest> touched = to_design_->query(touches.points);
    std::vector<Eigen::Vector3d> feet;
    for (const gpu::Nearest& foot : touched) feet.push_back(foot.point);
    const std::vector<gpu::Nearest> formed = part_->search().query(feet);
    for (std::size_t i = 0; i < feet.size(); ++i) {
      // Only what the same strip forms: another strip's part lies in another block.
      if (part_->strip_of(formed[i].triangle) != touches.strip_of_point[i] || formed[i].distance > near())
        continue;
      if (on_border(mesh_, border_, touched[i]) || part_->on_edge(formed[i])) continue;
      const std::size_t vertex = part_->vertex_of(formed[i].triangle);
      Eigen::Vector3d n = facet(mesh_, touched[i].triangle).normal();
      if (n.dot(cut_.normals[vertex]) < 0) n = -n;
      const double above = n.dot(touches.points[i] - feet[i]);
      const double depth = half_band_mm(program_.blade, n, touches.plane_normals[i]) - above;
      if (!(depth > 0)) continue;
      report_.gouge_mm = std::max(report_.gouge_mm, depth);
      add(depth, feet[i], touches.strip_of_point[i]);
    }
  }

  SweptSurface cut_;
  const Program& program_;
  MeshView mesh_;  // the design's
  const VerifyOptions& options_;
  Border border_;
  std::optional<gpu::MeshDistance> to_design_;
  std::optional<CutPart> part_;  // of the cut; all of it where touches are asked for
  Statistics statistics_;
  VerifyReport report_;
  double worst_ = 0;
};

}  // namespace

bool VerifyReport::holds() const {
  return std::all_of(branches.begin(), branches.end(),
                     [](const BranchReport& b) { return b.status == BranchStatus::kHeld; });
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
  const std::vector<BranchReport> branches = follow_branches(program, options.min_margin);
  VerifyReport report = measure(swept_surface(program, bounded(options.sample_mm, design.health.area_mm2)),
                                {}, program, design, options);
  report.branches = branches;
  report.clamp_mismatch_mm = clamp_mismatch_mm(program);
  report.within_tolerance = report.within_tolerance && report.clamp_mismatch_mm <= kClampMismatchMm;
  return report;
}

std::vector<std::string> not_checked() {
  return {
      "snaps and bending by verify between every sixteenth waypoint; the plan checks every pose",
      "clamp errors in the verdict: they have a line in the budget, and a straight blade a warning",
      "melt-back of a slow or held blade",
      "gravity in the measured deviation: its first-order share is added in the plan's verdict and budget",
      "arm reach and arm collision",
      "thermal spring-back",
      "plinth outside the kept side",
      "jerk of the clamps"};
}

}  // namespace hotblade::pipeline

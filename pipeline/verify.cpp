#include "pipeline/verify.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "gpu/mesh_distance.hpp"
#include "pipeline/near_cells.hpp"
#include "pipeline/plan/blade_path.hpp"
#include "pipeline/swept_surface.hpp"
#include "robot/blade_section.hpp"
#include "surface/face_links.hpp"

namespace hotblade::pipeline {

namespace {

// Edges with one face, by the corner of the face that they start at, and their vertices.
struct Border {
  surface::FaceLinks links;
  std::vector<bool> vertex;

  explicit Border(const surface::TriangleMesh& mesh)
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

Facet facet(const surface::TriangleMesh& mesh, int triangle) {
  const auto& t = mesh.triangles[static_cast<std::size_t>(triangle)];
  return {mesh.vertices[static_cast<std::size_t>(t[0])], mesh.vertices[static_cast<std::size_t>(t[1])],
          mesh.vertices[static_cast<std::size_t>(t[2])]};
}

// Does the nearest point lie on the design's border? Shares of area below kOnEdge are rounding.
bool on_border(const surface::TriangleMesh& mesh, const Border& border, const gpu::Nearest& nearest) {
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

DesignSamples sample_design(const surface::TriangleMesh& mesh, double sample_mm) {
  DesignSamples samples;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    sample_facet(facet(mesh, static_cast<int>(t)), sample_mm, samples);
  }
  return samples;
}

// Largest distance between a clamp and the blade's end it holds, mm, tangents a radian counted as 1000 mm.
double clamp_mismatch_mm(const Program& program) {
  constexpr double kMmPerRad = 1000;
  std::vector<double> worst(program.strips.size(), 0);
  tbb::parallel_for(std::size_t{0}, worst.size(), [&](std::size_t i) {
    for (const BladePose& pose : program.strips[i].poses) {
      const ClampPair planned = clamps(pose.blade, pose.frame);
      for (const auto& [is, should] : {std::pair{pose.a, planned.a}, std::pair{pose.b, planned.b}}) {
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

// Samples of both surfaces together, about: on larger designs they lie farther apart, so that memory stays
// bounded (about 1.5 GB).
constexpr double kMostSamples = 8e6;

double bounded(double sample_mm, double area_mm2) {
  return std::max(sample_mm, std::sqrt(2 * area_mm2 / kMostSamples));
}

// Design samples within `far` of the cut, more or less, and the area of all others.
double keep_near(const SweptSurface& cut, double sample_mm, double far_mm, DesignSamples& samples) {
  // A point of the cut lies within two steps of one of its vertices. Small cells would be many, and save
  // little.
  constexpr double kLeastCellMm = 100;
  const NearCells near(cut.vertices, std::max(kLeastCellMm, far_mm + 2 * sample_mm));
  double left_out = 0;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < samples.points.size(); ++i) {
    if (near.holds(samples.points[i])) {
      samples.points[kept] = samples.points[i];
      samples.areas[kept++] = samples.areas[i];
    } else {
      left_out += samples.areas[i];
    }
  }
  samples.points.resize(kept);
  samples.areas.resize(kept);
  return left_out;
}

// One comparison of a cut with the design: its steps and what they share.
class CutMeasurement {
 public:
  CutMeasurement(const SweptSurface& cut, const Program& program, const surface::DesignSurface& design,
                 const VerifyOptions& options)
      : cut_(cut),
        program_(program),
        mesh_(design.mesh),
        options_(options),
        border_(design.mesh),
        cut_mesh_{cut.vertices, cut.triangles},
        cut_border_(cut_mesh_),
        to_design_(design.mesh.vertices, design.mesh.triangles, options.backend),
        to_cut_(cut.vertices, cut.triangles, options.backend) {
    report_.area_mm2 = design.health.area_mm2;
    report_.strip_max_mm.assign(program.strips.size(), 0.0);
  }

  VerifyReport run(const BladeTouches& touches) {
    cut_to_design();
    design_to_cut();
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
  [[nodiscard]] int vertex_of(int triangle) const {
    return cut_.triangles[static_cast<std::size_t>(triangle)][0];
  }
  [[nodiscard]] int strip_of(int triangle) const {
    return cut_.strip_of_vertex[static_cast<std::size_t>(vertex_of(triangle))];
  }
  [[nodiscard]] double near() const { return options_.reach * options_.tolerance_mm; }

  void add(double distance, const Eigen::Vector3d& at, int strip) {
    if (report_.worst_strip < 0 || distance > worst_) {
      worst_ = distance;
      report_.worst_strip = strip;
    }
    statistics_.add(distance, at);
  }

  void cut_to_design() {
    const std::vector<gpu::Nearest> on_design = to_design_.query(cut_.vertices);
    report_.to_design = to_design_.used();
    for (std::size_t i = 0; i < cut_.vertices.size(); ++i) {
      double distance = on_design[i].distance;
      const Eigen::Vector3d n = facet(mesh_, on_design[i].triangle).normal();
      if (on_border(mesh_, border_, on_design[i])) {
        const Eigen::Vector3d d = cut_.vertices[i] - on_design[i].point;
        distance = std::abs(n.dot(d));
        if ((d - n.dot(d) * n).norm() > near()) {
          ++report_.beyond_samples;
          continue;
        }
      }
      const double by_cut = half_band_mm(program_.blade, cut_.normals[i], cut_.plane_normals[i]);
      const double by_design = half_band_mm(program_.blade, n, cut_.plane_normals[i]);
      report_.half_band_mm = std::max(report_.half_band_mm, std::abs(by_cut - by_design));
      add(distance, cut_.vertices[i], cut_.strip_of_vertex[i]);
      double& strip = report_.strip_max_mm[static_cast<std::size_t>(cut_.strip_of_vertex[i])];
      strip = std::max(strip, distance);
    }
    report_.cut_samples = cut_.vertices.size();
  }

  void design_to_cut() {
    const double far = options_.far * options_.tolerance_mm;
    const double sample_mm = bounded(options_.sample_mm, report_.area_mm2);
    DesignSamples samples = sample_design(mesh_, sample_mm);
    report_.design_samples = samples.points.size();
    report_.uncut_mm2 = keep_near(cut_, sample_mm, far, samples);
    const std::vector<gpu::Nearest> on_cut = to_cut_.query(samples.points);
    report_.to_cut = to_cut_.used();
    for (std::size_t i = 0; i < samples.points.size(); ++i) {
      const double distance = on_cut[i].distance;
      const bool uncut =
          distance > far || (distance > near() && on_border(cut_mesh_, cut_border_, on_cut[i]));
      if (uncut) {
        report_.uncut_mm2 += samples.areas[i];
      } else {
        add(distance, samples.points[i], strip_of(on_cut[i].triangle));
      }
    }
  }

  void count_touches(const BladeTouches& touches) {
    if (touches.points.empty()) return;
    const std::vector<gpu::Nearest> touched = to_design_.query(touches.points);
    std::vector<Eigen::Vector3d> feet;
    for (const gpu::Nearest& foot : touched) feet.push_back(foot.point);
    const std::vector<gpu::Nearest> formed = to_cut_.query(feet);
    for (std::size_t i = 0; i < feet.size(); ++i) {
      // Only what the same strip forms: another strip's part lies in another block.
      if (strip_of(formed[i].triangle) != touches.strip_of_point[i] || formed[i].distance > near()) continue;
      if (on_border(mesh_, border_, touched[i]) || on_border(cut_mesh_, cut_border_, formed[i])) continue;
      const auto vertex = static_cast<std::size_t>(vertex_of(formed[i].triangle));
      Eigen::Vector3d n = facet(mesh_, touched[i].triangle).normal();
      if (n.dot(cut_.normals[vertex]) < 0) n = -n;
      const double above = n.dot(touches.points[i] - feet[i]);
      const double depth = half_band_mm(program_.blade, n, touches.plane_normals[i]) - above;
      if (!(depth > 0)) continue;
      report_.gouge_mm = std::max(report_.gouge_mm, depth);
      add(depth, feet[i], touches.strip_of_point[i]);
    }
  }

  const SweptSurface& cut_;
  const Program& program_;
  const surface::TriangleMesh& mesh_;
  const VerifyOptions& options_;
  Border border_;
  surface::TriangleMesh cut_mesh_;
  Border cut_border_;
  gpu::MeshDistance to_design_, to_cut_;
  Statistics statistics_;
  VerifyReport report_;
  double worst_ = 0;
};

}  // namespace

bool VerifyReport::holds() const {
  return std::all_of(branches.begin(), branches.end(),
                     [](const BranchReport& b) { return b.status == BranchStatus::kHeld; });
}

VerifyReport measure(const SweptSurface& cut, const BladeTouches& touches, const Program& program,
                     const surface::DesignSurface& design, const VerifyOptions& options) {
  if (!cut.triangles.empty()) return CutMeasurement(cut, program, design, options).run(touches);
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

#include "pipeline/verify/design_samples.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "gpu/backend/stop.hpp"

namespace hotblade::pipeline {

namespace {

// Faces that are sampled by one thread, one after the other: work enough to be worth handing over.
constexpr std::size_t kRun = 256;

// Rows of samples on a face, parallel to its shortest edge, each divided by its own width.
class FaceRows {
 public:
  FaceRows(const Facet& f, double sample_mm) : sample_mm_(sample_mm), g_(f) {
    const double ab = (f.b - f.a).norm(), bc = (f.c - f.b).norm(), ca = (f.a - f.c).norm();
    if (ab <= bc && ab <= ca) g_ = {f.c, f.a, f.b};
    if (ca < ab && ca <= bc) g_ = {f.b, f.c, f.a};
    // b and c of g lie on the shortest edge, so both longer ones come from a.
    rows_ = std::max(1.0, std::ceil(std::max({ab, bc, ca}) / sample_mm));
    width_ = std::min({ab, bc, ca});
  }

  [[nodiscard]] std::size_t count() const {
    double count = 0;
    for (double i = 0; i < rows_; ++i) count += columns(i);
    return static_cast<std::size_t>(count);
  }

  void write(Eigen::Vector3d* points, double* areas) const {
    const double area = g_.area();
    for (double i = 0; i < rows_; ++i) {
      const double t = (i + 0.5) / rows_, in_row = columns(i);
      const double share = area * (2 * i + 1) / (rows_ * rows_ * in_row);
      for (double k = 0; k < in_row; ++k) {
        *points++ = g_.a + t * (g_.b - g_.a + (k + 0.5) / in_row * (g_.c - g_.b));
        *areas++ = share;
      }
    }
  }

 private:
  [[nodiscard]] double columns(double row) const {
    return std::max(1.0, std::ceil((row + 0.5) / rows_ * width_ / sample_mm_));
  }

  double sample_mm_;
  Facet g_;
  double rows_ = 1, width_ = 0;
};

}  // namespace

DesignSampler::DesignSampler(const MeshView& mesh, double sample_mm)
    : mesh_(mesh),
      sample_mm_(sample_mm),
      boxes_(mesh.triangles.size() / kRun + 1),
      first_(boxes_.size() + 1, 0) {
  if (!(sample_mm > 0)) throw std::logic_error("DesignSampler: sample_mm must be positive");
  tbb::parallel_for(std::size_t{0}, boxes_.size(), [&](std::size_t run) {
    const std::size_t end = std::min(mesh_.triangles.size(), (run + 1) * kRun);
    for (std::size_t t = run * kRun; t < end; ++t) {
      const Facet face = facet(mesh_, static_cast<int>(t));
      for (const Eigen::Vector3d& corner : {face.a, face.b, face.c}) boxes_[run].extend(corner);
      first_[run + 1] += FaceRows(face, sample_mm_).count();
    }
  });
  gpu::stop_point();
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
}

void DesignSampler::each(std::size_t at_once, const Use& use) const {
  constexpr double kAll = std::numeric_limits<double>::max();
  each_in({Eigen::Vector3d::Constant(-kAll), Eigen::Vector3d::Constant(kAll)}, at_once, use);
}

void DesignSampler::each_in(const Eigen::AlignedBox3d& box, std::size_t at_once, const Use& use) const {
  DesignSamples samples;
  const std::size_t runs = boxes_.size();
  for (std::size_t from = 0, to = 0; from < runs; from = to) {
    to = from + 1;
    if (!box.intersects(boxes_[from])) continue;
    while (to < runs && first_[to] - first_[from] < at_once && box.intersects(boxes_[to])) ++to;
    samples.points.resize(first_[to] - first_[from]);
    samples.areas.resize(samples.points.size());
    tbb::parallel_for(from, to, [&](std::size_t run) {
      gpu::stop_point();
      std::size_t at = first_[run] - first_[from];
      const std::size_t end = std::min(mesh_.triangles.size(), (run + 1) * kRun);
      for (std::size_t t = run * kRun; t < end; ++t) {
        const FaceRows rows(facet(mesh_, static_cast<int>(t)), sample_mm_);
        rows.write(samples.points.data() + at, samples.areas.data() + at);
        at += rows.count();
      }
    });
    gpu::stop_point();
    if (!samples.points.empty()) use(first_[from], samples);
  }
}

}  // namespace hotblade::pipeline

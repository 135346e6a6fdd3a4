// Points spread over every face of a design, no farther apart than a spacing.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <functional>
#include <vector>

#include "pipeline/verify/mesh_view.hpp"

namespace hotblade::pipeline {

struct DesignSamples {
  std::vector<Eigen::Vector3d> points;
  std::vector<double> areas;  // that the points stand for; of a face they add up to its own
};

// Makes the samples of a mesh, which it refers to. A needle makes samples in proportion to its length, not to
// the square of it.
class DesignSampler {
 public:
  // Keeps rows across each face and points along each row at most `sample_mm` > 0 apart (std::logic_error).
  DesignSampler(const MeshView& mesh, double sample_mm);

  [[nodiscard]] std::size_t count() const { return first_.back(); }

  // Calls use(first, samples) for all, in the order of the faces, `at_once` of them or a few more at a time:
  // memory. `first` is the number of samples before them. They are made on all cores allowed, and the same
  // whatever their number.
  using Use = std::function<void(std::size_t first, const DesignSamples& samples)>;
  void each(std::size_t at_once, const Use& use) const;
  // The same, but runs of faces without any sample in the box may be left out.
  void each_in(const Eigen::AlignedBox3d& box, std::size_t at_once, const Use& use) const;

 private:
  MeshView mesh_;
  double sample_mm_;
  std::vector<Eigen::AlignedBox3d> boxes_;  // of each run of faces
  std::vector<std::size_t> first_;  // sample of each run of faces, and the number of all behind the last
};

}  // namespace hotblade::pipeline

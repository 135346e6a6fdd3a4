// What the distances of a verification come to.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

// How much area deviates by how much: bin i holds [i, i + 1) * bin_mm, `beyond_mm2` what lies past the last
// one.
struct DeviationHistogram {
  double bin_mm = 0;
  std::vector<double> areas_mm2;
  double beyond_mm2 = 0;
};

// Collects distances with the area that each stands for, and returns their statistics; sums run in the order
// of the samples, so they do not depend on threads.
class DeviationStatistics {
 public:
  // The area may be 0: such a sample counts as the largest, and in nothing else.
  void add(double distance, const Eigen::Vector3d& at, double area_mm2);

  // Returns the largest of all and its place, the mean and the root of the mean square by area; percentiles()
  // has the 99 %. Zeros without samples.
  [[nodiscard]] Deviation result() const;

  // Returns the deviation that each percentage of the area, 0 to 100 and rising (std::logic_error), stays
  // within; zeros without samples. All of them stay within the largest.
  [[nodiscard]] std::vector<double> percentiles(std::span<const double> percents) const;

  // Returns thirty bins up to the tolerance and half as many more.
  [[nodiscard]] DeviationHistogram histogram(double tolerance_mm) const;

 private:
  struct Sample {
    double distance = 0, area_mm2 = 0;
  };
  Deviation deviation_;
  std::vector<Sample> all_;
  double sum_ = 0, sum_sq_ = 0, area_mm2_ = 0;
};

}  // namespace hotblade::pipeline

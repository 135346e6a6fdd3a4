// What the distances of a verification come to.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

// How many samples deviate by how much: bin i holds [i, i + 1) * bin_mm, `beyond` what lies past the last
// one.
struct DeviationHistogram {
  double bin_mm = 0;
  std::vector<std::size_t> counts;
  std::size_t beyond = 0;
};

// Collects distances and returns their statistics; sums run in the order of the samples, so they do not
// depend on threads.
class DeviationStatistics {
 public:
  void reserve(std::size_t samples) { all_.reserve(samples); }
  void add(double distance, const Eigen::Vector3d& at);

  // Returns the largest of all and its place, the mean and the root of the mean square; percentiles() has the
  // 99 %. Zeros without samples.
  [[nodiscard]] Deviation result() const;

  // Returns the deviation that each percentage of the samples, 0 to 100 and rising (std::logic_error), stays
  // within; zeros without samples.
  [[nodiscard]] std::vector<double> percentiles(std::span<const double> percents);

  // Returns thirty bins up to the tolerance and half as many more.
  [[nodiscard]] DeviationHistogram histogram(double tolerance_mm) const;

 private:
  Deviation deviation_;
  std::vector<double> all_;
  double sum_ = 0, sum_sq_ = 0;
};

}  // namespace hotblade::pipeline

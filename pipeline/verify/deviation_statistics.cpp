#include "pipeline/verify/deviation_statistics.hpp"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "gpu/backend/stop.hpp"

namespace hotblade::pipeline {

void DeviationStatistics::add(double distance, const Eigen::Vector3d& at, double area_mm2) {
  if (distance > deviation_.max || all_.empty()) {
    deviation_.max = distance;
    deviation_.at = at;
  }
  sum_ += distance * area_mm2;
  sum_sq_ += distance * distance * area_mm2;
  area_mm2_ += area_mm2;
  all_.push_back({distance, area_mm2});
}

Deviation DeviationStatistics::result() const {
  Deviation result = deviation_;
  if (!(area_mm2_ > 0)) return result;
  result.mean = sum_ / area_mm2_;
  result.rms = std::sqrt(sum_sq_ / area_mm2_);
  return result;
}

std::vector<double> DeviationStatistics::percentiles(std::span<const double> percents) {
  for (std::size_t i = 0; i < percents.size(); ++i) {
    if (!(percents[i] >= (i > 0 ? percents[i - 1] : 0) && percents[i] <= 100))
      throw std::logic_error("percentiles: percentages must rise from 0 to 100");
  }
  std::vector<double> values(percents.size(), 0.0);
  tbb::parallel_sort(all_.begin(), all_.end(), [](const Sample& a, const Sample& b) {
    return std::pair(a.distance, a.area_mm2) < std::pair(b.distance, b.area_mm2);
  });
  gpu::stop_point();
  std::size_t i = 0;
  double below_mm2 = 0;  // area of the samples before and with the one at hand
  for (const Sample& sample : all_) {
    below_mm2 += sample.area_mm2;
    for (; i < percents.size() && below_mm2 >= percents[i] / 100 * area_mm2_; ++i)
      values[i] = percents[i] < 100 ? sample.distance : deviation_.max;
  }
  // Sums of areas in another order are rounded otherwise.
  for (; i < percents.size() && !all_.empty(); ++i) values[i] = deviation_.max;
  return values;
}

DeviationHistogram DeviationStatistics::histogram(double tolerance_mm) const {
  constexpr std::size_t kBins = 45;  // thirty up to the tolerance
  DeviationHistogram h{tolerance_mm / 30, std::vector<double>(kBins, 0), 0};
  for (const Sample& sample : all_) {
    const double bin = sample.distance / h.bin_mm;
    if (bin < static_cast<double>(kBins)) {
      h.areas_mm2[static_cast<std::size_t>(bin)] += sample.area_mm2;
    } else {
      h.beyond_mm2 += sample.area_mm2;
    }
  }
  return h;
}

}  // namespace hotblade::pipeline

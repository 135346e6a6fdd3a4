#include "pipeline/verify/deviation_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace hotblade::pipeline {

void DeviationStatistics::add(double distance, const Eigen::Vector3d& at) {
  if (distance > deviation_.max || all_.empty()) {
    deviation_.max = distance;
    deviation_.at = at;
  }
  sum_ += distance;
  sum_sq_ += distance * distance;
  all_.push_back(distance);
}

Deviation DeviationStatistics::result() const {
  Deviation result = deviation_;
  if (all_.empty()) return result;
  const auto n = static_cast<double>(all_.size());
  result.mean = sum_ / n;
  result.rms = std::sqrt(sum_sq_ / n);
  return result;
}

std::vector<double> DeviationStatistics::percentiles(std::span<const double> percents) {
  std::vector<double> values(percents.size(), 0.0);
  auto first = all_.begin();  // what lies before is below all that is asked for next
  for (std::size_t i = 0; i < percents.size() && !all_.empty(); ++i) {
    if (!(percents[i] >= (i > 0 ? percents[i - 1] : 0) && percents[i] <= 100))
      throw std::logic_error("percentiles: percentages must rise from 0 to 100");
    const double rank = std::ceil(percents[i] / 100 * static_cast<double>(all_.size()));
    const auto nth = all_.begin() + static_cast<std::ptrdiff_t>(std::max(1.0, rank)) - 1;
    if (nth >= first) {
      std::nth_element(first, nth, all_.end());
      first = nth + 1;
    }
    values[i] = *nth;
  }
  return values;
}

DeviationHistogram DeviationStatistics::histogram(double tolerance_mm) const {
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

}  // namespace hotblade::pipeline

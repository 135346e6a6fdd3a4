#include "pipeline/verify/deviation_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

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

std::vector<double> DeviationStatistics::percentiles(std::span<const double> percents) const {
  for (std::size_t i = 0; i < percents.size(); ++i) {
    if (!(percents[i] >= (i > 0 ? percents[i - 1] : 0) && percents[i] <= 100))
      throw std::logic_error("percentiles: percentages must rise from 0 to 100");
  }
  const auto wanted_mm2 = [&](std::size_t i) { return percents[i] / 100 * area_mm2_; };
  const std::size_t open =
      static_cast<std::size_t>(std::lower_bound(percents.begin(), percents.end(), 100.0) -
                               percents.begin());  // the rest is the largest
  // By size in bins: only what lies in the bins that the percentages fall into is put in order.
  constexpr std::size_t kBins = 1 << 12;
  const auto bin_of = [&](const Sample& sample) {
    const double bin = deviation_.max > 0 ? sample.distance / deviation_.max * kBins : 0;
    return static_cast<std::size_t>(std::min(std::max(0.0, bin), static_cast<double>(kBins - 1)));
  };
  struct Bin {
    std::size_t count = 0;
    double mm2 = 0, below_mm2 = 0;
    bool asked = false;
    std::vector<Sample> samples;  // where it is asked for
  };
  std::vector<Bin> bins(kBins);
  for (const Sample& sample : all_) {
    Bin& bin = bins[bin_of(sample)];
    ++bin.count;
    bin.mm2 += sample.area_mm2;
  }
  std::size_t i = 0;
  double below_mm2 = 0;
  for (Bin& bin : bins) {
    bin.below_mm2 = below_mm2;
    below_mm2 += bin.mm2;
    for (; i < open && bin.count > 0 && below_mm2 >= wanted_mm2(i); ++i) bin.asked = true;
  }
  for (const Sample& sample : all_) {
    if (Bin& bin = bins[bin_of(sample)]; bin.asked) bin.samples.push_back(sample);
  }
  std::vector<double> values(percents.size(), 0.0);
  i = 0;
  for (Bin& bin : bins) {
    std::sort(bin.samples.begin(), bin.samples.end(), [](const Sample& a, const Sample& b) {
      return std::pair(a.distance, a.area_mm2) < std::pair(b.distance, b.area_mm2);
    });
    double mm2 = bin.below_mm2;  // of the samples before and with the one at hand
    for (const Sample& sample : bin.samples) {
      mm2 += sample.area_mm2;
      for (; i < open && mm2 >= wanted_mm2(i); ++i) values[i] = sample.distance;
    }
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

#include "pipeline/study/distribution.hpp"

#include <algorithm>
#include <vector>

namespace hotblade::pipeline::study {

Distribution distribution(std::span<const double> values) {
  if (values.empty()) return {};
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  Distribution d;
  for (const double v : sorted) d.mean += v / static_cast<double>(sorted.size());
  const auto quantile = [&sorted](double q) {
    const auto rank = static_cast<std::size_t>(q * static_cast<double>(sorted.size()));
    return sorted[std::min(rank, sorted.size() - 1)];
  };
  d.median = quantile(0.5);
  d.p99 = quantile(0.99);
  d.p9999 = quantile(0.9999);
  d.max = sorted.back();
  return d;
}

nlohmann::ordered_json to_json(const Distribution& d) {
  return {{"mean", d.mean}, {"median", d.median}, {"p99", d.p99}, {"p9999", d.p9999}, {"max", d.max}};
}

}  // namespace hotblade::pipeline::study

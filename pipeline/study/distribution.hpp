// Mean and quantiles of a sample, as the papers print them.
#pragma once

#include <nlohmann/json.hpp>
#include <span>

namespace hotblade::pipeline::study {

struct Distribution {
  double mean = 0, median = 0, p99 = 0, p9999 = 0, max = 0;
};

// The figures of a sample; quantile q is the value of rank floor(q n). An empty sample has zeros.
[[nodiscard]] Distribution distribution(std::span<const double> values);

[[nodiscard]] nlohmann::ordered_json to_json(const Distribution& distribution);

}  // namespace hotblade::pipeline::study

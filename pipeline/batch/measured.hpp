// What plans of a batch have taken so far, for an estimate of the others.
#pragma once

#include <optional>
#include <vector>

#include "pipeline/batch/batch.hpp"

namespace hotblade::pipeline::batch {

// Returns the median, the upper one of an even number. Throws std::logic_error for no values.
[[nodiscard]] double median_of(std::vector<double> values);

// Returns the median time of the plans that have a result in the directory, by the clock, of a batch asked
// otherwise before too; absent where there is none. Of many results the first thousand by their keys count,
// which are hashes: any thousand. A result that cannot be read does not count.
[[nodiscard]] std::optional<double> measured_plan_s(const BatchDirectory& directory);

}  // namespace hotblade::pipeline::batch

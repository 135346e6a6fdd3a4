#include "gpu/curve/pair_distance_opencl.hpp"

#include <array>
#include <vector>

#include "elastica/kernels/curve_pair.h"

namespace hotblade::gpu {

extern const char* const pair_distance_source;

namespace {

using Difference = std::array<double, 3>;
using Bounds = std::array<double, 2>;
constexpr std::size_t kNodeBytes = (kMostPairSamples + 3) * sizeof(hb_pair_node);
static_assert(sizeof(PairNumbers) == 16 * sizeof(double), "the kernels read a double16 a pair");

std::vector<PairNumbers> gathered(const PairQueries& queries) {
  std::vector<PairNumbers> numbers(queries.n);
  for (std::size_t i = 0; i < queries.n; ++i) numbers[i] = queries.pairs[queries.index[i]];
  return numbers;
}

}  // namespace

PairsOnDevice::PairsOnDevice()
    : device_(shared_opencl_device()),
      difference_portions_(*device_, sizeof(PairNumbers), sizeof(Difference)),
      hausdorff_portions_(*device_, sizeof(PairNumbers), sizeof(Bounds), kNodeBytes) {
  device_->require_fp64();
  differences_ = device_->kernel(pair_distance_source, "pair_differences");
  hausdorff_ = device_->kernel(pair_distance_source, "pair_hausdorff");
}

void PairsOnDevice::differences(const PairQueries& queries, int panels, double* l2, double* h1,
                                double* length) const {
  const std::vector<PairNumbers> numbers = gathered(queries);
  std::vector<Difference> answers(queries.n);
  {
    const std::lock_guard lock(turn_);
    differences_.set(0, panels);
    difference_portions_.run(*device_, differences_, 1, numbers.data(), answers.data(), queries.n);
  }
  for (std::size_t i = 0; i < queries.n; ++i) {
    const unsigned at = queries.index[i];
    l2[at] = answers[i][0];
    h1[at] = answers[i][1];
    length[at] = answers[i][2];
  }
}

void PairsOnDevice::hausdorff(const PairQueries& queries, int samples, double* lower, double* upper) const {
  const std::vector<PairNumbers> numbers = gathered(queries);
  std::vector<Bounds> answers(queries.n);
  {
    const std::lock_guard lock(turn_);
    hausdorff_.set(0, samples);
    hausdorff_portions_.run(*device_, hausdorff_, 1, numbers.data(), answers.data(), queries.n);
  }
  for (std::size_t i = 0; i < queries.n; ++i) {
    lower[queries.index[i]] = answers[i][0];
    upper[queries.index[i]] = answers[i][1];
  }
}

}  // namespace hotblade::gpu

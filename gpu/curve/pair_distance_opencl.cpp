#include "gpu/curve/pair_distance_opencl.hpp"

#include <array>

#include "elastica/kernels/curve_pair.h"
#include "gpu/backend/blocks.hpp"

namespace hotblade::gpu {

extern const char* const pair_distance_source;

namespace {

using Difference = std::array<double, 3>;
using Bounds = std::array<double, 2>;
constexpr std::size_t kNodeBytes = (kMostPairSamples + 3) * sizeof(hb_pair_node);
static_assert(sizeof(PairNumbers) == 16 * sizeof(double), "the kernels read a double16 a pair");

// Pairs that one thread copies at a time.
constexpr std::size_t kPairsCopied = 2048;

// Runs a kernel over the pairs that are asked for; take(number of the pair, its answer) from many threads.
template <typename Answer, typename Take>
void run_pairs(const OpenClDevice& device, DeviceKernel& kernel, DevicePortions& portions,
               const PairQueries& queries, const Take& take) {
  portions.run(
      device, kernel, 1, queries.n,
      [&](std::size_t first, std::size_t n, void* into) {
        auto* const numbers = static_cast<PairNumbers*>(into);
        for_each_in_blocks(n, kPairsCopied,
                           [&](std::size_t i) { numbers[i] = queries.pairs[queries.index[first + i]]; });
      },
      [&](std::size_t first, std::size_t n, const void* from) {
        const auto* const answers = static_cast<const Answer*>(from);
        for_each_in_blocks(n, kPairsCopied,
                           [&](std::size_t i) { take(queries.index[first + i], answers[i]); });
      });
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
  const std::lock_guard lock(turn_);
  differences_.set(0, panels);
  run_pairs<Difference>(*device_, differences_, difference_portions_, queries,
                        [&](unsigned pair, const Difference& answer) {
                          l2[pair] = answer[0];
                          h1[pair] = answer[1];
                          length[pair] = answer[2];
                        });
}

void PairsOnDevice::hausdorff(const PairQueries& queries, int samples, double* lower, double* upper) const {
  const std::lock_guard lock(turn_);
  hausdorff_.set(0, samples);
  run_pairs<Bounds>(*device_, hausdorff_, hausdorff_portions_, queries,
                    [&](unsigned pair, const Bounds& answer) {
                      lower[pair] = answer[0];
                      upper[pair] = answer[1];
                    });
}

}  // namespace hotblade::gpu

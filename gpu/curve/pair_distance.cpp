#include "gpu/curve/pair_distance.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "elastica/kernels/simd.hpp"
#include "gpu/backend/backend_choice.hpp"
#include "gpu/backend/blocks.hpp"
#include "gpu/backend/stop.hpp"
#include "gpu/curve/pair_distance_opencl.hpp"
#include "gpu/curve/pair_frame.hpp"
#include "gpu/curve/pair_lanes.hpp"

namespace hotblade::gpu {
namespace {

using Bezier = std::array<Eigen::Vector2d, 4>;

// Pairs of one task; with which the host is timed, and the device, which few do not fill; on the device at
// once.
constexpr std::size_t kPairBlock = 1024, kPairsTimed = 2048, kPairsTimedOnDevice = 1 << 15,
                      kPairPortion = std::size_t{1} << 17;
// Beziers shorter than this in their frame are points.
constexpr double kLeastLength = 1e-100;
// Bounds that are wider than the tolerance by less than this get narrow by twice the samples, twice at most:
// they close with the square of their number, near curves' with the third power.
constexpr double kWorthMoreSamples = 12;
constexpr int kRounds = 3;

struct PairQuery {
  std::span<const Bezier> beziers;
  std::span<const ElasticaState> elastica;
  double tolerance;
  std::span<PairDistance> out;
  [[nodiscard]] std::size_t size() const { return beziers.size(); }
  [[nodiscard]] PairQuery part(std::size_t first, std::size_t n) const {
    return {beziers.subspan(first, n), elastica.subspan(first, n), tolerance, out.subspan(first, n)};
  }
};

// Blocks of pairs on their way, one after the other in the same memory. Kernels is PairLanes or
// PairsOnDevice.
template <typename Kernels>
class Block {
 public:
  explicit Block(const Kernels& kernels) : kernels_(kernels) {}

  // Returns how many pairs needed the careful search.
  std::size_t answer(const PairQuery& q) {
    frames_.resize(q.size());
    numbers_.resize(q.size());
    for (auto* column : {&l2_, &h1_, &length_, &lower_, &upper_}) column->resize(q.size());
    for_each_pair([&](std::size_t i) {
      frames_[i] = pair_frame(q.beziers[i], q.elastica[i], q.tolerance);
      numbers_[i] = frames_[i].numbers;
    });
    differences();
    const std::size_t careful = bounds();
    for_each_pair([&](std::size_t i) { q.out[i] = result(i); });
    return careful;
  }

 private:
  // Runs what costs little; a block of the host is one task already.
  template <typename Each>
  void for_each_pair(const Each& each) const {
    for_each_in_blocks(frames_.size(), kPairBlock, each);
  }

  [[nodiscard]] bool answerable(std::size_t i) const { return frames_[i].status == PairStatus::kOk; }
  // Room for rounding on either side of the bounds.
  [[nodiscard]] static double narrow(const PairFrame& f) { return f.tolerance - 2 * kPairErrorRel; }

  // Calls run(queries, n) for the pairs of each n that count_of(i) gives, 0 for none.
  template <typename Count, typename Run>
  void by_count(int least, const Count& count_of, const Run& run) {
    std::vector<int> counts(frames_.size());
    for_each_pair([&](std::size_t i) { counts[i] = count_of(i); });
    std::vector<unsigned> index;
    for (int n = least; n <= kMostPairSamples; n *= 2) {
      index.clear();
      for (std::size_t i = 0; i < counts.size(); ++i) {
        if (counts[i] == n) index.push_back(static_cast<unsigned>(i));
      }
      if (!index.empty()) run(PairQueries{numbers_.data(), index.data(), index.size()}, n);
    }
  }

  void differences() {
    by_count(
        kLeastPairPanels, [&](std::size_t i) { return answerable(i) ? pair_panels(frames_[i]) : 0; },
        [&](const PairQueries& q, int n) {
          kernels_.differences(q, n, l2_.data(), h1_.data(), length_.data());
        });
  }

  std::size_t bounds() {
    std::vector<int> samples(frames_.size());
    for_each_pair([&](std::size_t i) {
      upper_[i] = std::numeric_limits<double>::infinity();
      const int wanted = answerable(i) && narrow(frames_[i]) > 0 ? pair_samples(frames_[i]) : 0;
      samples[i] = wanted <= kMostPairSamples ? wanted : 0;
    });
    for (int round = 0; round < kRounds; ++round) {
      by_count(
          kLeastPairSamples, [&](std::size_t i) { return samples[i]; },
          [&](const PairQueries& q, int n) { kernels_.hausdorff(q, n, lower_.data(), upper_.data()); });
      for_each_pair([&](std::size_t i) {
        const double gap = upper_[i] - lower_[i], narrow_enough = narrow(frames_[i]);
        const bool more = gap > narrow_enough && gap <= kWorthMoreSamples * narrow_enough;
        samples[i] = more && 2 * samples[i] <= kMostPairSamples ? 2 * samples[i] : 0;
      });
    }
    std::vector<std::size_t> careful;
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      if (answerable(i) && !(upper_[i] - lower_[i] <= narrow(frames_[i]))) careful.push_back(i);
    }
    tbb::parallel_for(std::size_t{0}, careful.size(), [&](std::size_t k) {
      stop_point();
      search(careful[k]);
    });
    stop_point();
    return careful.size();
  }

  void search(std::size_t i) {
    const PairFrame& f = frames_[i];
    const auto range = search_pair(f, std::max(narrow(f), 2 * kPairErrorRel));
    lower_[i] = range.lower;
    upper_[i] = range.upper;
  }

  [[nodiscard]] PairDistance result(std::size_t i) const {
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    const PairFrame& f = frames_[i];
    PairDistance r{kNaN, kNaN, kNaN, kNaN, f.status};
    if (!answerable(i)) return r;
    const double upper = upper_[i] + kPairErrorRel, lower = std::max(0.0, lower_[i] - kPairErrorRel);
    r.hausdorff = upper / f.scale;
    r.hausdorff_error = (upper - lower) / f.scale;
    if (upper - lower > f.tolerance * (1 + 1e-12))
      r.status = PairStatus::kWide;  // rounding of the difference
    if (!(length_[i] > kLeastLength)) {
      r.status = PairStatus::kNoLength;
      return r;
    }
    r.l2 = l2_[i];
    r.h1 = h1_[i];
    return r;
  }

  const Kernels& kernels_;
  std::vector<PairFrame> frames_;
  std::vector<PairNumbers> numbers_;
  std::vector<double> l2_, h1_, length_, lower_, upper_;
};

// Both return how many pairs needed the careful search.
std::size_t pairs_on_host(const PairQuery& q) {
  const std::size_t blocks = (q.size() + kPairBlock - 1) / kPairBlock;
  std::atomic<std::size_t> careful = 0;
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
    stop_point();
    const PairQuery part = q.part(block * kPairBlock, std::min(kPairBlock, q.size() - block * kPairBlock));
    careful += Block(pair_lanes()).answer(part);
  });
  stop_point();
  return careful;
}

std::size_t pairs_on_device(const PairsOnDevice& device, const PairQuery& q) {
  std::size_t careful = 0;
  Block block(device);
  for (std::size_t first = 0; first < q.size(); first += kPairPortion) {
    careful += block.answer(q.part(first, std::min(kPairPortion, q.size() - first)));
  }
  return careful;
}

}  // namespace

const PairLanes& pair_lanes() {
  switch (elastica::best_simd()) {
    case elastica::Simd::kAvx512:
      return kPairAvx512;
    case elastica::Simd::kAvx2:
      return kPairAvx2;
    case elastica::Simd::kBaseline:
      break;
  }
  return kPairBaseline;
}

struct PairDistances::Impl {
  explicit Impl(Backend backend) : choice(backend) {}
  mutable BackendChoice<PairsOnDevice> choice;
};

PairDistances::PairDistances(Backend backend) : impl_(std::make_unique<Impl>(backend)) {}
PairDistances::~PairDistances() = default;
PairDistances::PairDistances(PairDistances&&) noexcept = default;
PairDistances& PairDistances::operator=(PairDistances&&) noexcept = default;

std::size_t PairDistances::query(std::span<const Bezier> beziers, std::span<const ElasticaState> elastica,
                                 double tolerance, std::span<PairDistance> out) const {
  if (elastica.size() != beziers.size() || out.size() != beziers.size()) {
    throw std::logic_error("PairDistances::query: spans of different sizes");
  }
  if (!(tolerance > 0)) throw std::logic_error("PairDistances::query: needs a tolerance above 0");
  const PairQuery q{beziers, elastica, tolerance, out};
  std::size_t known = 0, careful = 0;  // what the host answered as it was timed
  const auto device = impl_->choice.choose(
      [&] {
        known = std::min(kPairsTimed, q.size());
        return host_seconds(q.size(), known, [&](std::size_t first, std::size_t count) {
          careful += pairs_on_host(q.part(first, count));
        });
      },
      [] { return std::make_shared<const PairsOnDevice>(); },
      [&](const PairsOnDevice& pairs) {
        return device_seconds(q.size(), std::min(kPairsTimedOnDevice, q.size()),
                              [&](std::size_t n) { pairs_on_device(pairs, q.part(0, n)); });
      });
  if (device) {
    try {
      return pairs_on_device(*device, q);
    } catch (const DeviceError& error) {
      impl_->choice.drop(error);
    }
  }
  return careful + pairs_on_host(q.part(known, q.size() - known));
}

BackendUse PairDistances::used() const {
  return impl_->choice.used();
}

}  // namespace hotblade::gpu

#include "pipeline/study/random_curves.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>

namespace hotblade::pipeline::study {

namespace {

std::uint64_t mixed(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15u;

elastica::Bezier drawn_in_disc(CurveRandom& random) {
  elastica::Bezier b;
  for (auto& p : b) {
    do {
      p.x() = random.between(-1, 1);
      p.y() = random.between(-1, 1);
    } while (p.squaredNorm() > 1);
  }
  return b;
}

}  // namespace

CurveRandom::CurveRandom(std::uint64_t seed, std::uint64_t index)
    : state_(mixed(mixed(seed + kGolden) ^ std::rotl(mixed(index * kGolden + 1), 32))) {}

double CurveRandom::unit() {
  state_ += kGolden;
  constexpr double kTwoToMinus53 = 1.0 / 9007199254740992.0;
  return static_cast<double>(mixed(state_) >> 11) * kTwoToMinus53;
}

elastica::Bezier disc_curve(std::uint64_t seed, std::uint64_t index,
                            const elastica::AngleConstraints& constraints) {
  CurveRandom random(seed, index);
  while (true) {
    const elastica::Bezier b = drawn_in_disc(random);
    const auto s = elastica::standard_position(b);
    if (s && elastica::angle_constraints_hold(*s, constraints)) return b;
  }
}

elastica::Bezier any_disc_curve(std::uint64_t seed, std::uint64_t index) {
  CurveRandom random(seed, index);
  return drawn_in_disc(random);
}

void over_blocks(std::size_t count, const std::function<void(double)>& progress,
                 const std::function<void(std::size_t, std::size_t)>& body) {
  // Blocks are a matter of speed alone; a group is what is done between two looks at the progress.
  constexpr std::size_t kBlock = 64, kGroup = 256 * kBlock;
  for (std::size_t start = 0; start < count; start += kGroup) {
    const std::size_t end = std::min(count, start + kGroup), blocks = (end - start + kBlock - 1) / kBlock;
    tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t k) {
      body(start + k * kBlock, std::min(end, start + (k + 1) * kBlock));
    });
    if (progress) progress(static_cast<double>(end) / static_cast<double>(count));
  }
}

}  // namespace hotblade::pipeline::study

// Random cubics of the papers' experiments. Curve number `index` of a seed is a function of both alone, so
// that any thread can draw any curve.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "elastica/bezier/bezier.hpp"
#include "elastica/bezier/standard_position.hpp"

namespace hotblade::pipeline::study {

// A counter-based generator: SplitMix64 (Steele, Lea, Flood 2014) on a stream of its own for each (seed,
// index).
class CurveRandom {
 public:
  CurveRandom(std::uint64_t seed, std::uint64_t index);
  // The next number, uniform in [0, 1) with 53 bits.
  double unit();
  double between(double low, double high) { return low + (high - low) * unit(); }

 private:
  std::uint64_t state_;
};

// A curve with its four points uniform in the unit disc, drawn again until the constraints hold.
[[nodiscard]] elastica::Bezier disc_curve(std::uint64_t seed, std::uint64_t index,
                                          const elastica::AngleConstraints& constraints);

// A curve with its four points uniform in the unit disc, without constraints.
[[nodiscard]] elastica::Bezier any_disc_curve(std::uint64_t seed, std::uint64_t index);

// Runs body(first, end) over [0, count) in blocks on all threads; `progress` gets the share done from the
// calling thread, between groups of blocks.
void over_blocks(std::size_t count, const std::function<void(double)>& progress,
                 const std::function<void(std::size_t first, std::size_t end)>& body);

}  // namespace hotblade::pipeline::study

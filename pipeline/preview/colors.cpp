#include "pipeline/preview/colors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace hotblade::pipeline::preview {
namespace {

Rgb mix(const Rgb& a, const Rgb& b, double share) {
  Rgb out;
  for (std::size_t i = 0; i < 3; ++i) out[i] = a[i] + share * (b[i] - a[i]);
  return out;
}

Rgb along(std::span<const Rgb> stops, double share) {
  const double place = std::clamp(share, 0.0, 1.0) * static_cast<double>(stops.size() - 1);
  const auto first = std::min(static_cast<std::size_t>(place), stops.size() - 2);
  return mix(stops[first], stops[first + 1], place - static_cast<double>(first));
}

// Pale inside the tolerance, dark beyond it: what is out of tolerance is seen at once, also by the
// colour-blind (blue against orange, and a step in lightness).
Rgb diverging(double value, double tolerance, double range) {
  constexpr Rgb kZero{0.97, 0.97, 0.95};
  constexpr Rgb kLowInside{0.36, 0.62, 0.86}, kHighInside{0.96, 0.62, 0.32};
  constexpr Rgb kLowBeyond{0.12, 0.22, 0.60}, kHighBeyond{0.72, 0.12, 0.10};
  constexpr Rgb kLowEnd{0.04, 0.04, 0.25}, kHighEnd{0.32, 0.00, 0.05};
  const bool high = value >= 0;
  const double size = std::abs(value);
  if (size <= tolerance) return mix(kZero, high ? kHighInside : kLowInside, size / tolerance);
  const double share = std::clamp((size - tolerance) / std::max(range - tolerance, 1e-9), 0.0, 1.0);
  return high ? mix(kHighBeyond, kHighEnd, share) : mix(kLowBeyond, kLowEnd, share);
}

constexpr Rgb kOverLimit{0.86, 0.12, 0.10};

}  // namespace

Rgb color_at(const ColorScale& scale, double value) {
  if (scale.tolerance) return diverging(value, *scale.tolerance, scale.high);
  if (scale.limit && value > *scale.limit) return kOverLimit;
  // Even steps in lightness, dark blue to yellow.
  constexpr std::array<Rgb, 5> kStops{
      {{0.19, 0.13, 0.42}, {0.20, 0.36, 0.60}, {0.16, 0.58, 0.56}, {0.50, 0.78, 0.40}, {0.97, 0.90, 0.32}}};
  const double high = scale.limit ? std::min(*scale.limit, scale.high) : scale.high;
  return along(kStops, (value - scale.low) / (high - scale.low));
}

Rgb strip_color(int strip) {
  constexpr std::array<Rgb, 8> kPalette{{{0.45, 0.66, 0.84},
                                         {0.96, 0.73, 0.42},
                                         {0.55, 0.76, 0.53},
                                         {0.88, 0.55, 0.58},
                                         {0.69, 0.62, 0.82},
                                         {0.86, 0.80, 0.45},
                                         {0.50, 0.76, 0.76},
                                         {0.76, 0.64, 0.54}}};
  return kPalette[static_cast<std::size_t>(strip) % kPalette.size()];
}

}  // namespace hotblade::pipeline::preview

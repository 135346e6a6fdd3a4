#include "pipeline/verify/width_heights.hpp"

#include <algorithm>
#include <limits>

namespace hotblade::pipeline {

namespace {

// A crest of radius r between two of them is w^2 / 512 r nearer: a thousandth of a millimetre for 20 mm at
// 780 mm.
constexpr std::size_t kAcross = 9;
// Of the design's points as many as a query answers well at once.
constexpr std::size_t kPlacesAtOnce = 4096;

}  // namespace

std::vector<double> width_heights(const DesignFaces& design, std::span<const WidthPlace> at, double width_mm,
                                  PastBorder past, const std::function<int(std::size_t)>& strip_of) {
  std::vector<double> heights(at.size(), std::numeric_limits<double>::infinity());
  std::vector<Eigen::Vector3d> points;
  for (std::size_t first = 0; first < at.size(); first += kPlacesAtOnce) {
    const std::size_t count = std::min(kPlacesAtOnce, at.size() - first);
    points.clear();
    for (const WidthPlace& place : at.subspan(first, count)) {
      for (std::size_t k = 0; k < kAcross; ++k) {
        const double share = static_cast<double>(k) / (kAcross - 1) - 0.5;
        points.push_back(place.point + share * width_mm * place.across);
      }
    }
    const std::vector<DesignFaces::Foot> feet =
        design.feet(points, [&](std::size_t i) { return strip_of(first + i / kAcross); });
    for (std::size_t place = 0; place < count; ++place) {
      if (feet[place * kAcross + kAcross / 2].on_border) continue;
      for (std::size_t i = place * kAcross; i < (place + 1) * kAcross; ++i) {
        if (feet[i].on_border && past == PastBorder::kNothing) continue;
        const double height = feet[i].normal.dot(points[i] - feet[i].point);
        heights[first + place] = std::min(heights[first + place],
                                          feet[i].normal.dot(at[first + place].waste) < 0 ? -height : height);
      }
    }
  }
  return heights;
}

}  // namespace hotblade::pipeline

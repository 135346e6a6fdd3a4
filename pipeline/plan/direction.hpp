// Which way the rib planes face: directions along the design's straight borders and over the hemisphere of
// its own axes, estimated from a few sections, the best of them planned coarsely, and ranked.
#pragma once

#include <optional>
#include <vector>

#include "pipeline/settings.hpp"
#include "surface/plane_family.hpp"

namespace hotblade::pipeline {

struct DirectionScore {
  Eigen::Vector3d normal;
  std::size_t strips = 0;    // planned coarsely, or estimated
  bool estimated = true;     // from the sections alone
  double covered_share = 0;  // of the design's area, about
  double deviation_mm = 0;   // of the worst coarse rib; 0 when estimated
  double raggedness = 0;     // change of the ribs' length over each chain, as a share of the longest, summed
  double steepness = 0;      // mean over the ribs of the design's steepest slope, as a share of 60 degrees
  std::optional<surface::FanAxis> fan{};  // planes turn about it; `normal` is that of the middle one
  double score =
      0;  // strips + 100 (1 - covered) + deviation / tolerance + raggedness + steepness; low is good
};

// Best first: those planned coarsely before those estimated. With slice.direction or slice.fan_axis set that
// one alone is scored; axes of fans are not searched for. Throws surface::FanError for an axis that does not
// go with the design. The axes are those of the surface's area, so turning the input turns the answer; where
// they are not told apart by the area (a square, a circle) the farthest vertex does. n and -n are one
// direction: the sense is that of the area's skewness.
[[nodiscard]] std::vector<DirectionScore> rank_directions(const surface::DesignSurface& design,
                                                          const Settings& settings);

}  // namespace hotblade::pipeline

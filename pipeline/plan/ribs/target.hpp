// What the blade's centre line shall follow: the design's sections, moved towards the waste by the local half
// band.
//
// The melted band is kerf + width |sin slope| wide, slope being the angle between the design's normal and the
// rib plane; the kept side follows the band's edge, so the centre line runs half a band away from the design,
// measured along the design's normal: half / cos(slope) in the rib plane (docs/planning.md).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/plan/ribs/rib_axes.hpp"
#include "pipeline/settings/settings.hpp"
#include "pipeline/verify/refusal.hpp"
#include "surface/slice/slice.hpp"

namespace hotblade::pipeline {

// The part of a rib, by arc length or by share of it, that the design says. The rest is waste.
struct DesignPart {
  double first = 0, last = 1;
};

// A rib's target in the axes of its chain.
struct RibTarget {
  double offset_mm = 0;                 // of its plane
  std::vector<Eigen::Vector2d> points;  // (u, v) on the chain's axes, A to B
  std::vector<double> s;                // cumulative length, s.front() = 0
  double max_slope_rad = 0;
  // Of the design for each mm of offset: its area, and that times |sin slope|.
  double area_mm = 0, leaning_mm = 0;
  std::optional<DesignPart>
      own;  // on `s`, of a rib that goes on past the design's border (pipeline/plan/ribs/complete.hpp)

  // Returns what of the share [u0, u1] the design says, in shares of that; first == last where it says
  // nothing.
  [[nodiscard]] DesignPart own_of(double u0, double u1) const;
};

// Consecutive ribs in common axes, y on the waste side.
struct ChainTarget : RibAxes {
  std::vector<RibTarget> ribs;
  std::string place;  // where in the design, for messages
};

// Chains with gaps between them as one, the gaps filled (pipeline/plan/ribs/bridge.hpp).
struct BridgeTarget {
  ChainTarget target;
  std::vector<std::size_t> chains;  // of TargetReport, ascending: what it may stand for
};

struct TargetReport {
  std::vector<ChainTarget> chains;
  std::vector<BridgeTarget> bridges;
  std::vector<Refusal> refusals;      // chains that cannot be targeted at all, with the reason
  std::vector<std::string> warnings;  // ribs left out
};

// Steeper ribs cannot be reached: the band would be wider than the blade's own width allows to correct.
inline constexpr double kMaxSlopeRad = 1.0471975511965976;  // 60 degrees

// Area of the design that a section stands for, for each mm of its plane's offset, and the same times |sin
// slope|: of the points in their order, a closed piece's last stretch included.
struct AreaRate {
  double area_mm = 0, leaning_mm = 0;
};
// Returns the area rate of one piece of a section.
[[nodiscard]] AreaRate area_rate(const surface::SectionPiece& piece, const surface::PlaneFamily& planes,
                                 double offset_mm);

// Sections hardly see what is steeper: they stand for no more area than at this slope.
inline constexpr double kUnseenSlopeRad = 1.4835298641951802;  // 85 degrees

// Returns the targets of all chains of a slicing.
[[nodiscard]] TargetReport make_targets(const surface::RibGraph& graph, const Settings& settings);

// Returns the width of the melted band in mm where the surface normal has component `along` (|sin slope|) on
// the plane normal.
[[nodiscard]] double melted_band_mm(const Settings& settings, double along);

// Returns n points evenly spaced by arc length over the shares [u0, u1] of the rib's length.
[[nodiscard]] std::vector<Eigen::Vector2d> resample(const RibTarget& rib, double u0, double u1, int n);

}  // namespace hotblade::pipeline

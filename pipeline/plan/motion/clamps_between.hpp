// How near the clamps of a blade come to the block between the ribs that it is planned at.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "elastica/fit/fit.hpp"
#include "pipeline/plan/ribs/rib_axes.hpp"
#include "pipeline/plan/ribs/rib_fit.hpp"
#include "pipeline/plan/ribs/rib_spline.hpp"
#include "pipeline/program/block.hpp"

namespace hotblade::pipeline {

class ClampsBetween {
 public:
  // Takes at least 2 ribs, offsets strictly ascending.
  ClampsBetween(const std::vector<RibFit>& ribs, const RibAxes& axes, const Block& block);

  struct Clearance {
    double mm = 0;
    int after = 0;  // the rib before it
  };
  // Returns the least clearance that was looked at, of a blade of this length whose extension lies to this
  // share on clamp A's side; 0 where it winds up. A distance from a box is convex: what it is at both ends of
  // a way, and how it changes there, bounds it from below in between, and a way that may come nearer than
  // `enough_mm` is halved, as long as it is longer than a mm. The first place that is nearer ends the search.
  [[nodiscard]] Clearance least(double length_mm, double share, double enough_mm) const;

 private:
  struct Place {
    double offset_mm = 0;
    elastica::MidState rib;
    Frame plane;
  };
  using Clamps = std::array<Eigen::Vector3d, 2>;  // in the block's axes
  class Search;

  [[nodiscard]] Place place_at(double offset_mm) const;

  RibAxes axes_;
  Block block_;
  RibSpline spline_;
  std::vector<Place> places_;  // ribs, and the quarters of the gaps between them
};

}  // namespace hotblade::pipeline

// What a design's shape says against the settings that it is read and planned with: reasons, and changes of
// settings that may help. Nothing of this was tried (pipeline/advice/advice.hpp tries it).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/settings/settings.hpp"

namespace hotblade::pipeline {

// The design in another unit.
struct OtherUnit {
  std::string units;
  Eigen::Vector3d size_mm{0, 0, 0};
  std::size_t strips_lower_bound = 1;
};

// A size that is odd for blade and blocks, and the units in which it would suit them: in the order mm, cm, m,
// in, ft, since sizes alone do not tell which of them is meant.
struct OddSize {
  std::string why;
  bool hopeless = false;  // hardly anything could be cut of it; else it is only large
  std::vector<OtherUnit> others;
};

// Changes of settings that go together, as `--set` takes them.
struct Suggestion {
  std::vector<std::string> assignments;  // "design.keep=back"
  std::string why;
};

// What of a design's shape is judged, in the unit that it was read in.
struct Shape {
  std::string units;
  Eigen::Vector3d size_mm{0, 0, 0};
  double area_mm2 = 0;  // of the faces to be cut
  // Of the sections in the rib planes that suit most of it, given or not: their smallest radius, and the
  // share of the area that is too steep or too sharp for a blade in them. Radius of the blade.
  double radius_mm = 0, lost_share = 0, blade_radius_mm = 0;
  std::optional<double> lost_in_given;  // the same share in planes that were given, where it is larger
  std::optional<std::array<double, 3>> facing;  // the side that shows most of a closed design
  double facing_share = 0;
  bool upright = false;           // `below` and `above` say nothing about it
  Eigen::Vector3d seen{0, 0, 0};  // shares of the area, looked at along each axis
  char up = 'z';
};

// Returns why the size is odd, in words, and units in which it is not; absent where it is not odd.
[[nodiscard]] std::optional<OddSize> odd_size(const Shape& shape, const Settings& settings);

// Tells whether most of it is lost in planes of whatever kind.
[[nodiscard]] bool is_mostly_lost(const Shape& shape);

// Returns that most of it is lost in the planes given, and less in others; absent where it is not so.
[[nodiscard]] std::optional<std::string> planes_warning(const Shape& shape);

// Tells whether the size is not odd, and would not be in planes that suit more of it either.
[[nodiscard]] bool is_of_usual_size(const Shape& shape, const Settings& settings);

// Returns it as one line: "largest extent ...: is the design really in mm? 900 x 500 x 140 mm if in m".
[[nodiscard]] std::string describe(const OddSize& odd);

// Returns what stands against the settings, one line each, without the size.
[[nodiscard]] std::vector<std::string> reasons(const Shape& shape, const Settings& settings);

// Returns changes that the shape suggests, likeliest first, each for itself: units that suit an odd size, y
// up, the side of a closed design, what to keep of an upright one.
[[nodiscard]] std::vector<Suggestion> suggestions(const Shape& shape, const std::optional<OddSize>& odd,
                                                  const Settings& settings);

// Returns a number of strips that no plan goes below. Fewer cannot cut a design: a strip's ribs are no longer
// than the longest blade, it leans against its planes by kMaxSlopeRad at most, and no point of its blade
// sweeps farther than the longest edge of a block, or than half the circle about its diagonal where planes
// turn. What may be left uncut need not be covered.
[[nodiscard]] std::size_t strips_lower_bound(double area_mm2, const Settings& settings);

}  // namespace hotblade::pipeline

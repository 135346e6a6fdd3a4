// What a plan of a design will meet, said of its mesh before anything is planned.
//
// The mesh is thinned first: of its points in one cell of a grid one is left. The cells are as wide as bends
// may be that the tolerance passes over, or wider on large designs, so that the answer takes a fraction of
// what reading the design takes. The surface's curvature at a point is that of the quadric that fits best to
// two rings of neighbours.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/plan/suggestions.hpp"
#include "pipeline/settings/settings.hpp"
#include "surface/read/design_surface.hpp"

namespace hotblade::pipeline {

// How sharply a surface bends.
struct Bending {
  double radius_mm = 0;  // the smallest, but for a thousandth of the area; infinite where nothing bends
  Eigen::Vector3d at{0, 0, 0};  // where that is
  double sharper_share = 0;     // of the area that bends more sharply than the blade may
};

struct Forecast {
  double blade_radius_mm = 0;  // the smallest that the blade may have
  std::size_t faces = 1;       // smooth ones, that lie apart or meet in creases, planned each of its own
  // Those between shallow folds too, where it is left open whether strips go over these; else as many.
  std::size_t faces_between_folds = 1;
  Bending surface;  // in any direction
  // Of the rib planes that suit most of the area, by their normal: their sections' bend, and the share of the
  // area that is steeper against them than a blade forms.
  Eigen::Vector3d planes{0, 0, 0};
  Bending sections;
  double steep_share = 0;
  // The faces that would be cut of a closed design; absent: it is open, or the settings choose some.
  std::optional<std::array<double, 3>> facing;
  double facing_share = 0;  // of the area
  double lean = 0;          // of the area's mean normal towards z, of the faces to be cut: -1 to 1
  bool upright = false;     // it leans so little that `below` and `above` say nothing about it
  std::size_t strips_lower_bound = 1;
  std::optional<OddSize> odd_size;  // for blade and blocks in the unit given
  // Most of the area is lost in the planes given, and less in others; absent where it is not so.
  std::optional<std::string> planes_warning;
  std::vector<std::string> reasons;     // what stands against the settings, without the size
  std::vector<Suggestion> suggestions;  // what may help: not tried
};

// Returns the forecast. The design must have triangles with an area (std::logic_error). Throws
// surface::FanError where the fan's axis does not go with the design.
[[nodiscard]] Forecast forecast(const surface::DesignSurface& design, const Settings& settings);

// What a plan begins with.
struct FirstLook {
  std::optional<OddSize> odd_size;
  std::optional<std::string> planes_warning;
  std::vector<Suggestion> suggestions;
};

// Returns them as the forecast has them, sooner: the best of many planes are looked for only where those
// along the design's own axes leave it open whether its size is odd. Throws as forecast() does.
[[nodiscard]] FirstLook first_look(const surface::DesignSurface& design, const Settings& settings);

}  // namespace hotblade::pipeline

// Panels as formwork is asked for, none of them a committed sample: twelve classic surfaces and bicubic
// patches, drawn from a seed. What a planner does with them nobody has tuned.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace hotblade::samples {

inline constexpr int kPanels = 40;
// Twice the sharpest bend of the default blade, 70.5 mm, rounded up.
inline constexpr double kPanelRadiusMm = 142;

// A mesh of one panel in mm. A border cut round leaves out the points that lie outside it.
struct Panel {
  std::string name;      // number and kind: c00_helicoid, p13_mild
  double radius_mm = 0;  // no principal curvature of the formula is sharper, on the points of its grid
  std::vector<Eigen::Vector3d> points;
  std::vector<std::array<int, 3>> triangles;  // counter-clockwise seen from the side of u x v
};

// The panels of a seed: numbers 0 to 11 are classic surfaces of random size, 12 to 39 bicubic patches in turn
// as they are drawn (free), half as high (mild) and cut to a disc (disc). Every fourth is turned in space.
// The numbers come from the 64-bit Mersenne twister by arithmetic written out here, so that a seed gives the
// same panels with every standard library.
[[nodiscard]] std::vector<Panel> panels(std::uint64_t seed);

// A dented panel is harder: it bends at its sharpest by no more than the first and no less than the second.
inline constexpr double kDentedLeastMm = 100, kDentedMostMm = 350;
// Smaller and more sharply bent ones of a seed, in turn domes with a dent, steps across them, waves, saddles
// with a bump and bumps, over 350 to 1000 by 250 to 700 mm. In turn they are whole, lack a corner and have a
// round window; every fourth is turned in space. Each cell's diagonal is drawn. Most have sections that bend
// to and fro more often than a blade can.
[[nodiscard]] std::vector<Panel> dented_panels(std::uint64_t seed);

// Parts of buildings of a seed, 0.3 to 4 m: in turn tubes and cones of up to 260 degrees, domes, ribbons,
// propellers, ramps, swells and waves askew. In turn they are whole, hexagons, angles, forks, and have a
// slit, a window and a round border with a round window; every fourth is turned in space. Each cell's
// diagonal is drawn. None bends more sharply than kPanelRadiusMm.
[[nodiscard]] std::vector<Panel> shell_panels(std::uint64_t seed);

// Narrow ruled vaults of a seed, 150 to 230 mm wide, 0.7 to 0.92 times as high and 250 to 400 long, that lean
// and rise along their length; every fourth is turned in space. Each cell's diagonal is drawn. Straight
// blades along them would do, but their crowns bend by 15 to 40 mm and their feet are steeper than 60 degrees
// to planes across them: they show where a planner ends.
[[nodiscard]] std::vector<Panel> vault_panels(std::uint64_t seed);

// The panel as an OBJ file's text, to 1e-6 mm.
[[nodiscard]] std::string obj_text(const Panel& panel);

}  // namespace hotblade::samples

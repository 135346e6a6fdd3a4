// What one swept family of elastica shall follow: the design's waste side, moved to the blade's middle line
// and cut by parallel planes.
//
// A point P with unit normal n towards the waste is formed by a blade whose middle line passes
//   T = P + (kerf + width |n . N|) / 2 n,
// N being the planes' normal: the melted band is that wide across a slope, and the kept side follows its
// edge. T is moved in space, so its place along the sweep moves as well; a blade that hangs forms it from a
// place higher by its droop, with its section twisted (sweep_sag.hpp). Sections are taken of the moved
// surface: the points of one section lie in one plane and are followed by one elastica.
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "pipeline/plan/sweep/sweep_sag.hpp"
#include "surface/read/design_surface.hpp"

namespace hotblade::pipeline {

// A design with a unit normal towards the waste at each vertex.
struct WasteSurface {
  std::vector<Eigen::Vector3d> points, normals;
  std::vector<std::array<int, 3>> triangles;
  std::vector<std::pair<int, int>> border;  // edges of one face, the smaller index first; ascending
  std::vector<int> corners;                 // vertices at which the border turns sharply; ascending
};

// Normals are the faces', weighted by their angles at the vertex. `side` is +1 where the waste lies on the
// faces' front, -1 where it lies behind them. Vertices of no face keep a zero normal and are never met.
[[nodiscard]] WasteSurface waste_surface(const surface::TriangleMesh& mesh, double side);

// Axes of a sweep: x cross y = sweep, y towards the waste; origin for offsets and in-plane coordinates.
struct SweepFrame {
  Eigen::Vector3d centre{0, 0, 0}, x{1, 0, 0}, y{0, 1, 0}, sweep{0, 0, 1};
};

// y is the mean normal of the waste's side, made square to the planes' normal. Where the mean vanishes, as on
// a closed surface, y is any direction square to it: such a surface is no graph over one blade.
[[nodiscard]] SweepFrame sweep_frame(const WasteSurface& surface, const Eigen::Vector3d& planes_normal,
                                     const Eigen::Vector3d& centre);

struct SweepSample {
  Eigen::Vector2d q{0, 0};  // on the frame's axes, mm
  double cosine = 1;  // of the slope against the plane: a distance in the plane times this is one in space
};

struct SweepSection {
  double offset_mm = 0;
  std::vector<SweepSample> samples;  // ascending in x; at least one
};

// The part of a design that one strip forms, in the frame's coordinates.
struct SweepWindow {
  double first_mm = -std::numeric_limits<double>::infinity(), last_mm = -first_mm;  // along the sweep
  double low_mm = first_mm, high_mm = last_mm;                                      // along x
};

struct SweepSectionOptions {
  double kerf_mm = 1, width_mm = 8;  // of the melted band
  int count = 24;                    // evenly spread sections
  double sample_mm = 20;  // samples of a section are about this far apart; points of the border and of the
                          // window's edges are all taken
  SweepWindow window = {};
  std::vector<double> extra_mm = {};  // offsets of further sections
  const SweepSag* sag = nullptr;      // of the blades that form the sections; none: weightless ones
};

struct SweepData {
  SweepFrame frame;
  std::vector<SweepSection> sections;  // ascending
  double steepest_rad = 0;             // of the design against the planes
  Eigen::Vector3d low{0, 0, 0},
      high{0, 0, 0};  // corners of the design's part, not moved: x, y, along the sweep
};

// Sections at both ends, close to them and to the corners, and evenly between; no section where there is no
// design. The result
// does not depend on the order of triangles but for ties. Empty sections where nothing lies in the window.
[[nodiscard]] SweepData sweep_sections(const WasteSurface& surface, const SweepFrame& frame,
                                       const SweepSectionOptions& options);

}  // namespace hotblade::pipeline

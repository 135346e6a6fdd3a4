// What one swept family of elastica shall follow: the design's waste side, moved to the blade's middle line
// and cut by the planes of the sweep, parallel ones or a fan.
//
// A point P with unit normal n towards the waste is formed by a blade whose middle line passes
//   T = P + (kerf / 2 + over_width(n . N)) n,
// N being the planes' normal, along which the width stands: width |n . N| / 2, and what the surface rises or
// falls by in half a width (robot/blade/band_edge.hpp). The kept side follows the band's edge. Where the band
// depends on the blade's speed, the kerf is that of a former plan there (SweptBands). T is moved in space, so
// its place along the sweep moves as well; a blade that hangs forms it from a place higher by its droop, with
// its section twisted (sweep_sag.hpp). Sections are taken of the moved surface: the points of one section lie
// in one plane and are followed by one elastica.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "pipeline/plan/ribs/rib_axes.hpp"
#include "pipeline/plan/ribs/rib_fit.hpp"
#include "pipeline/plan/sweep/surface_bend.hpp"
#include "pipeline/plan/sweep/sweep_sag.hpp"
#include "pipeline/plan/sweep/swept_bands.hpp"
#include "surface/read/design_surface.hpp"

namespace hotblade::pipeline {

// A design with a unit normal towards the waste at each vertex.
struct WasteSurface {
  std::vector<Eigen::Vector3d> points, normals;
  std::vector<SurfaceBend> bends;  // as the normals, over half a usual blade's width
  std::vector<std::array<int, 3>> triangles;
  std::vector<std::pair<int, int>> border;            // edges of one face, the smaller index first; ascending
  std::vector<int> corners;                           // vertices at which the border turns sharply; ascending
  std::shared_ptr<const WasteSurface> few = nullptr;  // for first looks at a dense design (sweep_few.hpp)
};

// Normals are the faces', weighted by their angles at the vertex. `side` is +1 where the waste lies on the
// faces' front, -1 where it lies behind them. Vertices of no face keep a zero normal and are never met.
[[nodiscard]] WasteSurface waste_surface(const surface::TriangleMesh& mesh, double side);

// A plane that parts of a design meet at: a part lies behind it.
struct SweepSeam {
  Eigen::Vector3d normal{1, 0, 0};  // unit
  double at_mm = 0;                 // of points p with normal . p = at_mm; behind it, less
};

[[nodiscard]] bool lies_behind(const std::vector<SweepSeam>& seams, const Eigen::Vector3d& p);

// The triangles that come nearer than `reach_mm` to what lies behind all seams, with their vertices, border
// and corners as they were.
[[nodiscard]] WasteSurface part_of(const WasteSurface& surface, const std::vector<SweepSeam>& seams,
                                   double reach_mm);

// Axes of a sweep over these planes: x cross y = sweep, which is the planes' normal; y is the waste's side,
// the mean normal made square to the planes'. Where that vanishes, as on a closed surface, y is any direction
// square to it: such a surface is no graph over one blade.
[[nodiscard]] RibAxes sweep_axes(const WasteSurface& surface, const surface::PlaneFamily& planes);

// What a surface leans to: the sum of its faces' areas times the normals at their corners, and of the sizes
// of these. Axes in any parallel planes follow from it.
struct SurfaceLean {
  Eigen::Vector3d sum{0, 0, 0};
  double whole = 0;
};
[[nodiscard]] SurfaceLean lean_of(const WasteSurface& surface);
// Returns the axes as sweep_axes() does, of planes that do not turn.
[[nodiscard]] RibAxes parallel_axes(const SurfaceLean& lean, const surface::PlaneFamily& planes);

struct SweepSample {
  Eigen::Vector2d q{0, 0};  // in the plane, mm
  double cosine = 1;     // of the slope against the plane: a distance in the plane times this is one in space
  bool at_seam = false;  // the design goes on there
};

struct SweepSection {
  double offset_mm = 0;
  std::vector<SweepSample> samples;  // ascending in x; at least one
};

// Of the design against the middle of its normals, in a plane: beyond, no blade forms it as one graph.
inline constexpr double kMostTurnRad = 1.55;

struct SweepSectionOptions {
  double kerf_mm = 1, width_mm = 8;  // of the melted band
  int count = 24;                    // evenly spread sections
  double sample_mm = 20;  // samples of a section are about this far apart; points of the border and of the
                          // seams are all taken
  std::vector<SweepSeam> seams = {};
  std::vector<double> extra_mm = {};  // offsets of further sections
  const SweepSag* sag = nullptr;      // of the blades that form the sections; none: weightless ones
  const SweptBands* bands = nullptr;  // that the blades melt by their speeds; none: kerf_mm everywhere
  // Gaps within sections are looked for from this width on, this far behind the seams; nothing: they are not
  // looked for.
  std::optional<double> gap_mm = {};
  double gap_behind_mm = 0;
  bool if_followable = false;  // no sections of what no blade follows (SweepData::followable)
};

// A gap in the design within a section, as of a window or between two arms.
struct SweepGap {
  double offset_mm = 0, low_mm = 0, high_mm = 0;  // in x
  [[nodiscard]] double width_mm() const { return high_mm - low_mm; }
};

struct SweepData {
  RibAxes axes;
  std::vector<SweepSection> sections;                      // ascending
  std::vector<std::pair<double, Eigen::Vector2d>> border;  // the border's points: offset, q
  std::optional<SweepGap> gap;                             // the widest, where gaps are looked for
  // Of 98 of a hundred vertices: the design's slope against the planes, and the angle in them between its
  // normals and y.
  double steepest_rad = 0, turn_rad = 0;
  [[nodiscard]] bool followable() const { return turn_rad <= kMostTurnRad && steepest_rad <= kMaxSlopeRad; }
  Eigen::Vector2d low{0, 0}, high{0, 0};       // corners of the design in the planes, not moved
  double first_mm = 0, last_mm = 0;            // of the moved surface, along the sweep
  bool seam_first = false, seam_last = false;  // ends of the sweep at seams
  Eigen::AlignedBox3d box;  // of the design on the axes of the middle plane, the third along the sweep
};

// Where the blade's middle line passes when it forms a point of the design with this unit normal, where the
// design bends so: in the plane at `offset_mm`.
struct FormedPoint {
  double offset_mm = 0;
  SweepSample sample;
};
[[nodiscard]] FormedPoint formed_point(const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                                       const SurfaceBend& bend, const RibAxes& axes,
                                       const SweepSectionOptions& options);

class MovedSurface;

// Sections at both ends, close to them and to the corners, and evenly between; no section where there is no
// design. The result does not depend on the order of triangles but for ties. Empty sections where nothing
// lies behind the seams.
[[nodiscard]] SweepData sweep_sections(const WasteSurface& surface, const RibAxes& axes,
                                       const SweepSectionOptions& options);
// Returns those of a surface that is moved already (moved_surface.hpp): of the options, what does not move
// it.
[[nodiscard]] SweepData sweep_sections(const MovedSurface& moved, const SweepSectionOptions& options);

}  // namespace hotblade::pipeline

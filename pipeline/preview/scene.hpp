// What a preview shows, as plain geometry in the design frame (mm): made from a program, drawn by
// drawing.hpp.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/preview/cell_view.hpp"
#include "pipeline/program/program.hpp"
#include "pipeline/program/refused_plan.hpp"
#include "pipeline/verify/verdict.hpp"
#include "surface/read/design_surface.hpp"

namespace hotblade::pipeline::preview {

enum class Color { kDeviation, kStrip, kCurvature, kMargin, kFeed };

// The colour mode of a name on the command line; absent for an unknown name.
[[nodiscard]] std::optional<Color> color_named(const std::string& name);

struct Polyline {
  std::vector<Eigen::Vector3d> points;
};

// The surface the blade leaves, with one value a vertex to colour it by.
struct CutSurface {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;
  std::vector<int> strip_of_vertex;      // index into Scene::strip_names
  std::vector<int> pose_of_vertex;       // index into the strip's poses
  std::vector<double> curvature_per_mm;  // of the blade, without sign
  std::vector<double> deviation_mm;      // signed (signed_deviation_mm); empty without a design
  std::vector<double> values;
};

// The scale by which `values` become colours.
struct ColorScale {
  std::string title;  // with the unit
  double low = 0, high = 1;
  std::optional<double> tolerance;  // diverging about 0 with a step at +-tolerance; absent: a sequential map
  std::optional<double> limit;      // of a sequential map: values above it take another colour
  double step = 0.25;               // between the marks of a sequential map
};

// A place that is marked whatever lies before it.
struct Mark {
  Eigen::Vector3d at{0, 0, 0};
  std::string words;  // what it is, for the key
};

struct Scene {
  surface::TriangleMesh design;     // empty: not shown
  CutSurface cut;                   // empty: only the design is shown
  std::optional<ColorScale> scale;  // absent: coloured by strip
  std::vector<std::string> strip_names;
  std::vector<Mark> strip_ids;  // where their cuts are in the middle; empty where one alone is shown
  std::vector<Polyline> ribs;
  std::vector<Polyline> blades;  // ghosts of the moving blade
  std::optional<Polyline> blade_now;
  std::vector<Pose> clamps_a, clamps_b;
  double clamp_size_mm = 10;
  std::vector<Block> blocks;
  std::vector<CellPart> cell;  // arms and what stands around them, at the time that is shown
  // The axes that views are taken along: the cell's, among the design, where arms are shown.
  Eigen::Matrix3d view_axes = Eigen::Matrix3d::Identity();
  std::optional<Mark> worst;                 // of what was refused
  Eigen::Vector3d waste_direction{0, 0, 0};  // mean, where the picture is best taken from; zero: none
  std::string title;
  std::string verdict;  // of the verification; empty: none
  VerdictColor verdict_color = VerdictColor::kRed;
  std::vector<std::string> caption;  // one line each
  std::string blade_note;            // what the ghost blades are, "blade every 25 mm"
};

struct SceneOptions {
  std::optional<Color> color;                // absent: deviation where a design is at hand, else strip
  std::string strip;                         // id; empty: all strips
  std::optional<double> at_s;                // show the blade and what is cut at this time of the strip
  std::optional<double> ghost_step_mm = {};  // between ghosts of the blade; absent: eight a strip
  // Shown with a time, and in the window; has to outlive what is made with it. Absent: no arms.
  const CellShown* cell = nullptr;
};

// The scene of a program; `design` may be null. Throws Error: kBadSettings for an unknown strip, a time
// outside the strip, a time without a strip where there are several, or deviation without a design.
[[nodiscard]] Scene scene_of(const Program& program, const surface::DesignSurface* design,
                             const SceneOptions& options);

// The program with the strips of `options` alone, their poses up to its time. Throws Error as
// scene_of does.
[[nodiscard]] Program shown_part(const Program& program, const SceneOptions& options);

// Puts a cell into a scene as a pose has it, up as in the cell.
void show_cell(Scene& scene, const CellShown& cell, const Strip& strip, std::size_t pose);

// The scene of a design alone.
[[nodiscard]] Scene scene_of(const surface::DesignSurface& design);

// Says in a scene why it is refused, and marks the place of the first reason that has one; without any, the
// largest deviation stays marked. A scene without a cut says that nothing is cut.
void mark_refusal(Scene& scene, const std::vector<RefusedReason>& reasons);

// The twelve edges of every block.
[[nodiscard]] std::vector<Polyline> block_edges(const std::vector<Block>& blocks);

// The signed distance of each point from the face of the design that its strip forms (design_faces.hpp), mm:
// positive on the waste side (foam left standing), negative where the cut is too deep. Waste lies above or
// below along z, or before or behind the face normals, as the program's `keep` says. Beyond the design's
// border or a crease it is the distance across the face's plane there, and NaN where a point is farther
// beyond it than `near_mm`: there the cut is in waste, or in foam of its own block, as verify counts it.
[[nodiscard]] std::vector<double> signed_deviation_mm(const surface::TriangleMesh& design,
                                                      const Program& program,
                                                      const std::vector<Eigen::Vector3d>& points,
                                                      const std::vector<int>& strip_of_point, double near_mm);

}  // namespace hotblade::pipeline::preview

// The sides of a design's border: what lies between its corners.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "surface/read/design_surface.hpp"
#include "surface/slice/plane_family.hpp"

namespace hotblade::pipeline {

// A polyline along the border, from corner to corner; a border without corners is one closed run.
struct BorderRun {
  std::vector<Eigen::Vector3d> points;  // a closed run repeats its first point
  Eigen::Vector3d normal;               // unit mean of the faces' normals beside it; zero where they cancel
  double length_mm = 0;
};

// Returns the border's runs, longest first; equal ones (to a millionth of the border) in the order of the
// mesh's corners, so that neither place nor turn of the design decides. A border turns by more than 30
// degrees at its corners.
[[nodiscard]] std::vector<BorderRun> border_runs(const surface::TriangleMesh& mesh);

// Returns the at most eight longest runs of a twentieth of the border at least: shorter ones are chamfers,
// windows and raggedness.
[[nodiscard]] std::vector<BorderRun> long_sides(const surface::TriangleMesh& mesh);

// A plane through p; n is a unit vector.
struct BorderPlane {
  Eigen::Vector3d p, n;
};

// Returns the plane that a run lies in. That of a straight run also holds the mean normal beside it, as the
// plane of a meridian does; for a run bent out of every plane it returns nothing.
[[nodiscard]] std::optional<BorderPlane> plane_of(const BorderRun& run);

[[nodiscard]] bool is_straight(const BorderRun& run);

// Returns the axis of the circle that a run is an arc of, of 6 degrees at least; nothing where it is none.
[[nodiscard]] std::optional<surface::FanAxis> circle_axis(const BorderRun& run);

}  // namespace hotblade::pipeline

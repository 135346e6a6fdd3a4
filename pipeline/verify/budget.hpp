// The error budget: what each step of the chain may add, in mm, each line computed on its own.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "pipeline/program/program.hpp"
#include "pipeline/settings/settings.hpp"
#include "surface/read/design_surface.hpp"
#include "surface/slice/creases.hpp"

namespace hotblade::pipeline {

// How far weight and the clamps' errors move the surface, the largest of all strips, mm.
struct PoseErrors {
  double droop_mm = 0;      // by droop and twist out of the plane
  double in_plane_mm = 0;   // by the first-order change of the shape in a tilted plane
  double clamp_mm = 0;      // by the clamps' errors times the sensitivity of the shape
  double joint_fit_mm = 0;  // the ribs' largest deviation above that of each rib's own fit
  double off_plane_mm = 0;  // between waypoints whose planes are not parallel
  double told_mm = 0;       // by the micrometres that a controller is told (pipeline/verify/branch.hpp)
};

// Returns the height of the mesh's chords over the surface it stands for, from the angle between neighbouring
// faces: 99% of the edges stay below. Creases within the limits are the design's own.
[[nodiscard]] double mesh_chord_mm(const surface::TriangleMesh& mesh, const surface::CreaseLimits& limits);

// Returns the budget's lines, name and mm, in this order: mesh, fit, joint_fit, between_ribs, interpolation,
// quantisation, gravity_droop, gravity_in_plane, clamp_error.
[[nodiscard]] std::vector<std::pair<std::string, double>> error_budget(const surface::DesignSurface& design,
                                                                       const Program& program,
                                                                       const PoseErrors& errors);

// The budget's lines of what no measurement of the cut tells.
inline constexpr const char *kJointFitLine = "joint_fit", *kInterpolationLine = "interpolation",
                            *kDroopLine = "gravity_droop", *kInPlaneLine = "gravity_in_plane",
                            *kClampErrorLine = "clamp_error";

// Returns the largest distance between a clamp and the line between its neighbours in time, mm.
[[nodiscard]] double interpolation_mm(const Program& program);

// Returns the sum of an error budget's lines, mm: the worst case, in which none takes off from another.
[[nodiscard]] double budget_sum_mm(const std::vector<std::pair<std::string, double>>& budget_mm);

}  // namespace hotblade::pipeline
